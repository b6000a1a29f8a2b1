"""The grasp fitter: joint angles and the hand's place for which every pad lies as deep in the product as asked.

Knows nothing of Blender. What Xie et al. did by hand ("moving fingers until the force fitted") as least squares:
26 unknowns on the hand's own rig (16 finger, 5 thumb, 1 palm arch, up to 6 of the hand's place less its null motions).
"""

import time
from dataclasses import dataclass, replace

import numpy as np

from ..scene.checks import Refusal
from . import capsules as capsules_of_hand
from . import closing, habits, walls
from . import pads as pads_of_hand
from .least_squares import Problem, minimize
from .poses import OPEN
from .roles import COLUMNS, FINGERS, angle_bounds, limits_of, pose_angles
from .rotations import left_jacobian, rotation_of
from .skinning import (
    ABDUCTION,
    FLEXION,
    descendants,
    joint_axes,
    pose_matrices,
    skin,
    skin_normals,
    to_world,
    vertex_jacobian,
)

ARM_MM = 60.0
"""A turn of the whole hand is counted in mm at this arm, so that turns and shifts weigh alike."""

WEIGHT_START = 0.025
WEIGHT_ASIDE = 0.05
WEIGHT_SHIFT = 0.02
WEIGHT_TURN = 0.05
WEIGHT_DEEP = 2.0
WEIGHT_APART = 3.0
WEIGHT_BODY = 1.5
"""Residuals are mm: pads weigh 1 per mm; per degree for joints, per mm for the rest. ASIDE holds abduction and the
thumb's first joint near the closing hand, or fingers splay and the thumb lies down along the product (seen at 0.012).
TURN at 0.02 let the product lie along the fingers. Chosen by eye on the three cylinders; no range was measured."""

CROSSED = 1e3
"""Residual of a finger that stands in a thin wall: more than any other, so that no step leads there."""
CROSSED_TEXT = (
    "a finger stands in a thin wall of the product; pose each finger on the side it presses and keep the places"
)

PLACE = np.array([WEIGHT_SHIFT] * 3 + [WEIGHT_TURN] * 3)

BODY_MM = 1.0
"""Skin outside the pads (sides, webs, back of the fingers) may lie this deep in the product."""


class GraspError(Refusal):
    """The grasp cannot be fitted; the message says why and what to do."""


@dataclass(frozen=True)
class Hand:
    """What a fit is made of: `rig`, its `joints`, its `pads`, and its `capsules`."""

    rig: object
    joints: object
    pads: list
    capsules: object


@dataclass(frozen=True)
class Grasp:
    """A fitted grasp. `angles` (b, 3) turns from rest, radians; `place` (4, 4) carries the hand through the world, mm.

    `depths_mm` and `targets_mm` by pad name; `seconds` the time taken; `warnings` texts; `gauge` what read the depths.
    """

    angles: np.ndarray
    place: np.ndarray
    depths_mm: dict
    targets_mm: dict
    deepest_body_mm: float
    evaluations: int
    seconds: float
    warnings: tuple
    gauge: walls.Gauge
    force_n: float | None = None


@dataclass(frozen=True)
class Wish:
    """What to fit: `targets_mm` by kind of pad; `digits` that take part (None: all, with the palm); `is_placed` keeps
    the hand's place within `free_mm` of where it stands and closes it from `angles`, otherwise the product is laid into
    the open palm; `axis` and `center` of the product (world mm) if its own long axis is not the one to grasp."""

    targets_mm: dict
    digits: tuple = None
    is_placed: bool = False
    free_mm: float = 40.0
    angles: object = None
    axis: tuple = None
    center: tuple = None
    evaluations: int = 70


@dataclass(frozen=True)
class Watch:
    """Called between evaluations: `report(text, fraction)`; `cancel` has `is_set()`, or is None."""

    report: object = lambda text, fraction: None
    cancel: object = None

    def cancelled(self):
        """Whether the fit shall end."""
        return self.cancel is not None and self.cancel.is_set()


ALONE = Watch()


