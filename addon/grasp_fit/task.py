"""The least-squares problem of one grasp: what the fit wants to be zero, and its slopes. Knows nothing of Blender."""

from dataclasses import dataclass, replace

import numpy as np

from ..hand import capsules as capsules_of_hand
from ..hand import pads as pads_of_hand
from ..hand.rotations import left_jacobian, rotation_of
from ..hand.skinning import (
    ABDUCTION,
    FLEXION,
    cross,
    descendants,
    joint_axes,
    pose_matrices,
    skin,
    skin_normals,
    to_world,
    vertex_jacobian,
)
from ..hand_bones.roles import COLUMNS, angle_bounds, limits_of
from . import habits
from .least_squares import Problem
from .load import Touched, unit
from .thumb import WEIGHT_FACING, Thumb

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

TURN_MM = 1.0
TURN_COSINE = 0.7
"""How the outward direction turns is read so far aside, so that facets count as the curve they stand for; where it
turns farther than this there is an edge between, or the other wall."""

PLACE = np.array([WEIGHT_SHIFT] * 3 + [WEIGHT_TURN] * 3)

WEIGHT_ALONG = 0.5
"""mm for each mm that a hand around a bar slid beyond `Wish.along_mm`. A fit that balances a moment else slides to the
bar's end: there pads that press run out, and others hook over the edge."""

TRUST_RAD, TRUST_MM = 0.15, 5.0
"""A fit of a settling turns no joint and moves the hand no farther: what pads bear is known from the last press alone.
Fits that went farther left 40 % over where they had promised balance."""

BODY_MM = 1.0
"""Skin outside the pads (sides, webs, back of the fingers) may lie this deep in the product."""


def free_angles(joints):
    """(bone, column, role) of every angle that the fitter may turn: those whose limits leave room."""
    out = []
    for role, bone in joints.bones.items():
        for angle in limits_of(role):
            low, high = angle_bounds(joints, role, angle)
            if high - low > 1e-6:
                out.append((bone, COLUMNS[angle], role))
    return out


@dataclass(frozen=True)
class Goal:
    """What a fit shall reach: `wanted` (p,) depth of every pad, mm, NaN where it takes no part; `limits` (p,) that no
    vertex of a pad shall pass, None for the tissue's own; `load` the forces that shall balance, or None; `bar` the
    center (3) and the axis (3), toward the thumb's side, of a bar that the thumb shall close around, or None.
    A pad that is `shallow_mm` too high or more is drawn in with a force that grows no further. `is_smooth`: skin that
    is too deep counts with all its vertices. `facing_mm` as `thumb.WEIGHT_FACING`: what the thumb's facing
    weighs. `is_near`: the fit goes no farther than `TRUST_RAD` and `TRUST_MM`."""

    wanted: np.ndarray
    limits: np.ndarray | None = None
    load: object = None
    bar: tuple | None = None
    shallow_mm: float = 1.0
    is_smooth: bool = False
    facing_mm: float = WEIGHT_FACING
    is_near: bool = False


