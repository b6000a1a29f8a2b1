"""What tests of edited hands read from a scene, by ways of their own."""

import bpy
import numpy as np


def rest_mm(hand):
    """Positions (n, 3) of the mesh itself, mm, in a scene of metres."""
    flat = np.empty(3 * len(hand.data.vertices), np.float32)
    hand.data.vertices.foreach_get("co", flat)
    return 1000.0 * flat.reshape(-1, 3).astype(np.float64)


def shown_mm(hand):
    """Evaluated positions (n, 3) in the world, mm."""
    bpy.context.view_layer.update()
    mesh = hand.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    return np.array([1000.0 * (hand.matrix_world @ vertex.co) for vertex in mesh.vertices])


def bends_deg(rig):
    """(bone, its parent) -> angle between them in the pose about the bone's own X, degrees."""
    bpy.context.view_layer.update()
    out = {}
    for bone in rig.pose.bones:
        if bone.parent is not None:
            axis, along, before = (np.array(way) for way in (bone.x_axis, bone.y_axis, bone.parent.y_axis))
            before = before - axis * (before @ axis)
            out[bone.name, bone.parent.name] = np.degrees(np.arctan2(axis @ np.cross(before, along), before @ along))
    return out


def weights_of(hand, name):
    """Weights (n,) of a vertex group."""
    index = hand.vertex_groups[name].index
    return np.array([sum(g.weight for g in vertex.groups if g.group == index) for vertex in hand.data.vertices])


def values_of(hand, name):
    """Values of a float attribute."""
    return np.array([value.value for value in hand.data.attributes[name].data])


def fingertip(hand, rig, name):
    """Which vertices (n,) lie within 12 mm of the end of a bone at rest."""
    return np.linalg.norm(rest_mm(hand) - 1000.0 * np.array(rig.data.bones[name].tail_local), axis=1) < 12.0
