"""A mat's recording as a target: the posture near the present one whose pressure explains it best.

Posture and tissue are held apart: materials stay as they are, and what a gain of the mat alone explains is said.
No Blender objects.
"""

from dataclasses import dataclass, replace

import numpy as np

from .. import native
from ..grasp import settling
from ..grasp_fit import fitter
from ..grasp_fit.task import ARM_MM
from ..hand.skinning import pose_matrices, skin
from ..recordings import frames, laying
from ..scene.checks import Refusal
from . import fingers, parts, reaching, views

MOST_RAD = np.radians(20.0)
MOST_MM = 10.0
"""No joint turns farther, and the hand neither moves (at the middle of its pads) nor turns (at `task.ARM_MM`) farther:
what asks for more is no matter of a posture near this one."""

STOP_RAD, STOP_MM = np.radians(0.5), 0.1
"""A motion this near to one of these bounds stopped there."""

LITTLE = 0.1
"""What removes a smaller share of what was left over explains nothing."""

WEIGHT_MM = 60.0
"""All that was recorded counts as much, mm, in either step."""

SHARE, FLOOR = 0.1, 0.03
"""Noise of a cell, assumed: this share of its pressure and this share of the largest."""

ALIKE = 0.1
"""Forces over a mat differ by no more than its calibration within this share. Noise of single cells is averaged out in
their sum, but the gain that they share is not: calibrations of one mat differ by 5 to 32 % (Morin and others 2000)."""

SPREADS_MM = (8.0, 5.0)
"""Pressure is compared after it was spread by normal distributions of these, the wider first: it leads fingers that
press between other cells. A cell of a common mat is about 5 mm wide."""

NEAREST_MM = 30.0
"""Cells that read belong to the pad that is nearest, if that is no farther."""

OFF_MM = 5.0
"""Cells farther from the product's surface do not lie on it."""

CELLS = 900
"""No more cells are compared: evenly left out."""

REACH_MM = 20.0
"""Cells this near to one that reads are compared."""

BALANCES_MM = (2.0,)
ROUNDS = (4, 6, 6)
"""What the forces left over count, and the rounds by pads and then by each spread."""

SAME = 0.9
"""A gain that leaves at most the posture's rest divided by this explains the recording as well."""


@dataclass(frozen=True)
class Recorded:
    """What a mat read, in the product's own frame: `mat` a record as `laying.lay` gives it, `values` (n,), kPa, and
    the `limits` that the library's comparison knows of the instrument; `frame`: its number, from 0."""

    mat: dict
    values: np.ndarray
    limits: dict
    frame: int = 0

    @property
    def is_placed(self):
        """Which cells have a place and read something, or nothing, but are not missing (n,)."""
        return np.isfinite(self.mat["area_mm2"]) & np.isfinite(self.values)

    @property
    def force_n(self):
        """Force (n,) of every cell, N; 0 where none is known."""
        area = np.where(self.is_placed, self.mat["area_mm2"], 0.0)
        return np.where(self.is_placed, np.nan_to_num(self.values), 0.0) * area / views.KPA

    @property
    def centers(self):
        """Places (n, 3) of the cells, mm, NaN where there are none."""
        return np.asarray(self.mat["center_mm"])


@dataclass(frozen=True)
class Match:
    """How well a posture explains a recording: root mean square `cells_kpa` of what is left over by cell, the `force_n`
    that the mat would read, and the `gain` of the mat with which it explains most, with what is then left over.
    `in_noise`: the root mean square of the same over the noise assumed; up to 1 there is nothing to explain."""

    cells_kpa: float
    force_n: float
    gain: float
    gained_kpa: float
    in_noise: float = np.inf

    def is_noise(self, recorded_n):
        """Whether nothing is left to explain: cells differ by the noise assumed, and forces hardly."""
        return self.in_noise <= 1.0 and abs(self.force_n / recorded_n - 1.0) <= ALIKE


@dataclass(frozen=True)
class Motion:
    """How far joints turned at most, and the hand, degrees; how far the middle of its pads moved, mm; `is_stopped`:
    whether one of these stands at the farthest that is searched."""

    turned_deg: float = 0.0
    swung_deg: float = 0.0
    moved_mm: float = 0.0
    is_stopped: bool = False


@dataclass(frozen=True)
class Explained:
    """The `grasp` of the scene's frame, None where the hand stays; its match `before` and `after`, the `recorded`, and
    the `motion` from the one to the other."""

    grasp: fitter.Grasp | None
    before: Match
    after: Match
    recorded: Recorded
    motion: Motion = Motion()

    @property
    def recorded_n(self):
        """Force on the mat, N."""
        return float(self.recorded.force_n.sum())

    @property
    def removed(self):
        """Share of the difference by cell that the posture removed."""
        return _removed(self.before, self.after.cells_kpa)

    @property
    def is_gain_as_good(self):
        """Whether a gain of the mat explains the recording, and about as well, with the hand as it was."""
        is_known = np.isfinite(self.before.gain) and _removed(self.before, self.before.gained_kpa) >= LITTLE
        return bool(is_known and self.before.gained_kpa * SAME <= self.after.cells_kpa)