def fit(hand, product, vertices, wish, watch=ALONE):
    """The best `Grasp` of `product` (gap_mm) with world `vertices` (k, 3), mm.

    Raises `GraspError` if no pad reaches the product.
    """
    began = time.perf_counter()
    wanted = _wanted(hand.pads, wish)
    gauge = walls.gauge_of(product, vertices, np.nanmax(wanted, initial=0.0))
    starts = []
    for count, placing in enumerate(_placings(hand, vertices, wish)):
        watch.report("Closing the fingers", 0.1 * count)
        _leave_if_cancelled(watch)
        starts.append(_start(hand, gauge, wanted, (placing, wish.angles)))
    tasks = [_Task(hand, gauge, wanted, start, wish) for start in starts]
    tasks.sort(key=lambda task: task.first_cost)
    best, used = None, 0
    for count, task in enumerate(tasks[:2]):
        watch.report("Fitting", 0.3 + 0.35 * count)
        found = minimize(task.problem(), task.start, wish.evaluations, cancelled=watch.cancelled)
        used += found.evaluations
        if best is None or found.cost < best[0].cost:
            best = found, task
        _leave_if_cancelled(watch)
    return _grasp(best[1], best[0].x, used, time.perf_counter() - began)


def _leave_if_cancelled(watch):
    if watch.cancelled():
        raise GraspError("the fit was cancelled")


def refit(hand, found, wish, watch=ALONE):
    """The `Grasp` from an earlier one with other target depths; raises as `fit` does."""
    began = time.perf_counter()
    task = _Task(hand, found.gauge, _wanted(hand.pads, wish), (found.place, found.angles), wish)
    solved = minimize(task.problem(), task.start, wish.evaluations, cancelled=watch.cancelled)
    return _grasp(task, solved.x, found.evaluations + solved.evaluations, found.seconds + time.perf_counter() - began)


def _wanted(pads, wish):
    """Target depth per pad, NaN where the pad does not take part."""

    def takes_part(pad):
        part = "palm" if pad.kind == "palm" else pad.role.partition("_")[0]
        return pad.kind in wish.targets_mm and (wish.digits is None or part in wish.digits)

    return np.array([wish.targets_mm.get(pad.kind, np.nan) if takes_part(pad) else np.nan for pad in pads])


def _placings(hand, vertices, wish):
    if wish.is_placed:
        return [None]
    center, axis = closing.product_axis(vertices)
    center = center if wish.center is None else np.array(wish.center, float)
    axis = axis if wish.axis is None else np.array(wish.axis, float) / np.linalg.norm(wish.axis)
    size = np.linalg.norm(hand.rig.world_from_rig[:3, :3], axis=0).mean()
    bones = [hand.joints.bones[f"{f}_proximal"] for f in FINGERS if f"{f}_proximal" in hand.joints.bones]
    heads = hand.rig.rest[bones, :3, 3]
    breadth = size * np.linalg.norm(heads[0] - heads[-1]) if len(heads) > 1 else 55.0
    return [(center, axis, np.radians(oblique), along * breadth) for oblique in (6.0, 18.0) for along in (-0.35, -0.1)]


def _start(hand, gauge, wanted, begin):
    placing, angles = begin
    pads = [pad for pad, target in zip(hand.pads, wanted, strict=True) if np.isfinite(target)]
    place = np.eye(4)
    if placing is not None:
        place = closing.lay_into_palm(hand.rig, hand.joints, hand.pads, gauge, placing)
    moved = hand.rig.moved(place)
    opened = pose_angles(hand.rig, hand.joints, OPEN) if angles is None else angles
    if gauge.is_thin:
        opened = closing.clear_fingers(moved, hand.joints, hand.capsules, gauge, opened)
    return place, closing.close_fingers(moved, hand.joints, pads, gauge, opened)


def free_angles(joints):
    """(bone, column, role) of every angle that the fitter may turn: those whose limits leave room."""
    out = []
    for role, bone in joints.bones.items():
        for angle in limits_of(role):
            low, high = angle_bounds(joints, role, angle)
            if high - low > 1e-6:
                out.append((bone, COLUMNS[angle], role))
    return out


