"""The thumb of a power grip: it closes around the bar against the fingers, and its pad faces the index finger's.

Knows nothing of Blender. World mm, radians; each residual is a cosine that shall not stay below a bound.
"""

import numpy as np

from ..hand import pads as pads_of_hand
from ..hand.skinning import TWIST, cross, descendants, to_world, vertex_jacobian

WEIGHT_AROUND = 12.0
AROUND = 0.7
"""mm for each unit that the cosine between the thumb and the way around a bar stays below `AROUND`: in a power grip
the thumb closes around the bar, against the fingers."""

WEIGHT_FACING = 16.0
FACING = 0.97
"""mm for each unit that the cosine between the way the thumb's pad faces and the way to the index finger's pad stays
below `FACING`, 14 degrees."""

WEIGHT_INWARD = 12.0
INWARD = 0.7
"""mm for each unit that the cosine between the way the thumb's pad faces and the way to the bar's axis stays below
`INWARD`: without it the thumb hooks past the bar's end and faces the index finger along the bar."""

LOOKED_AT = 12
"""So many vertices of a pad stand for it."""


class Thumb:
    """The thumb of a `task.Task`. `rig` is the hand's where the task begins; `goal.bar` the bar, or None: then nothing
    is asked of the thumb. `groups`: places of every pad's vertices in `part`, the rig's vertices that are looked at."""

    def __init__(self, hand, rig, goal, groups):
        self.joints, self.rig, self.bar, self.weight = hand.joints, rig, goal.bar, goal.facing_mm
        self.bone = hand.joints.bone("thumb_distal") if goal.bar is not None else None
        self.pads = [_rows_of(hand.pads, groups, f"{digit}_distal") for digit in ("thumb", "index")]
        self.local = None if self.bone is None else _facing_of(hand, self.bone)

    def residuals(self, posed, points, motion):
        """mm (3,): what the pad misses of facing the bar, then of facing the index finger's pad, then what the thumb
        misses of the way around. `posed` (b, 4, 4) bones; `points` of the task's vertices in the world; `motion`: the
        pivot, the turn (3, 3) and the shift of the hand."""
        inward, facing = self._inward(posed, points, motion[1])[0], self._facing(posed, points, motion[1])[0]
        around = self._around(posed, motion)[0]
        misses = [max(INWARD - inward, 0.0), max(FACING - facing, 0.0), max(AROUND - around, 0.0)]
        return [weight * miss for weight, miss in zip(self._weights(), misses, strict=True)]

    def slopes(self, at, motion, part, dofs):
        """Rows (3, d + 6) of the Jacobian that go with `residuals`.

        `at`: the posed bones, their `joint_axes` and the points; `motion`: pivot, turn, shift, and the spin (3, 3) that
        a change of the turn's vector makes.
        """
        posed, turning, points = at
        out = np.zeros((3, len(dofs) + 6))
        if self.bone is None:
            return out
        pivot, turn, shift, spin = motion
        spins = self._spins(turning, motion, dofs)
        inward, way, direction, by_pad = self._inward(posed, points, turn)
        facing, other, _, far = self._facing(posed, points, turn)
        if inward < INWARD or facing < FACING:
            thumb, index = self._pad_slopes((posed, turning, part, dofs), turn)
            out[0, :-6], out[1, :-6] = thumb @ by_pad, (index - thumb) @ (direction - facing * other) / far
            for k, (axis, _) in spins.items():
                out[:2, k] += np.stack([way, other]) @ cross(axis, direction)
            arm = points[self.pads[0]].mean(axis=0) - pivot - shift if len(self.pads[0]) else np.zeros(3)
            out[0, -6:-3] = by_pad
            out[0, -3:] = (cross(direction, way) + cross(arm, by_pad)) @ spin
            out[:2] *= [[inward < INWARD], [facing < FACING]]
        around, way, direction, head, by_head = self._around(posed, motion[:3])
        if around < AROUND:
            for k, (axis, origin) in spins.items():
                out[2, k] = cross(axis, direction) @ way + cross(axis, head - origin) @ by_head
            out[2, -6:-3] = by_head
            out[2, -3:] = (cross(direction, way) + cross(head - pivot - shift, by_head)) @ spin
        return -np.array(self._weights())[:, None] * out

    def _weights(self):
        return WEIGHT_INWARD * self.weight / WEIGHT_FACING, self.weight, WEIGHT_AROUND

    def _spins(self, turning, motion, dofs):
        """For each angle that turns the thumb's last bone: its axis (3) and where that passes (3), in the world."""
        pivot, turn, shift, _ = motion
        linear = turn @ self.rig.world_from_rig[:3, :3]
        origins, axes = turning
        origins = (to_world(self.rig, origins) - pivot) @ turn.T + pivot + shift
        below = descendants(self.rig.parents)[:, self.bone]
        out = {}
        for k, (bone, column, _) in enumerate(dofs):
            if below[bone]:
                axis = linear @ axes[bone, :, column]
                out[k] = np.sign(np.linalg.det(linear)) * axis / np.linalg.norm(axis), origins[bone]
        return out

    def _direction(self, posed, turn):
        """The way in which the thumb's pad faces in the world (3)."""
        direction = turn @ self.rig.world_from_rig[:3, :3] @ posed[self.bone, :3, :3] @ self.local
        return direction / np.linalg.norm(direction)

    def _inward(self, posed, points, turn):
        """Cosine between the way the thumb's pad faces and the way to the bar's axis; that way (3), the pad's
        direction (3), and how the cosine changes with the pad's place (3), 1 / mm."""
        if self.local is None or not len(self.pads[0]):
            return 1.0, *np.zeros((3, 3))
        center, axis = self.bar
        direction = self._direction(posed, turn)
        out = points[self.pads[0]].mean(axis=0) - center
        out = out - axis * (out @ axis)
        far = max(float(np.linalg.norm(out)), 1e-9)
        way = -out / far
        cosine = float(direction @ way)
        return cosine, way, direction, -(direction - cosine * way - axis * (axis @ direction)) / far

    def _facing(self, posed, points, turn):
        """Cosine between the way the thumb's pad faces and the way to the index finger's pad; that way (3), the pad's
        direction (3), and how far apart the pads are, mm. A turn or a shift of the hand changes none of the cosine."""
        if self.local is None or not all(len(rows) for rows in self.pads):
            return 1.0, *np.zeros((2, 3)), 1.0
        direction = self._direction(posed, turn)
        way = points[self.pads[1]].mean(axis=0) - points[self.pads[0]].mean(axis=0)
        far = max(float(np.linalg.norm(way)), 1e-9)
        return float(direction @ way) / far, way / far, direction, far

    def _pad_slopes(self, at, turn):
        """How the places of the two pads, thumb and index finger, change with each angle (2, d, 3)."""
        posed, turning, part, dofs = at
        columns = [dof[:2] for dof in dofs]
        out = np.zeros((2, len(dofs), 3))
        slopes = vertex_jacobian(part.subset(np.concatenate(self.pads)), posed, turning, columns)
        for k, own in enumerate(np.split(slopes, [len(self.pads[0])])):
            if len(own):
                out[k] = own.mean(axis=0) @ turn.T
        return out

    def _around(self, posed, motion):
        """Cosine between the thumb's last bone and the way around the bar; that way (3), the bone's direction (3), its
        head (3), and how the cosine changes with the head (3), 1 / mm.

        Around a bar the thumb runs against the fingers.
        """
        if self.bone is None:
            return 1.0, *np.zeros((4, 3))
        (center, axis), (pivot, turn, shift) = self.bar, motion
        head = turn @ (to_world(self.rig, posed[[self.bone], :3, 3])[0] - pivot) + pivot + shift
        around = self.joints.side * cross(head - center, axis)
        far = max(np.linalg.norm(around), 1e-9)
        around = around / far
        direction = turn @ self.rig.world_from_rig[:3, :3] @ posed[self.bone, :3, :3]
        direction = direction @ self.rig.axes[self.bone, :, TWIST]
        direction = direction / np.linalg.norm(direction)
        cosine = float(direction @ around)
        by_head = self.joints.side * cross(axis, direction - cosine * around) / far
        return cosine, around, direction, head, by_head


