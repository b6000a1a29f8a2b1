"""The rest of a made hand's armature laid for another size or side; pose, constraints and bones of the user stay."""

from contextlib import contextmanager

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ..hand import build, model
from . import built as built_of
from . import matching, rings

_MIRROR = Matrix.Diagonal((-1.0, 1.0, 1.0, 1.0))


def lay(context, rig, made, was):
    """Lay the bones of `rig`, made as `was`, as those of the hand `made` of the same side or the other.

    The pose stays in joint angles: a hand's rest angles are the same in every size. Bones that the user added are
    carried by the bone they hang on.
    """
    unit = 1.0 / was.mm_per_unit
    now = built_of.describe(made, was.mm_per_unit, {})
    motions = matching.motions(built_of.frames_mm(was), built_of.frames_mm(now))
    with _edit_mode(context, rig):
        for edit in rig.data.edit_bones:
            motion = None if edit.name in was.bones else _motion(edit, motions)
            if motion is not None:
                edit.head, edit.tail = (Vector(_moved(motion, end, was.mm_per_unit)) for end in (edit.head, edit.tail))
        for bone in made["bones"]:
            build.lay_bone(rig.data.edit_bones[bone["name"]], bone, unit)
    rings.put_on(rig, model.rig_of(made), unit)


def mirror(rig):
    """Mirror pose and joint limits of a rig whose rest has changed sides."""
    for bone in rig.pose.bones:
        bone.matrix_basis = _MIRROR @ bone.matrix_basis @ _MIRROR
        for limit in bone.constraints:
            if limit.type == "LIMIT_ROTATION" and limit.owner_space == "LOCAL":
                limit.min_y, limit.max_y = -limit.max_y, -limit.min_y
                limit.min_z, limit.max_z = -limit.max_z, -limit.min_z


def _motion(edit, motions):
    """Motion of the nearest bone above that was made, or None."""
    above = edit.parent
    while above is not None and above.name not in motions:
        above = above.parent
    return None if above is None else motions[above.name]


def _moved(motion, point, mm_per_unit):
    return (motion @ np.array([*np.array(point) * mm_per_unit, 1.0]))[:3] / mm_per_unit


@contextmanager
def _edit_mode(context, rig):
    """The rig in Edit Mode, and the window as it was afterwards."""
    layer = context.view_layer
    active, is_hidden = layer.objects.active, rig.hide_get()
    mode = "OBJECT" if active is None else active.mode
    if mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    rig.hide_set(False)
    layer.objects.active = rig
    try:
        with context.temp_override(active_object=rig, object=rig, selected_objects=[rig]):
            bpy.ops.object.mode_set(mode="EDIT")
            yield
            bpy.ops.object.mode_set(mode="OBJECT")
    finally:
        rig.hide_set(is_hidden)
        layer.objects.active = active
        if mode != "OBJECT":
            bpy.ops.object.mode_set(mode=mode)