def _removed(before, left_kpa):
    return 1.0 - left_kpa / max(before.cells_kpa, 1e-9)


def motion_of(reached, first, free_mm):
    """The `Motion` from the grasp `first` to a `reaching.Reached`, its hand free by `free_mm`."""
    task, x = reached.task, reached.x
    turned = float(np.abs(reached.state.grasp.angles - first.angles).max())
    way = reached.state.grasp.place @ np.linalg.inv(first.place)
    moved = float(np.linalg.norm(way[:3, :3] @ task.pivot + way[:3, 3] - task.pivot))
    swung = float(np.linalg.norm(x[-3:]))
    free = min(free_mm, MOST_MM)
    is_stopped = turned > MOST_RAD - STOP_RAD or (free > 0.0 and max(moved, swung) > free - STOP_MM)
    return Motion(float(np.degrees(turned)), float(np.degrees(swung / ARM_MM)), moved, is_stopped)


def read(seat, lie, request, world):
    """The `Recorded` of a mat that lies as `lie` says; `request`: the rule of the frame and its number; `world` (4, 4)
    leads from the product's own frame to that of the seat. Raises `Refusal`, `RecordingError`."""
    mat = laying.lay(lie, seat)
    found = frames.map_of(lie.path, lie.mat)
    if found.pressure_kpa is None:
        raise Refusal("the recording holds raw counts, so no posture can be found for it; calibrate it to kPa first")
    frame = frames.number_of(found, *request)
    values = np.asarray(frames.values_of(found)[frame], float)
    turn = world[:3, :3]
    mat["center_mm"] = (np.asarray(mat["center_mm"]) - world[:3, 3]) @ turn
    mat["normal"] = np.asarray(mat["normal"]) @ turn
    limit, unit = found.threshold or (None, found.unit)
    limits = {"threshold": limit if unit == found.unit else None, "clipped_from": found.clipped_from}
    out = Recorded(mat, values, limits, int(frame))
    if out.force_n.sum() <= 0.0:
        raise Refusal("the chosen frame of the recording reads nothing on this product; choose another frame")
    return out


def check_lies(stage, recorded):
    """Refuse a mat that is not laid on the product. Raises `Refusal`."""
    is_read = recorded.force_n > 0.0
    far = np.abs(stage.gauge.product.gap_mm(recorded.centers[is_read])["gap_mm"]) > OFF_MM
    share = recorded.force_n[is_read][far].sum() / recorded.force_n.sum()
    if share > 0.5:
        raise Refusal(
            f"{share:.0%} of the recorded force lies more than {OFF_MM:.0f} mm off the product; lay the mat on it "
            "under Record first"
        )


def check_near(stage, first, recorded):
    """Refuse a recording that no pad of the grasp `first` is near to. Raises `Refusal`."""
    if by_pad(stage, first, recorded).sum() <= 0.0:
        raise Refusal(
            f"the recorded force lies more than {NEAREST_MM:.0f} mm from the hand; pose it nearer, or lay the mat "
            "elsewhere"
        )


def explain(stage, first, free_mm, recorded, watch=fitter.ALONE):
    """The best `reaching.Reached` from `first`, the grasp of the own frame."""
    wish = replace(stage.fit.wish, free_mm=min(free_mm, MOST_MM))
    pads = stage.hand.pads
    measured = by_pad(stage, first, recorded)
    is_asked = np.bincount(parts.parts_of_pads(pads), measured, len(parts.PARTS)) > FLOOR * measured.sum()
    start = reaching.start_of(stage, first, wish, fingers.clear_of(pads, first, is_asked), MOST_RAD)
    best = None
    for number, rounds in enumerate(ROUNDS):
        part = reaching.in_part(watch, number, len(ROUNDS))
        target = _by_pads(stage, measured) if number == 0 else _by_cells(recorded, stage, SPREADS_MM[number - 1])
        if best is not None:
            start = replace(start, x=best.x)
        found = reaching.reach(stage, start, target, part, rounds)
        if best is None or match(stage, found.state, recorded).cells_kpa < match(stage, best.state, recorded).cells_kpa:
            best = found
        measured = by_pad(stage, best.state.grasp, recorded)
    return best


