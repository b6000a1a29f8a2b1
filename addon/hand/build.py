"""The made hand as Blender objects: mesh `Hand`, armature `Hand Rig`, groups, limits and materials by region."""

import bpy
import numpy as np

from .. import native, steps
from ..hand_bones import roles
from ..hand_bones.bonemap import set_map
from ..hand_look import look, shader, studio
from ..hand_shape import built, rings, skin_look, weights
from ..properties.material_settings import preset_of
from ..scene.checks import Refusal
from ..scene.units import mm_per_unit
from . import model

MESH_NAME = "Hand"
RIG_NAME = "Hand Rig"
ROTATION_ORDER = "ZYX"
"""Blender turns about Z first: abduction, then twist, then flexion about an axis that abduction does not tilt."""

REGION_SUFFIX = " pad"


class BuildError(Refusal):
    """The hand cannot be made; the message is for the user."""


def make(cancel=None, **shape):
    """Arrays of a hand from the native module, and the `shape` asked for; keywords as `thenar.hand`.

    Raises `BuildError` with the module's own sentence if the module is missing or refuses the sizes.
    """
    if native.module is None:
        raise BuildError(native.problem())
    try:
        return {**native.module.hand(**shape, cancel=cancel), "shape": shape}
    except (*native.error_types(), ValueError) as error:
        raise BuildError(str(error)) from error


def making(**shape):
    """`make` as the work of a computation in steps, which any thread may do."""

    def work(cancel, progress):
        if progress is not None:
            progress("making the hand", 0.0)
        return make(cancel=cancel, **shape)

    return work


def add_hand(context, made):
    """Link mesh and armature of the `made` hand to the scene; returns `(hand, rig)` at the world's origin.

    A hand that says of which `shape` it is can be edited later.
    """
    return steps.at_once(adding(context, made))


def adding(context, made):
    """`add_hand` as steps, with pauses in which the window has its turn."""
    unit = 1.0 / mm_per_unit(context.scene)
    rig = _add_armature(context, made, unit)
    yield steps.PAUSE
    hand = yield from _add_mesh(context, made, unit)
    yield steps.PAUSE
    hand.parent = rig
    modifier = hand.modifiers.new("Hand Rig", "ARMATURE")
    modifier.object = rig
    modifier.use_deform_preserve_volume = False
    _set_materials(hand, made, group_names(made))
    arrays = model.rig_of(made)
    set_map(rig, roles.guess(arrays.names, arrays.parents, arrays.weights.any(axis=0)), "X")
    if "shape" in made:
        keep(hand, made, mm_per_unit(context.scene))
    context.view_layer.update()
    return hand, rig


def keep(hand, made, millimetres):
    """Note on the hand how it is made, so that it can be edited; `millimetres` per Blender unit."""
    groups = group_names(made)
    digests = weights.digests(weights.of_made(made, groups), weights.kinds_of(made, groups))
    hand.thenar_hand.keep(built.describe(made, millimetres, digests))


def group_names(made):
    """Vertex group per region: the region's name, told apart from a bone of the same name."""
    bones = {bone["name"] for bone in made["bones"]}
    return [name + REGION_SUFFIX if name in bones else name for name in made["region_names"]]


