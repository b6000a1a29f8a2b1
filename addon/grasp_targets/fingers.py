"""Force by finger as a target: what each digit and the palm shall carry. No Blender objects."""

import numpy as np

from ..grasp_fit import load as loads
from ..scene.checks import Refusal
from . import parts, reaching, views

WEIGHT_MM = 60.0
"""1 % of a wanted force counts as 0.6 mm of a pad's depth, as `settling.WEIGHT_MM` does."""

LEAST_SHARE = 0.05
"""A force that is wanted counts as at least this share of all that are: a finger of 1 N is not held to 10 mN."""

REACHED = 0.01
"""No further round is needed where every force is within this share of the wanted one."""

FACTORS = (0.5, 1.6)
"""The depth that a pad is drawn to changes by no more in one round."""

FIRST_DEPTH_MM = 1.5
LEAST_N = 0.5
"""Depth that pads are drawn to which hang clear of the product and of which so much is wanted."""


def target_of(stage, first, wanted_n):
    """The `reaching.Target` of forces by part (6,), N, NaN where a part is free: its pads are drawn to the depth that
    they have in the grasp `first`.

    Raises `Refusal` where all are free, or a part has no skin.
    """
    pads = stage.hand.pads
    check(pads, wanted_n)
    is_asked = np.isfinite(wanted_n)
    asked = np.flatnonzero(is_asked)
    numbers = np.where(is_asked, np.cumsum(is_asked) - 1, -1)[parts.parts_of_pads(pads)]
    view = views.ByPart(parts.spread(pads, numbers, len(stage.hand.rig.vertices)), len(asked))
    wanted = wanted_n[asked]
    is_free = ~is_asked[parts.parts_of_pads(pads)]
    begun = np.array([first.depths_mm[pad.name] for pad in pads])
    size = np.maximum(wanted, max(LEAST_SHARE * wanted.sum(), 1.0))

    def measure(state):
        return (parts.forces_by_part(pads, np.asarray(state.contact.force_n))[asked],)

    def wishes(state, depths):
        return np.where(is_free, begun, wished(pads, wanted_n, np.asarray(state.contact.force_n), depths))

    def is_reached(values):
        return bool((np.abs(values[0] - wanted) <= REACHED * size).all())

    return reaching.Target((view,), (wanted,), (WEIGHT_MM / size,), measure, wishes, is_reached)


def check(pads, wanted_n):
    """Refuse wishes without a part, and parts without skin. Raises `Refusal`."""
    if not np.isfinite(wanted_n).any():
        raise Refusal("no force by finger is wanted; enter newtons for at least one finger or the palm")
    owned = set(parts.parts_of_pads(pads))
    for number in np.flatnonzero(np.isfinite(wanted_n)):
        if number not in owned:
            name = parts.PARTS[number]
            raise Refusal(
                f"the hand has no skin region of the {name}, so no force can be wanted there; set its force to 0, or "
                "add its region under Materials"
            )


def wished(pads, wanted_n, force_n, depths):
    """Depths (p,) that pads are drawn to: as they are, deeper or higher by what their part's force lacks."""
    return drawn(depths, parts.forces_by_part(pads, force_n), wanted_n, parts.parts_of_pads(pads))


def drawn(depths, have, wanted, of_pad):
    """The same for any parts: forces that they `have` and that are `wanted`, N, NaN where one is free; `of_pad` (p,)
    the part of each pad."""
    out = depths.copy()
    for number, part in enumerate(of_pad):
        if not np.isfinite(wanted[part]):
            continue
        if have[part] > 0.0 and depths[number] > 0.0:
            ratio = (wanted[part] / have[part]) ** (1.0 / loads.POWER)
            out[number] = depths[number] * np.clip(ratio, *FACTORS)
        elif have[part] <= 0.0 and wanted[part] >= LEAST_N:
            out[number] = FIRST_DEPTH_MM
    return out


def clear_of(pads, grasp, is_asked):
    """Depths (p,) by which the digits are closed that shall carry and hang clear of the product; NaN for the others.

    `is_asked` (6,): of which of `parts.PARTS` something is wanted.
    """
    of_pad = parts.parts_of_pads(pads)
    depths = np.array([grasp.depths_mm[pad.name] for pad in pads])
    is_clear = np.array([depths[of_pad == part].max(initial=-np.inf) < 0.0 for part in range(len(parts.PARTS))])
    return np.where((is_clear & is_asked)[of_pad], FIRST_DEPTH_MM, np.nan)
