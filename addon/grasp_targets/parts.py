"""The parts of a hand that a target speaks of: five digits and the palm. Knows nothing of Blender."""

import numpy as np

from ..hand_bones.roles import FINGERS

PARTS = ("thumb", *FINGERS, "palm")


def part_of(pad):
    """The part that a pad belongs to."""
    return "palm" if pad.kind == "palm" else pad.role.partition("_")[0]


def parts_of_pads(pads):
    """Number in `PARTS` of the part of every pad (p,)."""
    return np.array([PARTS.index(part_of(pad)) for pad in pads])


def spread(pads, numbers, count):
    """A number for every one of `count` vertices from one for every pad (p,); -1 where no pad is."""
    out = np.full(count, -1)
    for pad, number in zip(pads, numbers, strict=True):
        out[pad.rows] = number
    return out


def forces_by_part(pads, force_n):
    """Sum of the forces (n,) of vertices over each of `PARTS` (6,), N."""
    return np.bincount(parts_of_pads(pads), [force_n[pad.rows].sum() for pad in pads], len(PARTS))
