"""A hand and its armature read from Blender as a `Rig`, and angles written back to the bones."""

from dataclasses import replace

import bpy
import numpy as np
from mathutils import Matrix

from .. import names
from ..hand.skinning import Rig, descendants, local_rotations
from ..rigs.chains import Skeleton
from ..rigs.recognise import recognise
from ..scene import mesh, units
from ..scene.regions import group_weights
from . import bonemap, constrained, rig_axes, roles
from .rig_axes import RigError


def armature_of(hand):
    """The armature object that deforms `hand`.

    Raises `RigError` if the hand has none.
    """
    for modifier in hand.modifiers:
        if modifier.type == "ARMATURE" and modifier.object is not None and modifier.show_viewport:
            return modifier.object
    raise RigError(f"'{hand.name}' has no armature; add an Armature modifier that names one")


def read_rig(context, hand):
    """`(rig, role_names)` of a hand mesh; rig space is the armature's, world in mm.

    Bones with a role stand at rest in `rig.basis`; all others keep the pose they have now. Where constraints hold the
    fingers, the bones of a digit hang on each other in `rig`, as they move.

    Raises `RigError` or `roles.RoleError` with a sentence for the user.
    """
    armature = armature_of(hand)
    bones = ordered(armature)
    bone_names = tuple(bone.name for bone in bones)
    parents = np.array([bone_names.index(bone.parent.name) if bone.parent else -1 for bone in bones])
    weights = _weights(context, hand, bones)
    rest = np.array([bone.matrix_local for bone in bones], dtype=np.float64)
    stored = bonemap.get_map(armature)
    if not stored:
        stored = _recognised(armature, Skeleton(bone_names, parents, rest[:, :3, 3], weights.sum(axis=0)))
    context.view_layer.update()
    into_rig = np.linalg.inv(np.array(armature.matrix_world)) @ np.array(hand.matrix_world)
    scale = units.mm_per_unit(context.scene)
    vertices = _positions(hand) @ into_rig[:3, :3].T + into_rig[:3, 3]
    world = np.diag([scale, scale, scale, 1.0]) @ np.array(armature.matrix_world, dtype=np.float64)
    basis = np.array([armature.pose.bones[name].matrix_basis for name in bone_names], dtype=np.float64)
    for role, name in stored.items():
        if name in bone_names and role != roles.WRIST:
            basis[bone_names.index(name)] = np.eye(4)
    axes = np.tile(np.eye(3), (len(bones), 1, 1))
    rig = Rig(bone_names, parents, rest, axes, basis, vertices, weights, world)
    digits = constrained.digits_of(armature, stored)
    if constrained.is_constrained(armature, stored):
        rig = constrained.linked(rig, stored)
        rig = replace(rig, basis=constrained.evaluated_basis(armature, rig, digits))
    elif constrained.is_led(armature, stored):
        rig = replace(rig, basis=constrained.evaluated_basis(armature, rig, digits))
    return rig_axes.with_axes(rig, stored, armature.thenar_bones.axis), stored


def skeleton_of(context, hand):
    """The bones of `hand`'s armature as a `chains.Skeleton`, in the armature's space.

    Raises `RigError` if the mesh has no armature or no vertex group of a bone.
    """
    bones = ordered(armature_of(hand))
    bone_names = tuple(bone.name for bone in bones)
    parents = np.array([bone_names.index(bone.parent.name) if bone.parent else -1 for bone in bones])
    heads = np.array([bone.head_local for bone in bones], dtype=np.float64)
    return Skeleton(bone_names, parents, heads, _weights(context, hand, bones).sum(axis=0))


def find_bones(context, hand):
    """The `recognise.Found` hands among the bones of `hand`'s armature, the side asked for chosen.

    Raises `RigError` as `skeleton_of`, and with what was found and what to do if no hand is among them.
    """
    armature = armature_of(hand)
    return _found(armature, skeleton_of(context, hand))


def _found(armature, skeleton):
    side = bonemap.side_of(armature)
    found = recognise(skeleton, side)
    if found.chosen is None and found.hands:
        there = " and ".join(str(hand.side) for hand in found.hands)
        raise RigError(f"no {side} hand among the bones of '{armature.name}', only: {there}; change Side under Bones")
    if found.chosen is None:
        raise RigError(
            f"no hand found among the bones of '{armature.name}': {found.missing()}; under Bones, select the bones of "
            "each digit in Pose Mode and press its name"
        )
    return found


def _recognised(armature, skeleton):
    """Role -> bone name by shape, or by the names alone where no shape of a hand is found."""
    try:
        return _found(armature, skeleton).chosen.roles
    except RigError:
        named = roles.guess(skeleton.names, skeleton.parents, skeleton.skin > 0.0)
        fingers = [f for f in roles.FINGERS if all(f"{f}_{segment}" in named for segment in roles.SEGMENTS[1:])]
        if len(fingers) < 2 or bonemap.side_of(armature):
            raise
        return named


def read_free_rig(context, hand):
    """`read_rig` of a hand whose bones are to be turned; raises `RigError` where they cannot be."""
    rig, stored = read_rig(context, hand)
    _check_joined(rig, stored)
    armature = armature_of(hand)
    if constrained.is_constrained(armature, stored):
        constrained.check_own(armature)
    return rig, stored


def check_unconstrained(armature, stored):
    """Raises `RigError` where a constraint would overrule keys on the fingers."""
    for bone, constraint in constrained.holders(armature, constrained.digits_of(armature, stored)):
        raise RigError(
            f"bone '{bone.name}' is held by its constraint '{constraint.name}'; mute it, or fit the bones it follows"
        )
    if constrained.is_constrained(armature, stored):
        raise RigError(
            f"constraints of the fingers of '{armature.name}' are muted for a grasp only; press Back to the Controls "
            "under Bones, then mute or remove them"
        )


