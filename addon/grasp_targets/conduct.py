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
    """What a target by finger came to: the `grasp` of the scene's frame, None where the hand stays; a `reasons.Row` for
    each part; the pressed `state`, and the `friction` that holds what its forces leave over."""

    grasp: fitter.Grasp | None
    rows: list
    state: settling.State
    friction: float


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
    state = reached.state
    friction = settling.friction_of(stage, state, settling.Aim(np.zeros(3), np.zeros(3)))
    is_first = all(np.allclose(a, b, atol=1e-9) for a, b in zip(_posture(state.grasp), _posture(first), strict=True))
    grasp = None if is_first else stage.carried(replace(state.grasp, force_n=state.total_n))
    return ByFinger(grasp, rows, state, friction)


def _posture(grasp):
    return grasp.angles, grasp.place


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
    """`recording.Explained` of a `fitting.Fit`; where nothing near explains the recording, the hand stays. `seat`: a
    `laying.Seat`; `asked`: the `laying.Lie` of the mat, and the rule of the frame with its number. Raises `Refusal`,
    `RecordingError`."""
    watch = fitter.Watch(progress or fitter.ALONE.report, cancel)
    lie, frame = asked
    stage = stage_of(fit)
    recorded = recording.read(seat, lie, frame, stage.world)
    recording.check_lies(stage, recorded)
    first = grasp_here(stage)
    recording.check_near(stage, first, recorded)
    before = recording.match_of(stage, first, recorded, cancel)
    stays = recording.Explained(None, before, before, recorded)
    if before.is_noise(stays.recorded_n):
        return stays
    found = recording.explain(stage, first, fit.wish.free_mm, recorded, watch)
    after = recording.match(stage, found.state, recorded)
    motion = recording.motion_of(found, first, fit.wish.free_mm)
    grasp = stage.carried(replace(found.state.grasp, force_n=found.state.total_n))
    moved = recording.Explained(grasp, before, after, recorded, motion)
    return stays if moved.removed < recording.LITTLE else moved
