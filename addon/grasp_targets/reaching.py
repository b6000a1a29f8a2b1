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
from ..grasp_fit.task import ARM_MM, Task, free_angles
from ..hand.skinning import FLEXION
from ..hand_bones.roles import COLUMNS, angle_bounds
from ..scene.checks import Refusal
from . import parts, views

ROUNDS = 10
EVALUATIONS = 25
HALVINGS = 4
"""Rounds of pressing at most, evaluations of the fit in each, and how often a step that does not help is halved."""

NEAR_MM2 = 6.0
"""A search that misses no more is not repeated."""

GAIN = 0.02
STALLED = 2
"""So many rounds that lower the cost by less than this share end the search."""

DEEP_MM = 30.0
"""What a millimetre of skin counts that is deeper than its tissue allows, mm: such a force is not to be reached."""

MOST_MPA = settling.MOST_MPA
EASED = 0.97
HARD_MM = 300.0
"""No pad shall press harder, as in `settling`; the fit is held to this share of it; what a pad counts that
presses with twice of it, mm."""

BODY_MM = 3.0
"""Skin outside the pads may lie this deep in the product, or as deep as it did in the beginning."""

CROSSED_MM = 200.0
"""What a finger counts that stands in a thin wall, mm."""

STEP = 0.004
FARTHEST = 0.05
POLISHES = 6
DAMPING = 1e-4
"""Radians by which slopes are taken; a shift of the hand is counted at `task.ARM_MM`. No step turns a joint farther
than `FARTHEST`. So many steps; their damping in parts of the trace."""

TINY = 1e-9
BALANCE_ROWS = 7
"""Rows of a `load.Load`: force, moment, sum."""


@dataclass(frozen=True)
class Target:
    """What to reach. `views` of a fit and the `wanted` values of each, `weights` that make residuals mm of them.

    `measure(state)` gives the values of each view as the contact model says them. `wishes(state, depths)` the depth
    (p,) that the pads are drawn to, from those (p,) they have. `is_reached(values)`: whether the search may end.
    What the forces leave over counts `balances_mm` for all of them, first and last: a posture in balance is found
    first, and gives way to the target in the end.
    """

    views: tuple
    wanted: tuple
    weights: tuple
    measure: object
    wishes: object
    is_reached: object
    balances_mm: tuple = (20.0, 5.0)


@dataclass(frozen=True)
class Start:
    """Where a search begins and may lead: the `grasp` of the own frame, the `hand` with the limits of its joints, the
    `wish` that says how far its place may move, and the `angles` (b, 3) from which the first fit begins; or all
    its unknowns `x` of an earlier search from the same grasp."""

    grasp: fitter.Grasp
    hand: fitter.Hand
    wish: fitter.Wish
    angles: np.ndarray
    x: np.ndarray | None = None


@dataclass(frozen=True)
class Reached:
    """The best that was found: the pressed `state`, the `values` of the target's views, the `cost`, mm2, the last
    fit's `task` there with its unknowns `x`, and how much deeper each pad may be pressed, and then the other skin,
    `spare_mm` (p + 1,)."""

    state: settling.State
    values: tuple
    cost: float
    task: Task
    x: np.ndarray
    spare_mm: np.ndarray

    def depths(self):
        """Depth of every pad (p,), mm."""
        return np.array([self.state.grasp.depths_mm[pad.name] for pad in self.task.hand.pads])


def reach(stage, start, target, watch=fitter.ALONE, rounds=ROUNDS):
    """The best `Reached`. Raises `Refusal` where not even the start can be pressed.

    Where the target is not reached by way of a posture in balance, it is sought without that, too.
    """
    ways = [target.balances_mm, target.balances_mm[-1:]][: len(target.balances_mm)]
    best = None
    for number, balances_mm in enumerate(ways):
        own = in_part(watch, number, len(ways))
        found = _reached(stage, start, replace(target, balances_mm=balances_mm), own, rounds)
        best = found if best is None or found.cost < best.cost else best
        if best.cost < NEAR_MM2:
            break
    return best


def in_part(watch, number, count):
    """The watch of one of `count` parts of a computation."""

    def said(words, share):
        watch.report(words, (number + share) / count)

    return fitter.Watch(said, watch.cancel)


def _reached(stage, start, target, watch, rounds):
    best = None
    for number, balance_mm in enumerate(target.balances_mm):
        trial, stalled = _Search(stage, start, (target, balance_mm), watch), 0
        best = trial.begin() if best is None else trial.again(best)
        for count in range(rounds):
            if stalled >= STALLED or (number == len(target.balances_mm) - 1 and target.is_reached(best.values)):
                break
            watch.report("Reaching the target", (number + count / rounds) / len(target.balances_mm))
            fitter.leave_if_cancelled(watch)
            after = trial.stepped(best)
            if after is None:
                break
            stalled = stalled + 1 if after.cost > (1.0 - GAIN) * best.cost else 0
            best = after
    return _polished(trial, best)


