"""The last of the balance, on the contact model itself: small motions of the hand and of the fingers' first joints.

The fit of `settling` reads forces from depths; where walls are thin or edges near, it stops some percent short. Here
each step is pressed, and the slopes are differences of presses (Broyden 1965). No Blender objects.
"""

from dataclasses import replace

import numpy as np

from .. import native
from ..grasp_fit import fitter, thumb
from ..grasp_fit import load as loads
from ..hand.rotations import rotation_of
from ..hand.skinning import pose_matrices, skin, skin_normals
from ..hand_bones.roles import COLUMNS, FINGERS, angle_bounds
from ..scene.checks import Refusal
from . import settling

STEP_MM = 0.4
"""Motions by which slopes are taken; turns and joints at `load.ARM_MM`."""

MOST_MM = 2.0
ROUNDS = 3
STEPS = 8
HALVINGS = 3
DAMPING = 0.03
"""One step moves nothing further than `MOST_MM`. Slopes are taken so often; so many steps go by each; each step is
halved so often where it does not help. Damping in parts of the greatest slope."""

FACED = 0.92
FACING_MM = 48.0
FACING_ROUNDS = 4
"""A thumb whose pad faces the index finger's worse than this cosine, 23 degrees, is turned once the forces balance,
with three times `thumb.WEIGHT_FACING`. With 28 mm from the beginning a cylinder of 60 mm was not balanced."""

FAR = 0.6
"""What leaves more than this share over is not near enough to any balance."""

JOINTS = (
    *((f"{finger}_proximal", "flexion") for finger in FINGERS),
    ("thumb_metacarpal", "flexion"),
    ("thumb_metacarpal", "abduction"),
    ("thumb_proximal", "flexion"),
)
OF_TWO = (
    ("index_proximal", "abduction"),
    ("index_middle", "flexion"),
    ("thumb_metacarpal", "twist"),
    ("thumb_distal", "flexion"),
)
"""Joints that move as well where no more than two digits take part: these have to press on one line."""


def polish(stage, state, aim, watch=fitter.ALONE):
    """The best `settling.State` that small motions lead to from `state`; itself where none is better.

    No motion leads into a thin wall.
    """
    if settling.is_settled(state, aim) or max(state.imbalance, state.lever) > FAR:
        return state
    best = state
    for _ in range(ROUNDS):
        before = best
        best = _walked(stage, best, aim, watch)
        if best is before or settling.is_settled(best, aim):
            break
    if best is state:
        return state
    goal = settling.goal_of(fitter.wanted_depths(stage.hand.pads, stage.fit.wish), aim.bar)
    wish = replace(stage.fit.wish, evaluations=1)
    after = replace(best, grasp=fitter.refit(stage.hand, best.grasp, wish, watch, goal))
    return after if settling.cost_of(after, aim) < settling.cost_of(state, aim) else state


def face(stage, state, aim, watch=fitter.ALONE):
    """A settled `settling.State` of a power grip in which the thumb's pad faces the index finger's better.

    `state` itself where it faces well enough, is not settled, or where turning it leaves less than a settled one.
    """
    if aim.bar is None or not settling.is_settled(state, aim):
        return state
    cosine = opposed(stage, state.grasp)
    if cosine >= FACED:
        return state
    asked = np.isfinite(fitter.wanted_depths(stage.hand.pads, stage.fit.wish))
    depths = np.array([state.grasp.depths_mm[pad.name] for pad in stage.hand.pads])
    own = replace(aim, depths_mm=np.where(asked, depths, np.nan), facing_mm=FACING_MM)
    goal = replace(settling.goal_of(own.depths_mm, aim.bar), facing_mm=FACING_MM)
    wish = replace(stage.fit.wish, evaluations=settling.EVALUATIONS)
    turned = fitter.refit(stage.hand, state.grasp, wish, watch, goal)
    after = polish(stage, settling.settle(stage, turned, own, FACING_ROUNDS, watch), own, watch)
    is_better = settling.is_settled(after, aim) and opposed(stage, after.grasp) > cosine
    return after if is_better else state


def opposed(stage, grasp):
    """Cosine between the way in which the thumb's pad faces and the way to the index finger's; 1 without normals."""
    rig = stage.hand.rig.moved(grasp.place)
    if rig.normals is None:
        return 1.0
    posed = pose_matrices(rig, grasp.angles)
    return thumb.cosine_of(stage.hand, skin(rig, posed), skin_normals(rig, posed))