def by_pad(stage, grasp, recorded):
    """What was recorded (p,), N, by the pad whose skin is nearest to each cell."""
    pads, rig = stage.hand.pads, stage.hand.rig.moved(grasp.place)
    posed = pose_matrices(rig, grasp.angles)
    is_read = recorded.force_n > 0.0
    cells, force = recorded.centers[is_read], recorded.force_n[is_read]
    away = np.stack([_nearest(cells, skin(rig.subset(pad.rows), posed)) for pad in pads])
    owner = away.argmin(axis=0)
    is_near = away.min(axis=0) < NEAREST_MM
    return np.bincount(owner[is_near], force[is_near], len(pads))


def _nearest(cells, points):
    square = (cells**2).sum(axis=1)[:, None] + (points**2).sum(axis=1) - 2.0 * cells @ points.T
    return np.sqrt(np.maximum(square.min(axis=1), 0.0))


def _by_pads(stage, measured):
    """The `reaching.Target` of forces by pad (p,), N."""
    pads = stage.hand.pads
    numbers = np.arange(len(pads))
    view = views.ByPart(parts.spread(pads, numbers, len(stage.hand.rig.vertices)), len(pads))
    size = _noise(measured, measured.max())
    weight = WEIGHT_MM / size / np.linalg.norm(measured / size)

    def measure(state):
        force = np.asarray(state.contact.force_n)
        return (np.array([force[pad.rows].sum() for pad in pads]),)

    def wishes(state, depths):
        return fingers.drawn(depths, measure(state)[0], np.maximum(measured, 1e-3 * measured.max()), numbers)

    return reaching.Target((view,), (measured,), (weight,), measure, wishes, lambda _: False, BALANCES_MM)


def _by_cells(recorded, stage, spread_mm):
    """The `reaching.Target` of pressure around cells, kPa, spread by `spread_mm`."""
    read = recorded.force_n > 0.0
    placed = np.flatnonzero(recorded.is_placed)
    away = _nearest(recorded.centers[placed], recorded.centers[read])
    chosen = placed[away < REACH_MM]
    chosen = chosen[:: -(-len(chosen) // CELLS)]
    view = views.ByCell(recorded.centers[chosen], spread_mm)
    wanted = view.of_forces(recorded.centers[read], recorded.force_n[read])
    noise = _noise(wanted, wanted.max())
    weight = WEIGHT_MM / noise / np.linalg.norm(wanted / noise)
    area = np.nan_to_num(recorded.mat["area_mm2"])

    def measure(state):
        simulated = np.nan_to_num(simulated_of(stage, state, recorded))
        return (view.of_forces(recorded.centers[placed], (simulated * area)[placed] / views.KPA),)

    return reaching.Target(
        (view,), (wanted,), (weight,), measure, lambda state, depths: depths, lambda _: False, BALANCES_MM
    )


def simulated_of(stage, state, recorded):
    """What every cell of the mat would read of a pressed state (n,), kPa; NaN where none has a place."""
    hand = stage.fit.press.reading.hand
    rig = stage.hand.rig.moved(state.grasp.place)
    points = skin(rig, pose_matrices(rig, state.grasp.angles)) + np.asarray(state.contact.displacement_mm)
    compared = native.module.compare_map(
        recorded.values, recorded.mat, points, hand.triangles, state.contact.force_n, **recorded.limits
    )
    found = compared.recordings[0].frames
    out = np.full(len(recorded.values), np.nan)
    out[np.isfinite(recorded.mat["area_mm2"])] = found[0].simulated if found else 0.0
    return out


def match_of(stage, grasp, recorded, cancel=None):
    """The `Match` of a grasp of the own frame; a hand that cannot be pressed explains nothing."""
    try:
        state = settling.pressed(stage, grasp, settling.Aim(np.zeros(3), np.zeros(3)), cancel)
    except (Refusal, native.module.SolveError):
        nothing = float(np.sqrt(np.mean(np.square(recorded.values[recorded.force_n > 0.0]))))
        return Match(nothing, 0.0, np.nan, nothing)
    return match(stage, state, recorded)


def match(stage, state, recorded):
    """The `Match` of a pressed state; the mean is over the cells that the recording loads."""
    simulated = simulated_of(stage, state, recorded)
    is_on = recorded.is_placed & np.isfinite(simulated)
    here, there = recorded.values[is_on], simulated[is_on]
    count = max(int((here > 0.0).sum()), 1)
    square = float(there @ there)
    gain = float(here @ there) / square if square > 0.0 else np.nan
    left, gained = here - there, here - (gain if square > 0.0 else 0.0) * there
    force = float(there @ np.asarray(recorded.mat["area_mm2"])[is_on]) / views.KPA
    over = left / _noise(np.maximum(here, there), here.max())
    rms = [float(np.sqrt(each @ each / count)) for each in (left, gained, over)]
    return Match(rms[0], force, gain, rms[1], rms[2])


def _noise(values, largest):
    """Standard deviation, in the unit of `values`, that a reading is assumed to have."""
    return np.sqrt((SHARE * values) ** 2 + (FLOOR * largest) ** 2)
