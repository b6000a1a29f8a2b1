"""Where a fit begins: the product laid into the palm and the fingers closed until they touch.

Knows nothing of Blender. World mm, radians.
"""

from dataclasses import dataclass

import numpy as np

from ..hand import capsules as capsules_of_hand
from ..hand import pads as pads_of_hand
from ..hand.poses import POSES
from ..hand.skinning import pose_matrices, skin, skin_normals, to_world
from ..hand_bones.roles import COLUMNS, FINGERS, WRIST, along, angle_bounds, flexion_axis, from_anatomical, pose_angles

STEP_DEG = 4.0
"""A closing joint turns in steps of this many degrees; the fit that follows does the rest."""

CLEAR_MM = 200.0
"""The product starts this far in front of the palm."""


def hand_frame(rig, joints):
    """World frame of the palm at rest: `(center, radial, distal, palmar)`, the center at the knuckles.

    Needs two fingers; with one, its flexion axis stands for the line of the knuckles.
    """
    present = [f for f in FINGERS if f"{f}_proximal" in joints.bones]
    bones = [joints.bones[f"{f}_proximal"] for f in present]
    heads = to_world(rig, rig.rest[bones, :3, 3])
    linear = rig.world_from_rig[:3, :3]
    forward = linear @ np.mean([along(rig, bone) for bone in bones], axis=0)
    facing = linear @ np.mean([pads_of_hand.palmar(rig, joints, f"{f}_proximal") for f in present], axis=0)
    radial = heads[0] - heads[-1] if len(bones) > 1 else joints.side * (linear @ flexion_axis(rig, bones[0]))
    if WRIST in joints.bones:
        forward = heads.mean(axis=0) - to_world(rig, rig.rest[[joints.bones[WRIST]], :3, 3])[0]
    facing = facing / np.linalg.norm(facing)
    radial = radial - facing * (radial @ facing)
    radial /= np.linalg.norm(radial)
    distal = np.cross(facing, radial)
    distal *= np.sign(distal @ forward) or 1.0
    return heads.mean(axis=0), radial, distal, facing


def product_axis(vertices):
    """Center (3) and long axis (3) of a product from the spread of its vertices, world mm."""
    center = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    _, axes = np.linalg.eigh(np.cov((vertices - vertices.mean(axis=0)).T))
    return center, axes[:, 2]


@dataclass(frozen=True)
class Placing:
    """How a product shall lie in the palm: its `axis` through `center` (3), turned `oblique` radians against the line
    of the knuckles, `offset_mm` from them along the fingers. `toward` (3): where the palm faces; None: as it stands,
    and the axis may be turned end for end."""

    center: np.ndarray
    axis: np.ndarray
    oblique: float
    offset_mm: float
    toward: np.ndarray | None = None


def lay_into_palm(rig, joints, pads, gauge, placing):
    """World transform (4, 4) that carries the hand to the product so that the product lies in the open palm.

    The product's axis lies across the palm, turned obliquely, as a handle lies from the index finger's base to the
    heel of the hand.
    """
    knuckles, radial, distal, facing = hand_frame(rig, joints)
    across = np.cos(placing.oblique) * radial + np.sin(placing.oblique) * distal
    hand = np.stack([across, np.cross(facing, across), facing], axis=1)
    axis, toward = placing.axis, placing.toward
    if toward is None:
        axis, toward = _as_it_stands(placing, (knuckles, facing), across)
    goal = np.stack([axis, np.cross(toward, axis), toward], axis=1)
    turn = goal @ hand.T
    place = np.eye(4)
    place[:3, :3] = turn
    away = turn @ (knuckles + distal * placing.offset_mm) + turn @ facing * CLEAR_MM
    place[:3, 3] = placing.center - away
    rows = np.concatenate([pad.rows for pad in pads if pad.kind == "palm"] or [pad.rows for pad in pads])
    part, posed = rig.subset(rows), pose_matrices(rig, pose_angles(rig, joints, POSES["palm_press"]))
    normals = skin_normals(part, posed) if gauge.is_thin else None
    return approach((skin(part, posed), normals), gauge, place, turn @ facing)


def _as_it_stands(placing, palm, across):
    """The axis, its end toward the thumb's side as it is now, and the direction across it that the palm faces now."""
    knuckles, facing = palm
    axis = -placing.axis if placing.axis @ across < 0.0 else placing.axis
    helper = placing.center - (knuckles + facing * CLEAR_MM)
    helper = helper - axis * (helper @ axis)
    if np.linalg.norm(helper) < 1.0:
        helper = np.cross(axis, [0.3, 0.5, 0.8])
    toward = facing - axis * (facing @ axis)
    toward = toward if np.linalg.norm(toward) > 0.3 else helper
    return axis, toward / np.linalg.norm(toward)


