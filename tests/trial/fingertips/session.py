"""A session in the laboratory: what is pressed and slid in which order, what the tip answers, what instruments write.

    Session(tip, truth, noise, random).recorded() -> Case

The docstring of `laboratory_fingertips.py` says what is drawn.
"""

from dataclasses import dataclass

import numpy as np
from trial.fingertips.pressure_mats import Mat
from trial.fingertips.study_files import FLOOR_KPA, PITCH_MM, Case, Frames, Recording
from trial.fingertips.tips import DEEPEST_MM
from trial.fingertips.tissue_bed import Bed, Damage, dragged

NOISES = ("laboratory", "drifting", "remounted")
SHARE = (0.68, 0.9)  # of the tables' depth
LIFT_MM, FINE_MM = 0.6, 0.02
RATES_HZ = {0.5: 20.0, 2.0: 40.0, 8.0: 100.0}
COUNT = (12, 9)
CELL_NOISE = {"laboratory": (0.03, 0.3), "drifting": (0.01, 0.3), "remounted": (0.01, 0.3)}
CELL_GAIN = {"laboratory": 0.0, "drifting": 0.04, "remounted": 0.04}
OFFSET_MM = 0.3 / np.sqrt(2.0)
MAP_SPEED = 2.0
SLIDE_DEPTH = 0.67  # over the deepest


@dataclass(frozen=True)
class Motion:
    """Times (s), the tool's depth and its slide (mm)."""

    time: np.ndarray
    depth: np.ndarray
    slide: np.ndarray


def course(knots, rate):
    """A motion straight between knots (s, depth mm, slide mm), read at a rate (Hz)."""
    knots = np.array(knots)
    time = np.arange(0.0, knots[-1, 0] + 0.5 / rate, 1.0 / rate)
    return Motion(time, *(np.interp(time, knots[:, 0], knots[:, k]) for k in (1, 2)))


def press(deepest, speed, hold_s):
    """From touch down, a hold, up and apart."""
    down, up = deepest / speed, (deepest + LIFT_MM) / speed
    return course(
        [(0, 0, 0), (down, deepest, 0), (down + hold_s, deepest, 0), (down + hold_s + up, -LIFT_MM, 0)],
        RATES_HZ[speed],
    )


def cycles(deepest, speed):
    """Four presses without a hold."""
    way = deepest / speed
    knots = [(k * way, deepest * (k % 2), 0.0) for k in range(9)]
    return course([*knots, (8 * way + LIFT_MM / speed, -LIFT_MM, 0.0)], RATES_HZ[speed])


def slide(depth, speed, far):
    """Down, a stand of a second, `far` to one side and half as far beyond the middle on the other, still pressed."""
    at = depth / speed + 1.0
    knots = [(0, 0, 0), (at - 1.0, depth, 0), (at, depth, 0), (at + far / speed, depth, far)]
    return course([*knots, (at + 2.5 * far / speed, depth, -0.5 * far)], RATES_HZ[speed])


