"""MANO's 15 joints on the bones of a hand: the joint map, the model's zero pose, and its forward kinematics.

Knows nothing of Blender. MANO (Romero, Tzionas & Black 2017) turns each joint by an axis-angle in the model's own axes
at its zero pose, the flat hand: fingers along -x on a right hand and +x on a left, thumb's side +z, back of the hand
+y. A turn carries along what hangs on the joint. SMPL-X has the same joints and axes.
"""

from dataclasses import dataclass

import numpy as np

from ..hand.skinning import TWIST, local_rotations, pose_matrices, rotation
from ..hand_bones import roles
from ..scene.checks import Refusal

ORDER = tuple(
    f"{digit}_{segment}"
    for digit, segments in (
        *((finger, ("proximal", "middle", "distal")) for finger in ("index", "middle", "little", "ring")),
        ("thumb", ("metacarpal", "proximal", "distal")),
    )
    for segment in segments
)
"""MANO's joints 1 to 15 by the bone that turns there; joint 0 is the wrist."""

ZERO_DEG = {
    "index_proximal": (4, -7),
    "index_middle": (0, 3),
    "middle_proximal": (-10, -3),
    "middle_middle": (-10, 3),
    "little_proximal": (-36, 0),
    "little_middle": (-33, 2),
    "ring_proximal": (-10, -4),
    "ring_middle": (-18, 4),
    "thumb_metacarpal": (50, -2),
    "thumb_proximal": (33, 12),
}
"""Where the segments point in the zero pose: degrees toward the thumb's side, and toward the palm, of the model's
joint places, rounded. A last segment has no joint at its end; it goes on as the one before it."""

KNUCKLES_MM = {
    "index": (-88.1, -5.2, 20.7),
    "middle": (-94.7, -1.5, -3.4),
    "ring": (-81.7, -4.0, -26.7),
    "little": (-68.8, -9.9, -43.2),
}
"""Knuckles of the zero pose from the wrist, mm, in a right model's axes; they say how the model lies in a hand."""


@dataclass(frozen=True)
class Fitted:
    """Basis rotations by bone (f, 3, 3), and what joint limits took off at most: degrees and the bone's name."""

    turns: dict
    lost_deg: float = 0.0
    lost_at: str = ""


def fit(rig, joints, flat, turns, keeps_limits):
    """Basis rotations of the bones of `rig` for axis-angles `turns` (f, 15, 3), rad, of the rig's own side.

    `flat` is the pose (role -> angles) that lays the fingers flat; it says which way round each bone lies in MANO's
    zero pose, and what bones without a joint of MANO's do. Raises `Refusal` where two fingers are not known.
    """
    angles = roles.pose_angles(rig, joints, flat)
    posed = pose_matrices(rig, angles)[:, :3, :3]
    local = (rig.basis[:, :3, :3] @ local_rotations(rig, angles))[None]
    into_rig = _into_rig(rig, joints)
    chains = chain(turns)
    driven = {joints.bone(role): place for place, role in enumerate(ORDER) if joints.bone(role) is not None}
    whole, out, lost = {}, {}, (0.0, "")
    for bone, parent in enumerate(rig.parents):
        before = rig.from_parent[bone, :3, :3] if parent < 0 else whole[parent] @ rig.from_parent[bone, :3, :3]
        if bone not in driven:
            whole[bone] = before @ local[0, bone]
            continue
        place = driven[bone]
        zero = _zero(rig, joints, posed, into_rig, ORDER[place])
        wanted = into_rig @ chains[:, place] @ into_rig.T @ zero
        out[bone] = np.swapaxes(before, -1, -2) @ wanted
        if keeps_limits:
            kept = _within(rig, joints, ORDER[place], out[bone])
            off = np.degrees(np.arccos(np.clip((np.einsum("fij,fij->f", kept, out[bone]) - 1.0) / 2.0, -1.0, 1.0)))
            lost = max(lost, (float(off.max()), rig.names[bone]))
            out[bone] = kept
        whole[bone] = before @ out[bone]
    for bone in joints.bones.values():
        if bone not in out and bone != joints.bones.get(roles.WRIST):
            out[bone] = np.broadcast_to(local[0, bone], (len(turns), 3, 3))
    return Fitted(out, *lost)


def mirrored(turns):
    """The same pose on a hand of the other side: axis-angles mirrored at the plane x = 0."""
    return turns * np.array([1.0, -1.0, -1.0])