def approach(palm, gauge, place, direction, depth_mm=2.0):
    """`place` moved along `direction` until the deepest point of `palm` is `depth_mm` deep; sphere tracing.

    `palm`: points (n, 3) and the skin's normals at them, None if the product has no thin walls.
    """
    points, normals = palm
    for _ in range(60):
        turned = None if normals is None else normals @ place[:3, :3].T
        gap = gauge.gaps(points @ place[:3, :3].T + place[:3, 3], turned).min() + depth_mm
        place = place.copy()
        place[:3, 3] += direction * gap
        if abs(gap) < 0.05:
            break
    return place


OPENINGS = 5
"""Angles tried per joint to free a finger from a wall."""


def clear_fingers(rig, joints, bodies, gauge, angles):
    """Angles (b, 3) in which no finger stands in a thin wall; those that do are opened at the base, a little.

    In a thick product a finger that stands too deep is pushed out by its depth; a thin one has no such depth.
    `bodies`: `capsules.Capsules`.
    """
    for digit in (*FINGERS, "thumb"):
        base = joints.bone("thumb_metacarpal" if digit == "thumb" else f"{digit}_proximal")
        own = np.isin(bodies.bones, [bone for role, bone in joints.bones.items() if role.startswith(f"{digit}_")])
        if base is not None and own.any():
            angles = _cleared(
                rig, joints, (digit, base, np.repeat(own, capsules_of_hand.STEPS)), (bodies, gauge), angles
            )
    return angles


def _cleared(rig, joints, finger, around, angles):
    digit, base, own = finger
    bodies, gauge = around

    def is_crossed(trial):
        return gauge.is_crossed(capsules_of_hand.center_points(bodies, rig, pose_matrices(rig, trial))[own])

    if not is_crossed(angles):
        return angles
    role = "thumb_metacarpal" if digit == "thumb" else f"{digit}_proximal"
    columns = [COLUMNS["flexion"], COLUMNS["abduction"]]
    bounds = [angle_bounds(joints, role, angle) for angle in ("flexion", "abduction")]
    tries = np.stack(np.meshgrid(*[np.linspace(*bound, OPENINGS) for bound in bounds]), axis=-1).reshape(-1, 2)
    far = np.abs(tries - angles[base, columns]).sum(axis=1)
    for values in tries[np.argsort(far, kind="stable")]:
        trial = angles.copy()
        trial[base, columns] = values
        if not is_crossed(trial):
            return trial
    return angles


STOP_DEG = 85.0
"""No joint closes further than this."""

NEAR_MM = 6.0
"""A digit that has a pad this near the product is not closed further before the fit."""


def close_fingers(rig, joints, pads, gauge, start):
    """Angles (b, 3): from `start`, each digit bends joint by joint until a pad beyond the joint touches.

    A digit that is near the product already stays as it is: a flat hand on a plate shall not make a fist. `start`:
    angles, and perhaps degrees by role at which a joint stops.
    """
    angles, stops = start[0].copy(), dict(*start[1:])
    for digit in (*FINGERS, "thumb"):
        chain = ["metacarpal", "proximal", "distal"] if digit == "thumb" else ["proximal", "middle", "distal"]
        roles = [f"{digit}_{segment}" for segment in chain if f"{digit}_{segment}" in joints.bones]
        own = [pad for pad in pads if pad.role in roles and pad.kind != "palm"]
        if own:
            angles = _close_digit(rig, joints, (roles, own, stops), gauge, angles)
    return angles


def _close_digit(rig, joints, digit, gauge, angles):
    roles, own, stops = digit
    rows = np.concatenate([pad.rows for pad in own])
    level = np.concatenate([np.full(len(pad.rows), roles.index(pad.role)) for pad in own])
    part = rig.subset(rows)
    free = 0
    gap = _gaps(part, gauge, angles)
    if gap.min() < NEAR_MM and np.median(gap) < 3.0 * NEAR_MM:
        return angles
    for _ in range(60):
        gap = _gaps(part, gauge, angles)
        touched = level[gap < -0.5]
        free = max(free, int(touched.max()) + 1 if len(touched) else 0)
        moved = False
        for role in roles[free:]:
            moved |= _bend(joints, role, angles, stops.get(role, STOP_DEG))
        if not moved:
            break
    return angles


def _gaps(part, gauge, angles):
    posed = pose_matrices(part, angles)
    return gauge.gaps(skin(part, posed), skin_normals(part, posed) if gauge.is_thin else None)


def _bend(joints, role, angles, stop_deg):
    """Bends `role` by a step in place, slower where the joint bends less; whether it had room."""
    bone, column = joints.bones[role], COLUMNS["flexion"]
    low, high = angle_bounds(joints, role, "flexion")
    share = 0.6 if role.endswith("distal") else 1.0
    stop = min(high, float(from_anatomical(joints, role, "flexion", stop_deg)))
    if role == "thumb_metacarpal":
        stop, share = min(high, np.radians(25.0)), 0.6
    before = angles[bone, column]
    angles[bone, column] = max(before, min(before + share * np.radians(STEP_DEG), stop))
    return angles[bone, column] > before + 1e-9