def slopes_of(stage, start, target, reached):
    """How the rows of the first view change with the unknowns (f, d) at a `Reached`, in the view's own unit."""
    trial = _Search(stage, start, (target, 0.0), fitter.ALONE)
    load = trial.load(reached)
    task = trial.task(reached.depths(), load)
    task.residuals(reached.x)
    rows = sum(len(each.wanted) for each in load.watched) + BALANCE_ROWS
    return task.jacobian(reached.x)[-rows:][: len(target.wanted[0])] / target.weights[0][:, None]


def within(task, x, free_mm):
    """Unknowns within the limits of the joints, with a shift of the hand and a turn of it no longer than `free_mm`."""
    out = np.clip(x, task.bounds[:, 0], task.bounds[:, 1])
    for part in (out[-6:-3], out[-3:]):
        part *= min(1.0, free_mm / max(float(np.linalg.norm(part)), TINY))
    return out


class _Search:
    def __init__(self, stage, start, asked, watch):
        self.stage, self.start, self.watch = stage, start, watch
        self.target, self.balance_mm = asked
        hand = stage.fit.press.reading.hand
        self.areas = loads.vertex_areas(hand.rest_mm, hand.triangles)
        pads, count = stage.hand.pads, len(hand.rest_mm)
        part = parts.spread(pads, np.arange(len(pads)), count)
        self.part = np.where(part < 0, len(pads), part)
        self.limits = np.array([*(pad.limit_mm for pad in pads), max(BODY_MM, start.grasp.deepest_body_mm)])
        self.aim = settling.Aim(np.zeros(3), np.zeros(3))
        self.depths = np.array([start.grasp.depths_mm[pad.name] for pad in pads])

    def begin(self):
        """The start, pressed; its fingers closed first where it asks for that."""
        task = self.task(self.depths, None)
        if self.start.x is not None:
            return self._pressed(task, self.start.x)
        x = task.start.copy()
        x[:-6] = [self.start.angles[bone, column] for bone, column, _ in task.dofs]
        return self._pressed(task, within(task, x, self.start.wish.free_mm))

    def again(self, best):
        """The same posture with its cost here."""
        return replace(best, cost=self._cost(best.state, best.values, best.spare_mm))

    def stepped(self, best):
        """A better `Reached` than `best`, or None."""
        task = self.task(self.target.wishes(best.state, best.depths()), self.load(best))
        solved = minimize(task.problem(), best.x, EVALUATIONS, cancelled=self.watch.cancelled)
        step = solved.x - best.x
        for _ in range(HALVINGS):
            fitter.leave_if_cancelled(self.watch)
            after = self.pressed_at(replace(best, task=task), best.x + step)
            if after is not None and after.cost < best.cost:
                return after
            step = 0.5 * step
        return None

    def task(self, wishes, load):
        """The fit that draws pads to depths (p,) with a load, with the start for its posture at rest."""
        goal = settling.goal_of(wishes, None, None, load)
        begin = (self.start.grasp.place, self.start.grasp.angles)
        return Task(self.start.hand, self.stage.gauge, goal, begin, self.start.wish)

    def _pressed(self, task, x):
        grasp = fitter.grasp_of(task, x, 0, 0.0)
        state = settling.pressed(self.stage, grasp, self.aim, self.watch.cancel)
        task.residuals(x)
        gap = task.state[2][1]
        count = len(self.stage.hand.pads)
        lowest = [float(gap[rows].min(initial=np.inf)) for rows in task.groups]
        lowest = np.array([*lowest[:count], min(lowest[count:], default=np.inf)])
        spare = self.limits + lowest
        values = self.target.measure(state)
        return Reached(state, values, self._cost(state, values, spare), task, x, spare)

    def _cost(self, state, values, spare):
        return float(np.square(self.rows(state, values, spare)).sum())

    def rows(self, state, values, spare):
        """Everything that a pressed state misses, mm."""
        rows = [w * (v - a) for w, v, a in zip(self.target.weights, values, self.target.wanted, strict=True)]
        left = np.concatenate([state.net_n, state.moment_nmm / loads.ARM_MM]) / max(state.total_n, 1e-9)
        rows += [self.balance_mm * left, DEEP_MM * np.minimum(spare, 0.0), [DEEP_MM * state.sunk_mm]]
        rows += [HARD_MM * np.maximum(state.peaks_mpa / MOST_MPA - 1.0, 0.0)]
        rows += [[CROSSED_MM * (fitter.CROSSED_TEXT in state.grasp.warnings)]]
        return np.concatenate(rows)

    def pressed_at(self, best, x):
        """The `Reached` at the unknowns `x` of the fit of `best`, or None where it cannot be pressed."""
        try:
            return self._pressed(best.task, within(best.task, x, self.start.wish.free_mm))
        except (Refusal, native.module.SolveError):
            fitter.leave_if_cancelled(self.watch)
            return None

    def load(self, best):
        """What the next fit shall reach, with what the press showed where it begins."""
        force = np.asarray(best.state.contact.force_n)
        gap = settling.gaps_of(self.stage, best.state.grasp)
        stiffness = loads.stiffness_of(self.stage.hand.pads, self.areas, gap, force)
        total = max(best.state.total_n, 1.0)
        balance = loads.Load(stiffness, np.zeros(3), total, max(self.balance_mm, TINY), np.zeros(3), np.zeros(3))
        best.task.residuals(best.x)
        touched = loads.Touched(best.task.rows, *best.task.state[2])
        here = views.pressed_of(touched, stiffness)
        left = total / balance.weight_mm * balance.residuals(touched)
        balance = replace(
            balance,
            outer_n=best.state.net_n - left[:3],
            outer_moment_nmm=best.state.moment_nmm - loads.ARM_MM * left[3:6],
        )
        watched = [
            views.Watched(view, wanted, value - view.values(here), weight)
            for view, wanted, value, weight in zip(
                self.target.views, self.target.wanted, best.values, self.target.weights, strict=True
            )
        ]
        count = len(self.limits)
        eased = np.minimum((EASED * MOST_MPA / np.maximum(best.state.peaks_mpa, 1e-9)) ** (1.0 / loads.POWER), 1.0)
        limits = self.limits.copy()
        deepest = np.maximum(limits - best.spare_mm, 0.3)[:-1]
        limits[:-1] = np.where(eased < 1.0, np.minimum(limits[:-1], deepest * eased), limits[:-1])
        deep = views.TooDeep(self.part, limits[self.part], count)
        watched.append(views.Watched(deep, np.zeros(count), np.zeros(count), np.full(count, DEEP_MM)))
        return views.Load(balance, tuple(watched))