class _Task:
    """One start of the fit: residuals and their Jacobian in mm for the vector (angles, shift, turn)."""

    def __init__(self, hand, gauge, wanted, start, wish):
        place, angles = start
        self.hand, self.gauge, self.wanted = hand, gauge, wanted
        self.rig = hand.rig.moved(place)
        self.place, self.first = place, angles
        self.dofs = [dof for dof in free_angles(hand.joints) if _moves(dof[2], wish)]
        self.rows, self.groups, self.limits = _groups(hand, wanted)
        self.part = self.rig.subset(self.rows)
        if gauge.is_thin:
            self.part = _with_normals_on(self.part, sum(len(pad.rows) for pad in hand.pads))
        used = [pad.rows for pad, target in zip(hand.pads, wanted, strict=True) if np.isfinite(target)]
        self.pivot = skin(self.rig.subset(np.concatenate(used)), pose_matrices(self.rig, angles)).mean(axis=0)
        aside = [column != FLEXION or role == "thumb_metacarpal" for _, column, role in self.dofs]
        self.held = np.where(aside, WEIGHT_ASIDE, WEIGHT_START)
        self.coupled = habits.couples(hand.joints, self.dofs)
        bounds = [angle_bounds(hand.joints, role, _name(column)) for _, column, role in self.dofs]
        shift = [(-wish.free_mm, wish.free_mm)] * 6
        self.bounds = np.array(bounds + shift)
        self.start = np.concatenate([[angles[bone, column] for bone, column, _ in self.dofs], np.zeros(6)])
        self.state = None
        self.first_cost = float((self.residuals(self.start) ** 2).clip(max=4.0).sum())

    def problem(self):
        """The least-squares problem of this start: a pad may stay too shallow at a low price, but not too deep."""
        pads = int(np.isfinite(self.wanted).sum())

        def robust(values):
            return (np.arange(len(values)) < pads) & (values < 0.0)

        return Problem(self.residuals, self.jacobian, self.bounds[:, 0], self.bounds[:, 1], robust)

    def pose(self, x):
        """Angles (b, 3) and the motion of the hand (turn (3, 3), shift (3)) about the pivot."""
        angles = self.first.copy()
        for value, (bone, column, _) in zip(x, self.dofs, strict=False):
            angles[bone, column] = value
        return angles, rotation_of(x[-3:] / ARM_MM), x[-6:-3]

    def residuals(self, x):
        """Everything the fit wants to be zero, mm."""
        angles, turn, shift = self.pose(x)
        posed = pose_matrices(self.rig, angles)
        still = skin(self.part, posed)
        points = (still - self.pivot) @ turn.T + self.pivot + shift
        normals = skin_normals(self.part, posed) @ turn.T if self.gauge.is_thin else None
        gap, slopes = self.gauge.read(points, normals)
        overlap, contacts, direction = capsules_of_hand.overlaps(self.hand.capsules, self.rig, posed)
        chosen, values = self._chosen(gap)
        self.state = (angles, posed, points, slopes, chosen, (overlap, contacts, direction))
        bones = (capsules_of_hand.center_points(self.hand.capsules, self.rig, posed) - self.pivot) @ turn.T
        crossed = CROSSED * self.gauge.is_crossed(bones + self.pivot + shift)
        return np.concatenate([values, WEIGHT_APART * np.maximum(overlap, 0.0), self._soft(x), [crossed]])

    def _chosen(self, gap):
        """Rows and slopes of the depth residuals: pads first, then too deep vertices of pads and body."""
        chosen, values, extra, extra_values = [], [], [], []
        for k, (rows, limit) in enumerate(zip(self.groups, self.limits, strict=True)):
            own = gap[rows]
            if k < len(self.wanted) and np.isfinite(self.wanted[k]):
                picked = rows[pads_of_hand.deepest(own)]
                chosen.append((picked, -1.0 / len(picked)))
                values.append(-gap[picked].mean() - self.wanted[k])
            excess = -own.min(initial=0.0) - limit
            weight = WEIGHT_DEEP if k < len(self.wanted) else WEIGHT_BODY
            if excess > 0.0:
                extra.append((rows[[int(own.argmin())]], -weight))
            else:
                extra.append((rows[:0], 0.0))
            extra_values.append(weight * max(excess, 0.0))
        return chosen + extra, np.array(values + extra_values)

    def _soft(self, x):
        degrees = np.degrees(x[: len(self.dofs)] - self.start[: len(self.dofs)])
        coupled = [weight * np.degrees(x[d] - share * x[p] + rest) for d, p, share, rest, weight in self.coupled]
        return np.concatenate([coupled, self.held * degrees, PLACE * x[-6:]])

    def jacobian(self, x):
        """Derivative (m, d) of the last residuals."""
        angles, posed, points, slopes, chosen, apart = self.state
        turn, spin = rotation_of(x[-3:] / ARM_MM), left_jacobian(x[-3:] / ARM_MM) / ARM_MM
        used = np.unique(np.concatenate([rows for rows, _ in chosen]).astype(int))
        slopes = slopes[used]
        moves = vertex_jacobian(self.part.subset(used), posed, angles, [dof[:2] for dof in self.dofs])
        count = len(self.dofs)
        by_vertex = np.zeros((len(used), count + 6))
        by_vertex[:, :count] = np.einsum("nkj,nj->nk", moves, slopes @ turn)
        by_vertex[:, count : count + 3] = slopes
        arms = points[used] - self.pivot - x[-6:-3]
        by_vertex[:, count + 3 :] = np.cross(arms, slopes) @ spin
        depth = np.zeros((len(chosen), count + 6))
        for row, (rows, factor) in enumerate(chosen):
            if len(rows):
                depth[row] = factor * by_vertex[np.searchsorted(used, rows)].sum(axis=0)
        return np.vstack([depth, self._apart(posed, angles, apart), self._soft_slope()])

    def _apart(self, posed, angles, apart):
        overlap, contacts, direction = apart
        out = np.zeros((len(overlap), len(self.dofs) + 6))
        hit = np.flatnonzero(overlap > 0.0)
        if not len(hit):
            return out
        origins, axes = joint_axes(self.rig, posed, angles)
        origins = to_world(self.rig, origins)
        linear = self.rig.world_from_rig[:3, :3]
        mirror = np.sign(np.linalg.det(linear))
        below = descendants(self.rig.parents)
        bones = self.hand.capsules.bones[self.hand.capsules.pairs]
        for k, (bone, column, _) in enumerate(self.dofs):
            axis = linear @ axes[bone, :, column]
            axis = mirror * axis / np.linalg.norm(axis)
            for side, sign in ((0, -1.0), (1, 1.0)):
                carried = below[bone, bones[hit, side]]
                speed = np.cross(axis, contacts[hit, side] - origins[bone])
                out[hit, k] += sign * carried * (speed * direction[hit]).sum(axis=1)
        return WEIGHT_APART * out

    def _soft_slope(self):
        count = len(self.dofs)
        coupled = np.zeros((len(self.coupled), count + 6))
        for row, (d, p, share, _, weight) in enumerate(self.coupled):
            coupled[row, d], coupled[row, p] = weight, -weight * share
        start = np.eye(count, count + 6)
        place = np.eye(6, count + 6, k=count)
        degree = np.degrees(1.0)
        return np.vstack(
            [degree * coupled, degree * self.held[:, None] * start, PLACE[:, None] * place, np.zeros((1, count + 6))]
        )


