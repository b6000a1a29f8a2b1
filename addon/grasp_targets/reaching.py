"""Brings a hand to what a target wants: each round presses the hand, gives the fit what the press showed, and fits
again from there, within the limits of the joints. No Blender objects.
"""

from dataclasses import dataclass, replace

import numpy as np

from .. import native
from ..grasp import settling
from ..grasp_fit import fitter
from ..grasp_fit import load as loads
from ..grasp_fit.least_squares import minimize
from ..grasp_fit.task import Task
from ..scene.checks import Refusal
from . import parts, views

ROUNDS = 10
EVALUATIONS = 25
HALVINGS = 3
"""Rounds of pressing at most, evaluations of the fit in each, and how often a step that does not help is halved."""

GAIN = 0.02
STALLED = 2
"""So many rounds that lower the cost by less than this share end the search."""

DEEP_MM = 30.0
"""What a millimetre of skin counts that is deeper than its tissue allows, mm: such a force is not to be reached."""


@dataclass(frozen=True)
class Target:
    """What to reach. `views` of a fit and the `wanted` values of each, `weights` that make residuals mm of them.

    `measure(state)` gives the values of each view as the contact model says them. `wishes(state, depths)` the depth
    (p,) that the pads are drawn to, from those (p,) they have. What the forces leave over counts `balance_mm`.
    `is_reached(values)`: whether no further round is needed.
    """

    views: tuple
    wanted: tuple
    weights: tuple
    measure: object
    wishes: object
    is_reached: object
    balance_mm: float = 6.0


@dataclass(frozen=True)
class Start:
    """Where a search begins and may lead: the `grasp` of the own frame, the `hand` with the limits of its joints, the
    `wish` that says how far its place may move, and the `angles` (b, 3) from which the first fit begins."""

    grasp: fitter.Grasp
    hand: fitter.Hand
    wish: fitter.Wish
    angles: np.ndarray


@dataclass(frozen=True)
class Reached:
    """The best that was found: the pressed `state`, the `values` of the target's views, the `cost`, mm2, the last
    fit's `task` there with its unknowns `x`, and how much of each pad the tissue still allows, `spare_mm` (p,)."""

    state: settling.State
    values: tuple
    cost: float
    task: Task
    x: np.ndarray
    spare_mm: np.ndarray


def reach(stage, start, target, watch=fitter.ALONE, rounds=ROUNDS):
    """The best `Reached`. Raises `Refusal` where not even the start can be pressed."""
    search = _Search(stage, start, target, watch)
    best, stalled = search.begin(), 0
    for count in range(rounds):
        if target.is_reached(best.values) or stalled >= STALLED:
            break
        watch.report("Reaching the target", count / rounds)
        fitter.leave_if_cancelled(watch)
        after = search.stepped(best)
        if after is None:
            break
        stalled = stalled + 1 if after.cost > (1.0 - GAIN) * best.cost else 0
        best = after
    return best