def _polished(trial, best):
    """The last of a target by presses alone: slopes of it by bending each digit and moving the hand a little."""
    if trial.target.is_reached(best.values):
        return best
    ways = _ways(best.task)
    base = trial.rows(best.state, best.values, best.spare_mm)
    columns = []
    for way in ways:
        fitter.leave_if_cancelled(trial.watch)
        after = trial.pressed_at(best, best.x + STEP * way)
        columns.append(np.zeros_like(base) if after is None else (_rows(trial, after) - base) / STEP)
    slopes = np.stack(columns, axis=1)
    for count in range(POLISHES):
        trial.watch.report("Reaching the target", 0.9 + 0.1 * count / POLISHES)
        fitter.leave_if_cancelled(trial.watch)
        base = _rows(trial, best)
        square = slopes.T @ slopes
        share = np.linalg.solve(square + DAMPING * np.trace(square) * np.eye(len(ways)), -slopes.T @ base)
        share *= min(1.0, FARTHEST / max(float(np.abs(share).max()), 1e-12))
        after, halvings = None, 0
        while halvings < HALVINGS:
            after = trial.pressed_at(best, best.x + share @ ways)
            if after is not None and after.cost < best.cost:
                break
            share, halvings = 0.5 * share, halvings + 1
        else:
            break
        change = _rows(trial, after) - base
        slopes = slopes + np.outer(change - slopes @ share, share) / (share @ share)
        best = after
        if trial.target.is_reached(best.values):
            break
    return best


def _rows(trial, reached):
    return trial.rows(reached.state, reached.values, reached.spare_mm)


def _ways(task):
    """Motions (k, d) of a fit's unknowns: each finger bent in all its joints, each joint of the thumb, each way of the
    hand that is free."""
    roles = [role.partition("_")[0] for _, _, role in task.dofs]
    bends = [column == FLEXION for _, column, _ in task.dofs]
    out = []
    for digit in [role for role in dict.fromkeys(roles) if role != "thumb"]:
        way = np.zeros(len(task.start))
        way[:-6] = [one == digit and is_bent for one, is_bent in zip(roles, bends, strict=True)]
        out.append(way)
    single = np.eye(len(task.start))
    out += [single[k] for k, role in enumerate(roles) if role == "thumb"]
    out += [ARM_MM * each for each in single[-6:] if task.bounds[each > 0.0, 1] > task.bounds[each > 0.0, 0]]
    return np.array(out)


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
    names = {column: name for name, column in COLUMNS.items()}
    limits = dict(hand.joints.limits)
    for bone, column, role in free_angles(hand.joints):
        low, high = angle_bounds(hand.joints, role, names[column])
        here = angles[bone, column]
        limits[bone, column] = (max(min(low, here), here - most), min(max(high, here), here + most))
    return replace(hand, joints=replace(hand.joints, limits=limits))