def _moves(role, wish):
    return wish.digits is None or role.partition("_")[0] in wish.digits


def _name(column):
    return {FLEXION: "flexion", ABDUCTION: "abduction"}.get(column, "twist")


def _groups(hand, wanted):
    """Vertices the fit looks at, and per group (pads, then the other skin by bone) its places in them and its limit."""
    owner = hand.rig.weights.argmax(axis=1)
    body = np.ones(len(owner), bool)
    members, limits = [], []
    for pad in hand.pads:
        body[pad.rows] = False
        members.append(pad.rows)
        limits.append(pad.limit_mm)
    for bone in np.unique(owner[body]):
        members.append(np.flatnonzero(body & (owner == bone))[::4])
        limits.append(BODY_MM)
    rows = np.concatenate(members)
    ends = np.cumsum([0, *(len(group) for group in members)])
    return rows, [np.arange(a, b) for a, b in zip(ends[:-1], ends[1:], strict=True)], limits


def _with_normals_on(part, count):
    """Normals on the first `count` vertices, the pads; the sparse rest is read from where it is, not through walls."""
    return replace(part, normals=np.where(np.arange(len(part.normals))[:, None] < count, part.normals, 0.0))


def _grasp(task, x, used, seconds):
    angles, turn, shift = task.pose(x)
    motion = np.eye(4)
    motion[:3, :3] = turn
    motion[:3, 3] = task.pivot + shift - turn @ task.pivot
    place = motion @ task.place
    rig = task.hand.rig.moved(place)
    posed = pose_matrices(rig, angles)
    gap = task.gauge.gaps(skin(rig, posed), skin_normals(rig, posed) if task.gauge.is_thin else None)
    depths = {pad.name: pads_of_hand.pad_depth(gap[pad.rows]) for pad in task.hand.pads}
    wanted = zip(task.hand.pads, task.wanted, strict=True)
    targets = {pad.name: float(want) for pad, want in wanted if np.isfinite(want)}
    if max(depths[name] for name in targets) < 0.0:
        raise GraspError("the product is out of the hand's reach; move it into the open hand, or make it smaller")
    body = np.ones(len(gap), bool)
    for pad in task.hand.pads:
        body[pad.rows] = False
    missed = [name for name, want in targets.items() if depths[name] < 0.0 < want]
    warnings = (f"does not touch: {', '.join(missed)}",) if missed else ()
    if task.gauge.is_crossed(capsules_of_hand.center_points(task.hand.capsules, rig, posed)):
        warnings += (CROSSED_TEXT,)
    return Grasp(
        angles, place, depths, targets, float(-gap[body].min(initial=0.0)), used, seconds, warnings, task.gauge
    )
