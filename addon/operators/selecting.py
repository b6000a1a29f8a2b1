"""Selects a place of the hand for the user to see: its vertices in Edit Mode, and the view turned to it."""

import bpy
from mathutils import Vector

from ..scene import mesh, regions
from . import running


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


def look_at(context, hand, vertices):
    """Turn the 3D view in which the user clicked so that the middle of `vertices` faces the eye."""
    if context.area is None or context.area.type != "VIEW_3D" or not vertices:
        return
    with mesh.evaluated_mesh(hand, context.evaluated_depsgraph_get()) as shape:
        found = [shape.vertices[vertex] for vertex in vertices if vertex < len(shape.vertices)]
        middle = sum((vertex.co for vertex in found), Vector()) / max(len(found), 1)
        normal = sum((vertex.normal for vertex in found), Vector())
    view, matrix = context.space_data.region_3d, hand.matrix_world
    if view.view_perspective == "CAMERA":
        view.view_perspective = "PERSP"
    view.view_location = matrix @ middle
    view.view_distance = min(view.view_distance, 1.5 * max(hand.dimensions))
    facing = matrix.to_3x3().inverted_safe().transposed() @ normal
    if facing.length > 0.0:
        view.view_rotation = facing.to_track_quat("Z", "Y")