def cosine_of(hand, points, normals):
    """Cosine between the way in which the thumb's pad faces and the way to the index finger's pad, from `points` and
    `normals` (n, 3) of the posed hand's vertices; 1 for a hand without one of the two pads."""
    everywhere = [pad.rows for pad in hand.pads]
    thumb, index = (_rows_of(hand.pads, everywhere, f"{digit}_distal", None) for digit in ("thumb", "index"))
    if not len(thumb) or not len(index):
        return 1.0
    way, facing = points[index].mean(axis=0) - points[thumb].mean(axis=0), normals[thumb].sum(axis=0)
    return float(facing @ way / max(np.linalg.norm(facing) * np.linalg.norm(way), 1e-12))


def _rows_of(pads, groups, role, most=LOOKED_AT):
    """Places of the vertices of the last pad of a digit, at most `most`, evenly taken; empty where there is none."""
    found = [rows for pad, rows in zip(pads, groups, strict=False) if pad.role == role and pad.kind == "distal"]
    rows = np.concatenate(found) if found else np.zeros(0, int)
    return rows if most is None else rows[:: max(len(rows) // most, 1)]


def _facing_of(hand, bone):
    """The way in which the thumb's last pad faces, in the space of its bone (3): the mean of its normals at rest, or
    the palm side of the bone where the rig has none."""
    rig = hand.rig
    rows = _rows_of(hand.pads, [pad.rows for pad in hand.pads], "thumb_distal", None)
    if rig.normals is None or not len(rows):
        return rig.rest[bone, :3, :3].T @ pads_of_hand.palmar(rig, hand.joints, "thumb_distal")
    facing = rig.normals[rows].mean(axis=0)
    return rig.rest[bone, :3, :3].T @ (facing / np.linalg.norm(facing))