def _add_mesh(context, made, unit):
    """The steps of the mesh with its groups and its look; returns the object."""
    mesh = bpy.data.meshes.new(MESH_NAME)
    positions = np.asarray(made["vertices_mm"], np.float64) * unit
    triangles = np.asarray(made["triangles"], np.int32)
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", positions.astype(np.float32).ravel())
    mesh.loops.add(triangles.size)
    mesh.loops.foreach_set("vertex_index", triangles.ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", np.arange(0, triangles.size, 3, dtype=np.int32))
    mesh.update(calc_edges=True)
    mesh.shade_smooth()
    mesh.validate()
    studio.forget_selection(mesh)
    hand = bpy.data.objects.new(MESH_NAME, mesh)
    context.scene.collection.objects.link(hand)
    _add_groups(hand, made)
    yield steps.PAUSE
    look.mark_skin(mesh, made)
    yield steps.PAUSE
    mesh.materials.append(shader.skin_material(mm_per_unit(context.scene)))
    skin_look.apply(hand)
    return hand


def _add_groups(hand, made):
    """Bone groups with their weights, then one group per region; a call per distinct weight, not per vertex."""
    weights = np.asarray(made["weights"], np.float64)
    for column, bone in enumerate(made["bones"]):
        group = hand.vertex_groups.new(name=bone["name"])
        shares = np.round(weights[:, column] * 4096.0).astype(int)
        order = np.argsort(shares, kind="stable")
        values, starts = np.unique(shares[order], return_index=True)
        rows, bounds = order.tolist(), [*starts.tolist(), len(order)]
        for k, value in enumerate(values.tolist()):
            if value > 0:
                group.add(rows[bounds[k] : bounds[k + 1]], value / 4096.0, "REPLACE")
    regions = np.asarray(made["regions"])
    for region, name in enumerate(group_names(made)):
        group = hand.vertex_groups.new(name=name)
        group.add(np.flatnonzero(regions == region).tolist(), 1.0, "REPLACE")


def _add_armature(context, made, unit):
    data = bpy.data.armatures.new(RIG_NAME)
    rig = bpy.data.objects.new(RIG_NAME, data)
    context.scene.collection.objects.link(rig)
    data.display_type = "WIRE"
    with context.temp_override(active_object=rig, object=rig, selected_objects=[rig]):
        context.view_layer.objects.active = rig
        bpy.ops.object.mode_set(mode="EDIT")
        for bone in made["bones"]:
            _add_bone(data, bone, unit)
        bpy.ops.object.mode_set(mode="OBJECT")
    arrays = model.rig_of(made)
    joints = model.joints_of(made, arrays)
    for role, index in joints.bones.items():
        _limit(rig.pose.bones[arrays.names[index]], joints, role)
    for pose_bone in rig.pose.bones:
        pose_bone.rotation_mode = ROTATION_ORDER
        pose_bone.lock_location = (True, True, True)
        pose_bone.lock_scale = (True, True, True)
    rings.put_on(rig, arrays, unit)
    return rig


def _add_bone(data, bone, unit):
    edit = data.edit_bones.new(bone["name"])
    lay_bone(edit, bone, unit)
    if bone["parent"]:
        edit.parent = data.edit_bones[bone["parent"]]


def lay_bone(edit, bone, unit):
    """Put an edit bone where the made hand's bone rests; `unit`: Blender units per mm."""
    edit.head = [value * unit for value in bone["head_mm"]]
    edit.tail = [value * unit for value in bone["tail_mm"]]
    edit.align_roll([float(value) for value in model.bone_frame(bone)[:3, 2]])


def _limit(pose_bone, joints, role):
    """A Limit Rotation constraint with the joint's limits; angles that a joint does not have are held at zero."""
    limit = pose_bone.constraints.new("LIMIT_ROTATION")
    limit.name = "Joint limits"
    limit.owner_space = "LOCAL"
    limit.use_transform_limit = True
    if role == roles.WRIST:
        limit.mute = True
        return
    for angle, axis in (("flexion", "x"), ("twist", "y"), ("abduction", "z")):
        low, high = (0.0, 0.0)
        if angle in roles.limits_of(role):
            low, high = roles.angle_bounds(joints, role, angle)
        setattr(limit, f"use_limit_{axis}", True)
        setattr(limit, f"min_{axis}", low)
        setattr(limit, f"max_{axis}", high)


def _set_materials(hand, made, groups):
    """Tissue by region: published layer values by kind of skin, thickness from the made hand."""
    settings = getattr(hand, "thenar", None)
    if settings is None or not hasattr(settings, "materials"):
        return
    for name, thickness in zip(groups, made["thickness_mm"], strict=True):
        material = settings.materials.add()
        material.name = name
        material.preset = preset_of(name)
        material.thickness_mm = float(thickness)
