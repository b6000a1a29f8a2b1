"""The order of a target: the hand where it is, the search from there, and what is said of it."""

from dataclasses import dataclass, replace

import numpy as np

from ..grasp import settling
from ..grasp.stage import stage_of
from ..grasp_fit import fitter
from ..hand import pads as pads_of_hand
from . import fingers, reaching, reasons, recording


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
    first = grasp_here(stage)
    target = fingers.target_of(stage, first, wanted_n)
    closed = fingers.clear_of(stage.hand.pads, first, np.isfinite(wanted_n))
    start = reaching.start_of(stage, first, fit.wish, closed)
    reached = reaching.reach(stage, start, target, watch)
    rows = reasons.rows_of(reasons.Search(stage, start, target, watch), reached, wanted_n)
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


def by_recording(fit, seat, asked, cancel=None, progress=None):
    """`recording.Explained` of a `fitting.Fit`. `seat`: a `laying.Seat`; `asked`: the `laying.Lie` of the mat, and the
    rule of the frame with its number. Raises `Refusal`, `RecordingError`."""
    watch = fitter.Watch(progress or fitter.ALONE.report, cancel)
    lie, frame = asked
    stage = stage_of(fit)
    recorded = recording.read(seat, lie, frame, stage.world)
    recording.check_lies(stage, recorded)
    first = grasp_here(stage)
    before = recording.match_of(stage, first, recorded, cancel)
    recorded_n = float(recorded.force_n.sum())
    stays = recording.Explained(stage.carried(first), before, before, recorded_n, 0.0, 0.0)
    if before.is_noise(recorded_n):
        return stays
    found = recording.explain(stage, first, fit.wish.free_mm, recorded, watch)
    after = recording.match(stage, found.state, recorded)
    if after.cells_kpa >= before.cells_kpa:
        return stays
    turned = np.degrees(np.abs(found.state.grasp.angles - first.angles).max())
    middle = stage.hand.rig.moved(first.place).world_from_rig[:3, 3]
    motion = found.state.grasp.place @ np.linalg.inv(first.place)
    moved = np.linalg.norm(motion[:3, :3] @ middle + motion[:3, 3] - middle)
    grasp = stage.carried(replace(found.state.grasp, force_n=found.state.total_n))
    return recording.Explained(grasp, before, after, recorded_n, float(turned), float(moved))
