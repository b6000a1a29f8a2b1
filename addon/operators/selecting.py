"""Selects a place of the hand for the user to see: its vertices in Edit Mode, and the view turned to it."""

import bpy
from mathutils import Vector

from ..scene import regions
from . import running

_CLEAR = 1e-3
"""How far before the skin a ray to the eye begins, as a share of the way: the skin itself is no cover."""


def select(context, hand, vertices):
    """Select `vertices` of the hand, and nothing else, in Edit Mode; in a window the view turns to them."""
    vertices = [int(vertex) for vertex in vertices]
    to_object_mode(context)
    for other in context.selected_objects:
        other.select_set(False)
    hand.hide_set(False)
    hand.select_set(True)
    context.view_layer.objects.active = hand
    look_at(context, hand, vertices)
    regions.select_only(hand.data, vertices)
    context.tool_settings.mesh_select_mode = (True, False, False)
    bpy.ops.object.mode_set(mode="EDIT")
    running.redraw(context)


def to_object_mode(context):
    """Leave Edit Mode, in which attributes and vertex groups cannot be read."""
    if context.object is not None and context.object.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")


def in_object_mode(context, steps):
    """The same computation in Object Mode; the mode that the user was in comes back however it ends."""
    active = context.object
    mode = "OBJECT" if active is None else active.mode
    to_object_mode(context)
    try:
        return (yield from steps)
    finally:
        if active is not None and context.object == active and active.mode != mode:
            bpy.ops.object.mode_set(mode=mode)


def look_at(context, hand, vertices):
    """Turn the 3D view in which the user clicked so that the middle of `vertices` faces the eye."""
    if context.area is None or context.area.type != "VIEW_3D" or not vertices:
        return
    found = [hand.data.vertices[vertex] for vertex in vertices]  # Edit Mode shows the mesh at rest
    middle = sum((vertex.co for vertex in found), Vector()) / len(found)
    normal = sum((vertex.normal for vertex in found), Vector())
    space, matrix = context.space_data, hand.matrix_world
    view, place = space.region_3d, matrix @ middle
    if view.view_perspective == "CAMERA":
        view.view_perspective = "PERSP"
    view.view_location = place
    view.view_distance = min(view.view_distance, max(hand.dimensions))
    facing = (matrix.to_3x3().inverted_safe().transposed() @ normal).normalized()
    if facing.length == 0.0:
        return
    view.view_rotation = facing.to_track_quat("Z", "Y")
    if _is_covered(context, place, facing * view.view_distance):
        space.shading.show_xray = True


def _is_covered(context, place, to_eye):
    """Whether something stands between the place and the eye: where a hand is pressed, the product does."""
    start = place + _CLEAR * to_eye
    return context.scene.ray_cast(
        context.evaluated_depsgraph_get(), start, to_eye.normalized(), distance=to_eye.length
    )[0]