def _walked(stage, state, aim, watch):
    """The best state on the way from `state` with slopes taken there; itself where none is better."""
    moves = _Moves(stage, state.grasp)
    slopes = _slopes(stage, moves, (state, aim), watch)
    if slopes is None:
        return state
    before, best, x = state, state, np.zeros(slopes.shape[1])
    for count in range(STEPS):
        watch.report("Balancing the forces", 0.9 + 0.1 * count / STEPS)
        fitter.leave_if_cancelled(watch)
        values = _left(before, aim)
        step = _step(slopes, values)
        for _ in range(HALVINGS):
            after = _stepped(stage, moves.at(x + step), aim, watch)
            if after is not None and np.linalg.norm(_left(after, aim)) < np.linalg.norm(values):
                break
            step = 0.5 * step
        else:
            break
        slopes = slopes + np.outer(_left(after, aim) - values - slopes @ step, step) / (step @ step)
        before, x = after, x + step
        if settling.cost_of(after, aim) < settling.cost_of(best, aim):
            best = after
        if settling.is_settled(after, aim):
            break
    return best


def _step(slopes, values):
    """The smallest motion that brings the values to zero, damped, and no further than `MOST_MM`."""
    square = slopes @ slopes.T
    damping = (DAMPING**2) * np.trace(square) * np.eye(len(square))
    step = -slopes.T @ np.linalg.solve(square + damping, values)
    return step * min(1.0, MOST_MM / max(float(np.abs(step).max()), 1e-9))


def _left(state, aim):
    """Net force, net moment at `load.ARM_MM`, and the miss of the sum, in parts of the sum of forces (6 or 7,)."""
    size = state.total_n if aim.total_n is None else aim.total_n
    miss = [] if aim.total_n is None else [state.total_n - aim.total_n]
    return np.concatenate([state.net_n, state.moment_nmm / loads.ARM_MM, miss]) / max(size, 1e-9)


def _pressed(stage, grasp, aim, watch):
    try:
        return settling.pressed(stage, grasp, aim, watch.cancel)
    except (Refusal, native.module.SolveError):
        return None


def _stepped(stage, grasp, aim, watch):
    """The pressed grasp; None where a finger stands in a thin wall or it cannot be pressed."""
    return None if fitter.is_crossed(stage.hand, grasp) else _pressed(stage, grasp, aim, watch)


def _slopes(stage, moves, at, watch):
    """Change (6 or 7, d) of `_left` per mm of each motion; None where one cannot be pressed."""
    state, aim = at
    first, columns = _left(state, aim), []
    for k in range(moves.count):
        fitter.leave_if_cancelled(watch)
        after = _pressed(stage, moves.at(STEP_MM * np.eye(moves.count)[k]), aim, watch)
        if after is None:
            return None
        columns.append((_left(after, aim) - first) / STEP_MM)
    return np.stack(columns, axis=1)


class _Moves:
    """Motions of a grasp: shift (3) and turn (3) of the hand about the product's middle, then `JOINTS`, in mm."""

    def __init__(self, stage, grasp):
        joints = stage.hand.joints
        taking = stage.fit.wish.digits
        self.grasp = grasp
        moved = JOINTS if taking is None or len(taking) > 2 else JOINTS + OF_TWO
        self.joints = [
            (joints.bones[role], COLUMNS[angle], angle_bounds(joints, role, angle))
            for role, angle in moved
            if role in joints.bones and (taking is None or role.partition("_")[0] in taking)
        ]
        self.count = 6 + len(self.joints)

    def at(self, x):
        """The grasp moved by `x` (count,)."""
        motion = np.eye(4)
        motion[:3, :3], motion[:3, 3] = rotation_of(x[3:6] / loads.ARM_MM), x[:3]
        angles = self.grasp.angles.copy()
        for (bone, column, (low, high)), change in zip(self.joints, x[6:], strict=True):
            here = angles[bone, column]
            angles[bone, column] = np.clip(here + change / loads.ARM_MM, min(low, here), max(high, here))
        return replace(self.grasp, angles=angles, place=motion @ self.grasp.place)
