"""The order of a target: the hand where it is, the search from there, and what is said of it."""

from dataclasses import dataclass, replace

import numpy as np

from ..grasp import settling
from ..grasp.stage import stage_of
from ..grasp_fit import fitter
from ..hand import pads as pads_of_hand
from . import fingers, parts, reaching, reasons


@dataclass(frozen=True)
class ByFinger:
    """What a target by finger came to: the `grasp` of the scene's frame, and a `reasons.Row` for each part."""

    grasp: fitter.Grasp
    rows: list


def by_finger(fit, wanted_n, cancel=None, progress=None):
    """`ByFinger` of a `fitting.Fit` and forces (6,) by `parts.PARTS`, N, NaN where a part is free. Raises `Refusal`."""
    watch = fitter.Watch(progress or fitter.ALONE.report, cancel)
    fingers.check(fit.hand.pads, wanted_n)
    stage = stage_of(fit)
    target = fingers.target_of(stage, wanted_n)
    first = grasp_here(stage)
    closed = closing(stage.hand.pads, first, np.isfinite(wanted_n))
    start = reaching.start_of(stage, first, fit.wish, closed)
    reached = reaching.reach(stage, start, target, watch)
    rows = reasons.rows_of(stage, start, target, reached, wanted_n)
    return ByFinger(stage.carried(replace(reached.state.grasp, force_n=reached.state.total_n)), rows)


def grasp_here(stage):
    """The hand of a `Stage` as it is in the scene, as a grasp of the own frame; it may be clear of the product."""
    angles = stage.fit.wish.angles
    plain = fitter.Grasp(angles, np.eye(4), {}, {}, 0.0, 0, 0.0, (), stage.gauge)
    taken = stage.taken(plain)
    gap = settling.gaps_of(stage, taken)
    depths = {pad.name: pads_of_hand.pad_depth(gap[pad.rows]) for pad in stage.hand.pads}
    of_pads = np.zeros(len(gap), bool)
    of_pads[np.concatenate([pad.rows for pad in stage.hand.pads])] = True
    return replace(taken, depths_mm=depths, deepest_body_mm=float(-gap[~of_pads].min(initial=0.0)))


def closing(pads, grasp, is_asked):
    """Depths (p,) by which the digits are closed that shall carry and hang clear of the product; NaN for the others.

    `is_asked` (6,): of which of `parts.PARTS` something is wanted.
    """
    of_pad = parts.parts_of_pads(pads)
    depths = np.array([grasp.depths_mm[pad.name] for pad in pads])
    is_clear = np.array([depths[of_pad == part].max(initial=-np.inf) < 0.0 for part in range(len(parts.PARTS))])
    return np.where((is_clear & is_asked)[of_pad], fingers.FIRST_DEPTH_MM, np.nan)