def _check_joined(rig, stored):
    """Raises `RigError` where the next bone of a digit does not hang on the one before it."""
    below = descendants(rig.parents)
    for role, name in stored.items():
        before = roles.before_of(role, stored)
        if before in rig.names and name in rig.names and not below[rig.names.index(before), rig.names.index(name)]:
            raise RigError(
                f"bone '{name}' does not hang on '{before}', so a turn of one leaves the other behind; press "
                "Join Loose Bones under Bones"
            )


def own_limits(armature, rig):
    """(bone, column) -> (low, high), radians, from Limit Rotation constraints where bones flex about their own X."""
    if armature.thenar_bones.axis != "X":
        return {}
    out = {}
    for bone, name in enumerate(rig.names):
        for limit in armature.pose.bones[name].constraints:
            if limit.type != "LIMIT_ROTATION" or limit.owner_space != "LOCAL" or limit.mute:
                continue
            for column, axis in enumerate("xyz"):
                if getattr(limit, f"use_limit_{axis}"):
                    out[bone, column] = (getattr(limit, f"min_{axis}"), getattr(limit, f"max_{axis}"))
    return out


def tails(rig, armature):
    """Rest ends (b, 3) of the bones in rig space: as drawn, or where their segments end."""
    out = np.array([armature.data.bones[name].tail_local for name in rig.names], dtype=np.float64)
    for bone, length in rig_axes.odd_lengths(rig).items():
        out[bone] = rig.rest[bone, :3, 3] + length * roles.along(rig, bone)
    return out


def write_angles(armature, rig, joints, angles):
    """Turn every bone that has a role; its location and scale are reset. Constraints that hold fingers are muted.

    Raises `RigError`, with nothing changed, where such a finger cannot be posed.
    """
    if constrained.is_constrained(armature, _named(rig, joints)):
        constrained.write(armature, rig, joints, angles)
        return
    local = local_rotations(rig, angles)
    for role, bone in joints.bones.items():
        if role == roles.WRIST:
            continue
        matrix = np.eye(4)
        matrix[:3, :3] = local[bone]
        armature.pose.bones[rig.names[bone]].matrix_basis = Matrix(matrix.tolist())


def read_angles(armature, rig, joints):
    """Turns (b, 3) of the bones that have a role, radians, as the armature is posed now."""
    out = np.zeros((len(rig.names), 3))
    if constrained.is_constrained(armature, _named(rig, joints)):
        basis = constrained.evaluated_basis(armature, rig, ())
    else:
        basis = [armature.pose.bones[name].matrix_basis for name in rig.names]
    for bone in joints.bones.values():
        turn = np.array(basis[bone], dtype=np.float64)[:3, :3]
        own = rig.axes[bone].T @ (turn / np.linalg.norm(turn, axis=0)) @ rig.axes[bone]
        twist = np.arcsin(np.clip(own[0, 2], -1.0, 1.0))
        out[bone] = np.arctan2(-own[1, 2], own[2, 2]), twist, np.arctan2(-own[0, 1], own[0, 0])
    return out


def move_object(obj, motion_mm, scale):
    """Carry an object through the world by a (4, 4) motion in mm; `scale` is mm per Blender unit."""
    top = top_of(obj)
    top.matrix_world = Matrix(in_units(motion_mm, scale).tolist()) @ top.matrix_world
    bpy.context.view_layer.update()


def _named(rig, joints):
    return {role: rig.names[bone] for role, bone in joints.bones.items()}


def in_units(motion_mm, scale):
    """A (4, 4) motion in mm as one in Blender units."""
    motion = motion_mm.copy()
    motion[:3, 3] /= scale
    return motion


def top_of(obj):
    """The object at the head of the parents of `obj`."""
    while obj.parent is not None:
        obj = obj.parent
    return obj


def ordered(armature):
    """Bones with parents before children."""
    out = []
    waiting = [bone for bone in armature.data.bones if bone.parent is None]
    while waiting:
        bone = waiting.pop(0)
        out.append(bone)
        waiting.extend(bone.children)
    return out


def _weights(context, hand, bones):
    """Normalised weights (n, b); bones that do not deform weigh nothing."""
    present = [bone.name for bone in bones if bone.use_deform and bone.name in hand.vertex_groups]
    if not present:
        raise RigError(f"no vertex group of '{hand.name}' is named after a bone of its armature")
    read = group_weights(context, hand, present)
    out = np.zeros((len(hand.data.vertices), len(bones)))
    columns = {bone.name: column for column, bone in enumerate(bones)}
    for name, row in zip(present, read, strict=True):
        out[:, columns[name]] = row
    total = out.sum(axis=1, keepdims=True)
    return out / np.where(total > 1e-4, total, 1.0)


def _positions(hand):
    """Local rest positions (n, 3) with the hand's own shape keys, without Thenar's."""
    count = len(hand.data.vertices)
    flat = np.empty(3 * count, np.float32)
    keys = hand.data.shape_keys
    if keys is None:
        return mesh.positions(hand.data).astype(np.float64)
    keys.reference_key.points.foreach_get("co", flat)
    base = flat.reshape(-1, 3).astype(np.float64)
    out = base.copy()
    for key in keys.key_blocks:
        if key == keys.reference_key or key.mute or key.value == 0.0 or key.name == names.SHAPE_KEY:
            continue
        key.points.foreach_get("co", flat)
        out += key.value * (flat.reshape(-1, 3) - base)
    return out