class _Search:
    def __init__(self, stage, start, target, watch):
        self.stage, self.start, self.target, self.watch = stage, start, target, watch
        hand = stage.fit.press.reading.hand
        self.areas = loads.vertex_areas(hand.rest_mm, hand.triangles)
        pads, count = stage.hand.pads, len(hand.rest_mm)
        limit = np.full(count, np.inf)
        for pad in pads:
            limit[pad.rows] = pad.limit_mm
        self.deep = views.TooDeep(parts.spread(pads, np.arange(len(pads)), count), limit, len(pads))
        self.aim = settling.Aim(np.zeros(3), np.zeros(3))
        self.depths = np.array([start.grasp.depths_mm[pad.name] for pad in pads])

    def begin(self):
        """The start, pressed; its fingers closed first where it asks for that."""
        task = self._task(self.depths, None)
        x = task.start.copy()
        x[:-6] = [self.start.angles[bone, column] for bone, column, _ in task.dofs]
        return self._pressed(task, np.clip(x, task.bounds[:, 0], task.bounds[:, 1]))

    def stepped(self, best):
        """A better `Reached` than `best`, or None."""
        depths = np.array([best.state.grasp.depths_mm[pad.name] for pad in self.stage.hand.pads])
        task = self._task(self.target.wishes(best.state, depths), self._load(best))
        solved = minimize(task.problem(), best.x, EVALUATIONS, cancelled=self.watch.cancelled)
        step = solved.x - best.x
        for _ in range(HALVINGS):
            fitter.leave_if_cancelled(self.watch)
            try:
                after = self._pressed(task, best.x + step)
            except (Refusal, native.module.SolveError):
                after = None
            if after is not None and after.cost < best.cost:
                return after
            step = 0.5 * step
        return None

    def _task(self, wishes, load):
        goal = settling.goal_of(wishes, None, None, load)
        begin = (self.start.grasp.place, self.start.grasp.angles)
        return Task(self.start.hand, self.stage.gauge, goal, begin, self.start.wish)

    def _pressed(self, task, x):
        grasp = fitter.grasp_of(task, x, 0, 0.0)
        state = settling.pressed(self.stage, grasp, self.aim, self.watch.cancel)
        task.residuals(x)
        gap = task.state[2][1]
        spare = np.array([pad.limit_mm + float(gap[rows].min()) for pad, rows in _pads_in(task)])
        values = self.target.measure(state)
        rows = [w * (v - a) for w, v, a in zip(self.target.weights, values, self.target.wanted, strict=True)]
        left = np.concatenate([state.net_n, state.moment_nmm / loads.ARM_MM]) / max(state.total_n, 1e-9)
        deep = np.minimum(spare, 0.0)
        rows += [self.target.balance_mm * left, DEEP_MM * deep, [DEEP_MM * state.sunk_mm]]
        rows += [[settling.CROSSED * 10.0 * (fitter.CROSSED_TEXT in grasp.warnings)]]
        return Reached(state, values, float(sum(np.square(row).sum() for row in rows)), task, x, spare)

    def _load(self, best):
        """What the next fit shall reach, with what the press showed where it begins."""
        force = np.asarray(best.state.contact.force_n)
        gap = settling.gaps_of(self.stage, best.state.grasp)
        stiffness = loads.stiffness_of(self.stage.hand.pads, self.areas, gap, force)
        total = max(best.state.total_n, 1.0)
        balance = loads.Load(stiffness, np.zeros(3), total, self.target.balance_mm, np.zeros(3), np.zeros(3))
        best.task.residuals(best.x)
        here = views.pressed_of(loads.Touched(best.task.rows, *best.task.state[2]), stiffness)
        watched = [
            views.Watched(view, wanted, value - view.values(here), weight)
            for view, wanted, value, weight in zip(
                self.target.views, self.target.wanted, best.values, self.target.weights, strict=True
            )
        ]
        count = self.deep.count
        watched.append(views.Watched(self.deep, np.zeros(count), np.zeros(count), np.full(count, DEEP_MM)))
        return views.Load(balance, tuple(watched))


def start_of(stage, grasp, wish, wanted, most=None):
    """The `Start` at a grasp of the own frame. Digits with pads of which `wanted` (p,) is finite are closed onto the
    product where they are clear of it. `most`: the farthest that a joint may turn, radians, if not its own limits."""
    hand = stage.hand if most is None else _within(stage.hand, grasp.angles, most)
    angles = grasp.angles
    if np.isfinite(wanted).any():
        moved = replace(hand, rig=hand.rig.moved(grasp.place))
        angles = fitter.start_of(moved, stage.gauge, wanted, (None, angles))[1]
    return Start(grasp, hand, wish, angles)


def _within(hand, angles, most):
    """The hand with joints that turn no farther than `most` from `angles` (b, 3), and not past their own limits."""
    from ..grasp_fit.task import free_angles
    from ..hand_bones.roles import COLUMNS, angle_bounds

    names = {column: name for name, column in COLUMNS.items()}
    limits = dict(hand.joints.limits)
    for bone, column, role in free_angles(hand.joints):
        low, high = angle_bounds(hand.joints, role, names[column])
        here = angles[bone, column]
        limits[bone, column] = (max(min(low, here), here - most), min(max(high, here), here + most))
    return replace(hand, joints=replace(hand.joints, limits=limits))


def _pads_in(task):
    """Each pad with the places of its vertices among those that a task looks at."""
    return zip(task.hand.pads, task.groups, strict=False)