class Task:
    """One start of the fit: residuals and their Jacobian in mm for the vector (angles, shift, turn)."""

    def __init__(self, hand, gauge, goal, start, wish):
        place, angles = start
        self.hand, self.gauge, self.wanted, self.goal = hand, gauge, goal.wanted, goal
        self.rig = hand.rig.moved(place)
        self.place, self.first = place, angles
        self.dofs = [dof for dof in free_angles(hand.joints) if _moves(dof[2], wish)]
        self.along_mm = wish.along_mm
        self.rows, self.groups, self.limits = _groups(hand, goal)
        sizes = [len(rows) for rows in self.groups]
        self.floors, self.ends = np.repeat(-np.array(self.limits), sizes), np.cumsum(sizes)[:-1]
        self.part = self.rig.subset(self.rows)
        if gauge.is_thin:
            self.part = _with_normals_on(self.part, sum(len(pad.rows) for pad in hand.pads))
        used = [pad.rows for pad, target in zip(hand.pads, goal.wanted, strict=True) if np.isfinite(target)]
        self.pivot = skin(self.rig.subset(np.concatenate(used)), pose_matrices(self.rig, angles)).mean(axis=0)
        aside = [column != FLEXION or role == "thumb_metacarpal" for _, column, role in self.dofs]
        self.held = np.where(aside, WEIGHT_ASIDE, WEIGHT_START)
        self.coupled = habits.couples(hand.joints, self.dofs)
        if goal.bar is not None:
            of_thumb = habits.of_thumb(hand.joints, self.dofs)
            self.held[[couple[0] for couple in of_thumb]] = 0.0
            self.coupled += of_thumb
        bounds = [angle_bounds(hand.joints, role, _name(column)) for _, column, role in self.dofs]
        shift = [(-wish.free_mm, wish.free_mm)] * 6
        self.bounds = np.array(bounds + shift)
        self.thumb = Thumb(hand, self.rig, goal, self.groups)
        self.start = np.concatenate([[angles[bone, column] for bone, column, _ in self.dofs], np.zeros(6)])
        if goal.is_near:
            near = np.array([TRUST_RAD] * len(self.dofs) + [TRUST_MM] * 6)
            low, high = self.bounds.T
            self.bounds = np.stack([np.maximum(low, self.start - near), np.minimum(high, self.start + near)], axis=1)
        self.state = None
        self.first_cost = float((self.residuals(self.start) ** 2).clip(max=4.0).sum())

    def problem(self):
        """The least-squares problem of this start: a pad may stay too shallow at a low price, but not too deep."""
        pads = int(np.isfinite(self.wanted).sum())

        def robust(values):
            return (np.arange(len(values)) < pads) & (values < 0.0)

        low, high = self.bounds.T
        goal = self.goal
        return Problem(self.residuals, self.jacobian, low, high, robust, goal.shallow_mm, goal.is_near)

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
        self.state = (angles, posed, (points, gap, slopes), chosen, (overlap, contacts, direction))
        bones = (capsules_of_hand.center_points(self.hand.capsules, self.rig, posed) - self.pivot) @ turn.T
        crossed = CROSSED * self.gauge.is_crossed(bones + self.pivot + shift)
        loads = self.goal.load.residuals(Touched(self.rows, points, gap, slopes)) if self.goal.load is not None else []
        lies = self.thumb.residuals(posed, points, (self.pivot, turn, shift))
        off = [crossed, self._along(shift)[0]]
        return np.concatenate([values, WEIGHT_APART * np.maximum(overlap, 0.0), self._soft(x), off, lies, loads])

    def _chosen(self, gap):
        """Rows, factors and values of the depth residuals: pads first, then what of pads and body is too deep.

        With `Goal.is_smooth` the latter is the root of the sum of squares over a group: the deepest vertex alone
        changes from step to step, and a fit stops where two are equally deep.
        """
        chosen, values, extra, extra_values = [], [], [], []
        too_deep = np.flatnonzero(gap < self.floors)
        parts = np.split(too_deep, np.searchsorted(too_deep, self.ends))
        for k, (rows, limit, deep) in enumerate(zip(self.groups, self.limits, parts, strict=True)):
            if k < len(self.wanted) and np.isfinite(self.wanted[k]):
                picked = rows[pads_of_hand.deepest(gap[rows])]
                chosen.append((picked, np.full(len(picked), -1.0 / len(picked))))
                values.append(-gap[picked].mean() - self.wanted[k])
            if not len(deep):
                extra.append((deep, np.zeros(0)))
                extra_values.append(0.0)
                continue
            if not self.goal.is_smooth:
                deep = rows[gap[rows].argmin()][None]
            weight = WEIGHT_DEEP if k < len(self.wanted) else WEIGHT_BODY
            excess = -gap[deep] - limit
            size = float(np.sqrt(excess @ excess))
            extra.append((deep, -weight * excess / max(size, 1e-12)))
            extra_values.append(weight * size)
        return chosen + extra, np.array(values + extra_values)

    def _soft(self, x):
        degrees = np.degrees(x[: len(self.dofs)] - self.start[: len(self.dofs)])
        coupled = [weight * np.degrees(x[d] - share * x[p] + rest) for d, p, share, rest, weight in self.coupled]
        return np.concatenate([coupled, self.held * degrees, PLACE * x[-6:]])

    def _along(self, shift):
        """How far the hand slid along the bar beyond what is free, mm by weight, and its slope (3) by the shift."""
        if self.goal.bar is None:
            return 0.0, np.zeros(3)
        center, axis = self.goal.bar
        off = float((self.pivot + shift - center) @ axis)
        beyond = max(abs(off) - self.along_mm, 0.0)
        return WEIGHT_ALONG * beyond, WEIGHT_ALONG * np.sign(off) * (beyond > 0.0) * axis

    def jacobian(self, x):
        """Derivative (m, d) of the last residuals."""
        angles, posed, (points, gap, slopes), chosen, apart = self.state
        turn, spin = rotation_of(x[-3:] / ARM_MM), left_jacobian(x[-3:] / ARM_MM) / ARM_MM
        used = np.unique(np.concatenate([rows for rows, _ in chosen]).astype(int))
        load = self.goal.load
        if load is not None:
            touched = np.flatnonzero((gap < 0.0) & (load.stiffness[self.rows] > 0.0))
            used = np.union1d(used, touched)
        moves = np.empty((len(used), len(self.dofs) + 6, 3))
        turning = joint_axes(self.rig, posed, angles)
        bent = vertex_jacobian(self.part.subset(used), posed, turning, [dof[:2] for dof in self.dofs])
        moves[:, :-6] = bent @ turn.T
        moves[:, -6:-3] = np.eye(3)
        arms = points[used] - self.pivot - x[-6:-3]
        moves[:, -3:] = cross(spin.T, arms[:, None])
        by_vertex = np.einsum("nkj,nj->nk", moves, slopes[used])
        depth = np.zeros((len(chosen), len(self.dofs) + 6))
        for row, (rows, factors) in enumerate(chosen):
            depth[row] = factors @ by_vertex[np.searchsorted(used, rows)]
        out = [
            depth,
            self._apart(turning, apart),
            self._soft_slope(),
            np.pad(self._along(x[-6:-3])[1], (len(self.dofs), 3))[None],
            self.thumb.slopes((posed, turning, points), (self.pivot, turn, x[-6:-3], spin), self.part, self.dofs),
        ]
        if load is not None:
            skin_there = Touched(self.rows[touched], points[touched], gap[touched], slopes[touched])
            curved = self._curved(skin_there)
            out.append(load.slopes(skin_there, moves[np.searchsorted(used, touched)], curved))
        return np.vstack(out)

    def _curved(self, touched):
        """How the product's outward direction changes with the place (k, 3, 3), 1 / mm, at `Touched` skin."""
        outward = touched.outward
        out = np.zeros((len(outward), 3, 3))
        side = unit(cross(outward, np.eye(3)[np.abs(outward).argmin(axis=1)]))
        for way in (side, cross(outward, side)):
            there = self.gauge.read(touched.points + TURN_MM * way)[1]
            change = np.where((there * outward).sum(axis=1, keepdims=True) > TURN_COSINE, there - outward, 0.0)
            out += change[:, :, None] / TURN_MM * way[:, None]
        return out

    def _apart(self, turning, apart):
        overlap, contacts, direction = apart
        out = np.zeros((len(overlap), len(self.dofs) + 6))
        hit = np.flatnonzero(overlap > 0.0)
        if not len(hit):
            return out
        origins, axes = turning
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
                speed = cross(axis, contacts[hit, side] - origins[bone])
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


def _groups(hand, goal):
    """Vertices the fit looks at, and per group (pads, then the other skin by bone) its places in them and its limit."""
    owner = hand.rig.weights.argmax(axis=1)
    body = np.ones(len(owner), bool)
    members, limits = [], []
    for k, pad in enumerate(hand.pads):
        body[pad.rows] = False
        members.append(pad.rows)
        limits.append(pad.limit_mm if goal.limits is None else min(pad.limit_mm, goal.limits[k]))
    for bone in np.unique(owner[body]):
        members.append(np.flatnonzero(body & (owner == bone))[:: hand.body_step])
        limits.append(BODY_MM)
    rows = np.concatenate(members)
    ends = np.cumsum([0, *(len(group) for group in members)])
    return rows, [np.arange(a, b) for a, b in zip(ends[:-1], ends[1:], strict=True)], limits


def _with_normals_on(part, count):
    """Normals on the first `count` vertices, the pads; the sparse rest is read from where it is, not through walls."""
    return replace(part, normals=np.where(np.arange(len(part.normals))[:, None] < count, part.normals, 0.0))
