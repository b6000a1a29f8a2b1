"""The hand as arrays: forward kinematics and linear blend skinning as Blender's Armature modifier does them.

Knows nothing of Blender. All lengths in mm, angles in radians, matrices act on column vectors.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

FLEXION, TWIST, ABDUCTION = 0, 1, 2


@dataclass(frozen=True)
class Rig:
    """A rest hand with its bones, in rig space (the armature object's own space).

    `rest` (b, 4, 4): rig_from_bone at rest, bone along local +Y. `axes` (b, 3, 3): columns are the flexion, twist and
    abduction axes in the bone's local space. `basis` (b, 4, 4): local transform of bones that no pose angle drives.
    `vertices` (n, 3) and `weights` (n, b), rows summing to one or zero. `world_from_rig` (4, 4) ends in world mm.
    `normals` (n, 3): outward at rest, unit; a hand without them cannot be fitted to thin walls.
    """

    names: tuple
    parents: np.ndarray
    rest: np.ndarray
    axes: np.ndarray
    basis: np.ndarray
    vertices: np.ndarray
    weights: np.ndarray
    world_from_rig: np.ndarray
    normals: np.ndarray | None = None

    @cached_property
    def from_parent(self):
        """parent_from_bone (b, 4, 4) at rest; rig_from_bone for bones without a parent."""
        above = np.where((self.parents >= 0)[:, None, None], self.rest[self.parents], np.eye(4))
        return np.linalg.inv(above) @ self.rest

    @cached_property
    def bone_from_rig(self):
        """Inverse of `rest` (b, 4, 4)."""
        return np.linalg.inv(self.rest)

    def subset(self, rows):
        """The same rig with only the vertices `rows`."""
        normals = None if self.normals is None else self.normals[rows]
        return self._with(vertices=self.vertices[rows], weights=self.weights[rows], normals=normals)

    def moved(self, world_from_world):
        """The same rig carried through the world by a (4, 4) transform."""
        return self._with(world_from_rig=world_from_world @ self.world_from_rig)

    def _with(self, **changed):
        """The same bones with other vertices or another place; what was computed of the bones is kept."""
        out = replace(self, **changed)
        for name in ("from_parent", "bone_from_rig"):
            out.__dict__[name] = getattr(self, name)
        return out


def rotation(axis, angle):
    """3 by 3 rotation by `angle` about the unit vector `axis` (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * (cross @ cross)


def rotations(axes, angles):
    """Rotations (k, 3, 3) by `angles` (k,) about unit `axes` (k, 3)."""
    x, y, z = axes.T
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
    sine, cosine = np.sin(angles)[:, None, None], np.cos(angles)[:, None, None]
    return np.eye(3) + sine * cross + (1.0 - cosine) * (cross @ cross)


def cross(first, second):
    """Cross products (..., 3): the bits of `np.cross`, which takes ten times as long for one pair."""
    out = np.empty(np.broadcast_shapes(first.shape, second.shape))
    out[..., 0] = first[..., 1] * second[..., 2] - first[..., 2] * second[..., 1]
    out[..., 1] = first[..., 2] * second[..., 0] - first[..., 0] * second[..., 2]
    out[..., 2] = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
    return out


def axis_rotations(rig, angles):
    """Rotations (3, b, 3, 3) about the flexion, twist and abduction axes by `angles` (b, 3), radians."""
    axes = rig.axes.transpose(2, 0, 1).reshape(-1, 3)
    return rotations(axes, angles.T.ravel()).reshape(3, -1, 3, 3)


def local_rotations(rig, angles):
    """Basis rotations (b, 3, 3): flexion after twist after abduction, the order of Blender's Euler 'ZYX'.

    `angles` (b, 3), radians, columns flexion, twist, abduction.
    """
    parts = axis_rotations(rig, angles)
    return parts[FLEXION] @ parts[TWIST] @ parts[ABDUCTION]


def pose_matrices(rig, angles):
    """rig_from_bone (b, 4, 4) of the posed bones; parents stand before children in `rig`."""
    local = rig.basis.copy()
    local[:, :3, :3] = local[:, :3, :3] @ local_rotations(rig, angles)
    posed = np.empty_like(rig.rest)
    for bone, parent in enumerate(rig.parents):
        own = rig.from_parent[bone] @ local[bone]
        posed[bone] = own if parent < 0 else posed[parent] @ own
    return posed


def deform_matrices(rig, posed):
    """What the Armature modifier applies per bone: posed times inverse rest (b, 4, 4)."""
    return posed @ rig.bone_from_rig


def skin(rig, posed):
    """Skinned vertices (n, 3) in world mm; a vertex without weight stays where it rests.

    Blender divides by the sum of the weights and skips a sum below 1e-4; `rig.weights` comes normalised.
    """
    matrices = deform_matrices(rig, posed)[:, :3, :].reshape(len(posed), 12)
    blended = (rig.weights @ matrices).reshape(-1, 3, 4)
    moved = np.einsum("nij,nj->ni", blended[:, :, :3], rig.vertices) + blended[:, :, 3]
    bare = ~rig.weights.any(axis=1)
    moved[bare] = rig.vertices[bare]
    return to_world(rig, moved)


def skin_normals(rig, posed):
    """Unit outward normals (n, 3) of the skinned vertices in the world: the rest normals turned as their bones turn."""
    matrices = deform_matrices(rig, posed)[:, :3, :3].reshape(len(posed), 9)
    blended = (rig.weights @ matrices).reshape(-1, 3, 3)
    turned = np.einsum("nij,nj->ni", blended, rig.normals)
    bare = ~rig.weights.any(axis=1)
    turned[bare] = rig.normals[bare]
    turned = turned @ rig.world_from_rig[:3, :3].T
    return turned / np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-12)


def to_world(rig, points):
    """Rig-space points (n, 3) in world mm."""
    return points @ rig.world_from_rig[:3, :3].T + rig.world_from_rig[:3, 3]


def joint_axes(rig, posed, angles):
    """Where each angle turns its bone: origins (b, 3) and unit axes (b, 3, 3; columns per angle), in rig space."""
    flexion, twist, abduction = axis_rotations(rig, angles)
    twisted = flexion @ twist
    local = twisted @ abduction
    before = posed[:, :3, :3] @ np.transpose(local, (0, 2, 1))
    axes = np.stack(
        [
            rig.axes[:, :, FLEXION],
            np.einsum("bij,bj->bi", flexion, rig.axes[:, :, TWIST]),
            np.einsum("bij,bj->bi", twisted, rig.axes[:, :, ABDUCTION]),
        ],
        axis=2,
    )
    axes = before @ axes
    return posed[:, :3, 3], axes / np.linalg.norm(axes, axis=1, keepdims=True)


def descendants(parents):
    """Boolean (b, b): entry [i, j] is true where bone j is bone i or hangs below it."""
    below = np.eye(len(parents), dtype=bool)
    for bone, parent in enumerate(parents):
        if parent >= 0:
            below[:, bone] |= below[:, parent]
    return below


def vertex_jacobian(rig, posed, turning, dofs):
    """Derivative of the skinned vertices (n, d, 3; world mm per radian) by the angles `dofs`.

    `turning`: the `joint_axes` of the pose; `dofs`: sequence of (bone, column) pairs, column as in `angles`.
    """
    matrices = deform_matrices(rig, posed)
    origins, axes = turning
    below = descendants(rig.parents)
    per_bone = np.einsum("bij,nj->nbi", matrices[:, :3, :3], rig.vertices) + matrices[None, :, :3, 3]
    carried = rig.weights[:, :, None] * per_bone
    if not dofs:
        return np.zeros((len(rig.vertices), 0, 3))
    arms = {}
    for bone in {bone for bone, _ in dofs}:
        mask = below[bone]
        weight = rig.weights[:, mask].sum(axis=1)
        arms[bone] = carried[:, mask].sum(axis=1) - weight[:, None] * origins[bone]
    around = np.array([axes[bone, :, column] for bone, column in dofs]).reshape(-1, 3)
    out = cross(around, np.stack([arms[bone] for bone, _ in dofs], axis=1))
    return out @ rig.world_from_rig[:3, :3].T