class Session:
    """One session with a tip; what is drawn for it stands here."""

    def __init__(self, tip, truths, noise, random):
        self.tip, self.truths, self.noise, self.random = tip, truths, noise, random
        self.deepest = random.uniform(*SHARE) * DEEPEST_MM * tip.size
        speeds = [0.5, 2.0, 8.0] if random.random() < 0.5 else [2.0, float(random.choice([0.5, 8.0]))]
        self.speeds = sorted(speeds)
        self.repeats, self.hold_s = int(random.integers(2, 4)), random.uniform(2.0, 4.0)
        self.cycles_first = "cycle_softening" in self.truths or random.random() < 0.5
        self.far = random.uniform(2.0, 4.0)
        self.terms, self.damage, self.friction = self._memory()
        self.ceiling_n = np.inf
        if "saturation" in self.truths:
            tops = [tip.force_n(tool, self.deepest) for tool in ("plate", "cylinder")]
            self.ceiling_n = random.uniform(0.75, 0.92) * min(tops)
        self.beds = {tool: self._bed(tool) for tool in ("plate", "cylinder")}
        self.mat = self._mat()
        self.recordings = []

    def _memory(self):
        draw = self.random.uniform
        slow = [(draw(0.1, 0.2), draw(0.2, 0.5)), (draw(0.08, 0.16), draw(2.0, 5.0))]
        fades = self.truths & {"relaxation", "drainage"}
        damage = Damage(draw(0.2, 0.4), draw(0.5, 2.0), self.deepest)
        friction = draw(0.15, 0.5)
        return (
            slow if fades else [],
            damage if "cycle_softening" in self.truths else None,
            friction if "friction" in self.truths else 0.0,
        )

    def _bed(self, tool):
        depth = np.arange(0.0, self.deepest + 2.0 * FINE_MM, FINE_MM)
        return Bed(depth, self.tip.force_n(tool, depth))

    def _mat(self):
        top = self.tip.image_kpa("plate", self.deepest, self.tip.force_n("plate", self.deepest))
        plain = Mat(PITCH_MM, COUNT)
        truly = plain.cells(top, self.tip.size * 0.5)
        gain = 1.0 + CELL_GAIN[self.noise] * self.random.standard_normal(COUNT)
        if "mat_gain" in self.truths:
            gain = gain * self.random.choice([0.7, 1.4])
        dead = ()
        if "dead_cells" in self.truths:
            loaded = np.argwhere(truly > 0.4 * truly.max())
            dead = tuple(tuple(at) for at in self.random.permutation(loaded)[:3])
        clips = "mat_ceiling" in self.truths
        ceiling = round(self.random.uniform(0.4, 0.75) * truly.max(), 1) if clips else np.inf
        return Mat(PITCH_MM, COUNT, (0.0, 0.0), gain, dead, ceiling)

    def recorded(self):
        """The case."""
        tools, speed = {}, f"{MAP_SPEED:g}"
        planned = [("plate", f"press_plate {v:g}", press(self.deepest, v, self.hold_s)) for v in self.speeds]
        planned.append(("cylinder", f"press_cylinder {speed}", press(self.deepest, MAP_SPEED, self.hold_s)))
        cycled = ("plate", f"cycles {speed}", cycles(self.deepest, MAP_SPEED))
        planned.insert(0 if self.cycles_first else len(planned), cycled)
        planned.append(("plate", f"slide_plate {speed}", slide(SLIDE_DEPTH * self.deepest, MAP_SPEED, self.far)))
        for tool, protocol, motion in planned:
            for repeat in range(2 if protocol.startswith(("cycles", "slide")) else self.repeats):
                self._record(tool, f"{protocol} mm/s, repeat {repeat}", protocol, motion)
            tools[protocol] = tool, motion
        mapped = [f"{kind} {speed}" for kind in ("press_plate", "press_cylinder", "slide_plate")]
        maps = [self._frames(protocol, *tools[protocol]) for protocol in mapped]
        return Case(self.tip, self.recordings, maps, self.friction)

    def _answer(self, tool, motion):
        """True force, contact area and force along the slide."""
        slower = self._drains(tool) if "drainage" in self.truths else None
        followed = self.beds[tool].follow(motion.time, motion.depth, self.terms, self.damage, slower)
        area = self.tip.area_mm2(tool, followed.reach_mm)
        # A slab of that area and of what is left of the thickness, sheared.
        shear = self.tip.modulus_mpa * area.max() / (self.tip.thickness_mm - motion.depth.max())
        return followed.force_n, area, dragged(motion.slide, followed.force_n, self.friction, shear), shear

    def _drains(self, tool):
        """Fluid has the farther to go the wider the contact is: time constants grow as its area over the widest."""
        widest, touch = self.tip.area_mm2("plate", self.deepest), 0.05 * self.deepest
        depth = np.linspace(0.0, self.deepest, 60)
        part = self.tip.area_mm2(tool, np.maximum(depth, touch)) / widest
        return lambda at: np.interp(at, depth, part)

    def _record(self, tool, name, protocol, motion):
        force, area, along, _ = self._answer(tool, motion)
        random, n = self.random, len(force)
        stated = motion.depth
        if self.noise == "laboratory":
            stated = stated + 0.01 * random.standard_normal(n)
            read = force * (1.0 + 0.01 * random.standard_normal(n)) + 0.005 * random.standard_normal(n)
        elif self.noise == "drifting":
            step = motion.time[1] - motion.time[0]
            walk = 0.006 * np.sqrt(step / 10.0) * np.cumsum(random.standard_normal(n))
            stated = stated + 0.005 * random.standard_normal(n)
            read = force * (1.0 + 0.005 * random.standard_normal(n)) + walk + 0.003 * random.standard_normal(n)
        else:
            stated = stated + 0.02 * random.standard_normal() + 0.005 * random.standard_normal(n)
            read = force * (1.0 + 0.02 * random.standard_normal()) + 0.004 * random.standard_normal(n)
        seen = area * (1.0 + 0.03 * random.standard_normal(n)) + 0.2 * random.standard_normal(n)
        columns = {
            "time_s": motion.time,
            "depth_mm": stated,
            "force_n": np.minimum(read, self.ceiling_n),
            "area_mm2": np.where(area > 0.0, np.maximum(seen, 0.0), 0.0),
        }
        if protocol.startswith("slide"):
            columns["slide_mm"] = motion.slide
            noisy = along * (1.0 + 0.01 * random.standard_normal(n)) + 0.005 * random.standard_normal(n)
            columns["tangential_force_n"] = noisy
        self.recordings.append(Recording(name, protocol, tool, len(self.recordings), columns))

    def _frames(self, protocol, tool, motion):
        """A mat's frames of one more recording, the mat laid on once more."""
        force, _, along, shear = self._answer(tool, motion)
        offset = tuple(OFFSET_MM * self.random.standard_normal(2))
        mat = Mat(PITCH_MM, COUNT, offset, self.mat.gain, self.mat.dead, self.mat.ceiling_kpa)
        share, even = CELL_NOISE[self.noise]
        frames = []
        for phase, k in self._moments(protocol, motion):
            image = self.tip.image_kpa(tool, motion.depth[k], force[k])
            # The skin stays where the tool slides away; sheared skin goes along with it.
            shift = -motion.slide[k] - along[k] / shear
            pressure = mat.cells(image, self.tip.size * 0.5, shift)
            read = mat.read(pressure, (share, even, FLOOR_KPA), self.random)
            jitter = 0.01 * self.random.standard_normal()
            frames.append((phase, motion.depth[k] + jitter, motion.slide[k], read))
        return Frames(protocol, tool, mat, frames)

    def _moments(self, protocol, motion):
        """(phase, index) of each frame."""
        top = int(np.argmax(motion.depth >= self.deepest - 1e-9)) if not protocol.startswith("slide") else 0
        if protocol.startswith("press"):
            parts = (1, 2, 3) if "cylinder" in protocol else (0.5, 1, 1.5, 2, 2.5, 3)
            for part in parts:
                yield "load", int(np.argmin(np.abs(motion.depth[: top + 1] - part / 3.0 * self.deepest)))
            if "plate" in protocol:
                middle = motion.time[top] + 0.5 * self.hold_s
                yield "hold", int(np.searchsorted(motion.time, middle))
                after = int(np.searchsorted(motion.time, motion.time[top] + self.hold_s))
                for part in (2, 1.5):
                    yield "unload", after + int(np.argmin(np.abs(motion.depth[after:] - part / 3.0 * self.deepest)))
            return
        turn = int(np.argmax(motion.slide))
        for part in (0.25, 0.5, 1.0):
            yield "slide", int(np.argmin(np.abs(motion.slide[: turn + 1] - part * self.far)))
        for part in (0.5, 0.0, -0.5):
            yield "slide", turn + int(np.argmin(np.abs(motion.slide[turn:] - part * self.far)))