def chain(turns):
    """Rotations (f, 15, 3, 3) of the joints from the zero pose, those before them in the digit included."""
    own = _rodrigues(turns.reshape(-1, 3)).reshape(*turns.shape[:2], 3, 3)
    out = own.copy()
    for joint in range(turns.shape[1]):
        if joint % 3:
            out[:, joint] = out[:, joint - 1] @ own[:, joint]
    return out


def _rodrigues(vectors):
    angle = np.linalg.norm(vectors, axis=1)
    x, y, z = (vectors / np.maximum(angle, 1e-12)[:, None]).T
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
    return np.eye(3) + np.sin(angle)[:, None, None] * cross + (1.0 - np.cos(angle))[:, None, None] * (cross @ cross)


def _into_rig(rig, joints):
    """Rotation (3, 3) from MANO's axes, those of the rig's side, to rig space, by wrist and knuckles of the rest."""
    bones = joints.bones
    there = [finger for finger in roles.FINGERS if f"{finger}_proximal" in bones]
    if len(there) < 2:
        raise Refusal("a pose of MANO's needs two fingers to lie by; assign the bones of two fingers under Bones")
    wrist = bones.get(roles.WRIST)
    if wrist is None:
        wrist = bones.get(f"{there[0]}_metacarpal", int(rig.parents[bones[f"{there[0]}_proximal"]]))
    if wrist < 0:
        raise Refusal("a pose of MANO's needs the wrist to lie by; assign the wrist's bone under Bones")
    posed = pose_matrices(rig, np.zeros((len(rig.names), 3)))[:, :3, 3]
    of_rig = _palm(np.array([posed[bones[f"{finger}_proximal"]] - posed[wrist] for finger in there]))
    flip = np.array([1.0 if joints.side > 0.0 else -1.0, 1.0, 1.0])
    of_model = _palm(np.array([KNUCKLES_MM[finger] for finger in there]) * flip)
    return of_rig @ of_model.T


def _palm(knuckles):
    """Axes (3, 3; columns) of a palm: to the middle of its knuckles, across them to the index finger, and out of it."""
    along = knuckles.mean(axis=0)
    along /= np.linalg.norm(along)
    across = knuckles[0] - knuckles[-1]
    across -= along * (along @ across)
    across /= np.linalg.norm(across)
    return np.stack([along, across, np.cross(along, across)], axis=1)


def _zero(rig, joints, posed, into_rig, role):
    """rig_from_bone (3, 3) in MANO's zero pose: the flat bone, laid along the model's segment by the least turn."""
    bone = joints.bone(role)
    flat_turn = posed[bone]
    now = flat_turn @ rig.axes[bone, :, TWIST]
    goal = into_rig @ direction(role, joints.side)
    axis = np.cross(now, goal)
    sine = np.linalg.norm(axis)
    return flat_turn if sine < 1e-9 else rotation(axis / sine, np.arctan2(sine, now @ goal)) @ flat_turn


def direction(role, side):
    """Unit direction of a segment in the zero pose, in MANO's axes; `side` +1 right, -1 left."""
    digit, _, segment = role.partition("_")
    before = {"distal": "proximal" if digit == "thumb" else "middle"}.get(segment, segment)
    aside, down = np.radians(ZERO_DEG[f"{digit}_{before}"])
    return np.array([-side * np.cos(down) * np.cos(aside), -np.sin(down), np.cos(down) * np.sin(aside)])


def _within(rig, joints, role, turns):
    """The turns (f, 3, 3) with their angles kept within the joint's limits; an angle that it has not is 0."""
    bone = joints.bone(role)
    own = rig.axes[bone].T @ turns @ rig.axes[bone]
    angles = np.stack(
        [
            np.arctan2(-own[:, 1, 2], own[:, 2, 2]),
            np.arcsin(np.clip(own[:, 0, 2], -1.0, 1.0)),
            np.arctan2(-own[:, 0, 1], own[:, 0, 0]),
        ],
        axis=1,
    )
    kept = np.zeros_like(angles)
    for angle in roles.limits_of(role):
        column = roles.COLUMNS[angle]
        kept[:, column] = np.clip(angles[:, column], *roles.angle_bounds(joints, role, angle))
    all_bones = np.zeros((len(rig.names), 3))
    out = np.empty_like(turns)
    for frame, row in enumerate(kept):
        all_bones[bone] = row
        out[frame] = local_rotations(rig, all_bones)[bone]
    return out
