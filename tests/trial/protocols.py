"""Pads, tools and protocols of the trial, and when each protocol presses how deep. mm, s.

Calibration, trial and second trial share no pad, no tool and no speed.
"""

from dataclasses import dataclass

import numpy as np

PADS = {  # split, thickness over bone, radii of the three spheres; flat, as the base model has it
    "forefinger": ("calibration", 5.5, 5.0, 11.0, 28.0),
    "thenar": ("calibration", 8.0, 7.5, 17.0, 45.0),
    "fingertip": ("trial", 5.0, 4.0, 9.0, 25.0),
    "thumb": ("trial", 6.5, 6.0, 13.0, 30.0),
    "palm": ("trial", 9.0, 8.5, 19.0, 50.0),
    "ring_finger": ("second", 4.3, 3.8, 9.5, 20.0),
    "heel_of_hand": ("second", 7.4, 5.5, 14.0, 42.0),
    "hypothenar": ("second", 10.5, 9.0, 24.0, 52.0),
}
SECOND = tuple(pad for pad, about in PADS.items() if about[0] == "second")
TOOLS = ("small", "large", "wide")
SPEEDS = {"calibration": (0.4, 1.6, 4.0), "trial": (0.5, 2.0, 6.0), "second": (0.7, 2.5, 5.0)}  # slow, middle, fast
STRAIN = 0.14  # depth over thickness
HOLD_S = 8.0
REST_S = 3.0  # without contact, at the end
LIFT_MM = 0.1  # where a press begins and ends, above the skin
CYCLES = 4
SAMPLES = {"plain": (22, 26, 24, 6), "cycles": (12, 1, 12, 6)}  # as `counts` of `course`
STEP_MM = 1e-4  # in which recorded depths are kept
LEAST = 0.25  # of the depth, to which a cycle goes back

STEPS = (12, 9, 16, 1)  # of the finite elements, as `counts` of `course`
AMPLITUDES = (0.5, 1.0)  # at which effects are computed; in their second form at full amplitude alone
FINER = (0.0625, 0.125, 0.25, 0.5, 1.0)  # the same, in both forms, on the pads of SECOND
BETWEEN = ("heel_of_hand", 0.18)  # computed to see how well effects are drawn there
GRIPS = (0.04, 0.06, 0.09, 0.13, 0.19, 0.27, 0.37, 0.5, 0.65, 0.82, 1.0)  # what lets go has no amplitudes between these
COMPUTED = (  # pads on which single effects, pairs, and the second form of single effects are computed
    ("forefinger", "fingertip", "thumb", "palm", *SECOND),
    ("forefinger", "fingertip", "thumb", *SECOND),
    ("forefinger", "fingertip", *SECOND),
)
TWO_FORMS = {"bone": ("forefinger", "fingertip", "thumb", "palm", *SECOND)}  # more pads for the second form
SINGLE = (
    "relaxation",
    "adhesion",
    "cycle_softening",
    "bone",
    "stiffening_law",
    "rate_independent_loss",
    "drainage",
    "stiff_skin",
    "compressibility",
)
PAIRS = (
    ("relaxation", "adhesion"),
    ("bone", "relaxation"),
    ("cycle_softening", "relaxation"),
    ("adhesion", "bone"),
    ("rate_independent_loss", "adhesion"),
    ("stiffening_law", "relaxation"),
)


@dataclass(frozen=True)
class Protocol:
    """One way to press: tool, which of SPEEDS, seconds held, how often."""

    tool: str
    speed: int
    hold_s: float
    cycles: int = 1


PROTOCOLS = {
    "slow, small sphere": Protocol("small", 0, HOLD_S),
    "fast, small sphere": Protocol("small", 2, HOLD_S),
    "large sphere": Protocol("large", 1, HOLD_S),
    "cycles, small sphere": Protocol("small", 1, 0.0, CYCLES),
    "wide sphere": Protocol("wide", 1, HOLD_S),
}


def radius(pad, tool):
    """Of a tool, mm."""
    return PADS[pad][2 + TOOLS.index(tool)]


def depth(pad):
    """To which every protocol presses."""
    return STRAIN * PADS[pad][1]


def legs(pad, name):
    """Corners (time, depth) of a protocol's motion, from LIFT_MM above the skin to the end of the rest."""
    how = PROTOCOLS[name]
    speed, most = SPEEDS[PADS[pad][0]][how.speed], depth(pad)
    stops = [-LIFT_MM, 0.0]
    for cycle in range(how.cycles):
        stops += [most, LEAST * most if cycle < how.cycles - 1 else -LIFT_MM]
    corners, time = [], 0.0
    for before, stop in zip([stops[0], *stops[:-1]], stops, strict=True):
        time += abs(stop - before) / speed
        corners.append((time, stop))
        if stop == most and how.hold_s > 0.0:
            time += how.hold_s
            corners.append((time, stop))
    return np.array([*corners, (time + REST_S, -LIFT_MM)])


def course(pad, name, counts):
    """Times and depths of a motion, with `counts` points on a leg that goes down, holds, goes up, rests."""
    corners = legs(pad, name)
    rows = [corners[0]]
    for (t0, d0), (t1, d1) in zip(corners[:-1], corners[1:], strict=True):
        kind = 0 if d1 > d0 else 2 if d1 < d0 else 1 if d1 > 0.0 else 3
        share = np.arange(1, counts[kind] + 1) / counts[kind]
        if kind == 1:
            share = share**2.5  # relaxation is quick at first
        rows += list(np.stack([t0 + (t1 - t0) * share, d0 + (d1 - d0) * share], axis=1))
    return np.array(rows)


def sampled(pad, name):
    """Times and depths at which a protocol is recorded."""
    how = "cycles" if PROTOCOLS[name].cycles > 1 else "plain"
    motion = course(pad, name, SAMPLES[how])
    approach = motion[1 : SAMPLES[how][0]]
    kept = np.ones(len(motion), dtype=bool)
    kept[1 : SAMPLES[how][0]] = np.arange(len(approach)) % 4 == 3  # few samples before touch
    return motion[kept, 0], motion[kept, 1]
