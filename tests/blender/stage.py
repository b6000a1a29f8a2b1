"""Small scenes and exact readings of them, made without the code under test."""

import bpy
import numpy as np
from mathutils import Euler

MM = 1e-3


def pad(name="Pad", radius=8.0, fineness=4):
    """A soft ball in mm about the origin; its spacing is about 1.1 mm at fineness 4."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=fineness, radius=radius * MM)
    obj = bpy.context.object
    obj.name = obj.data.name = name
    return obj


def plate(name="Plate", top=-6.8, size=30.0, cuts=24):
    """A closed block whose upper face lies at `top` mm."""
    bpy.ops.mesh.primitive_cube_add(size=size * MM, location=(0, 0, (top - size / 2) * MM))
    obj = bpy.context.object
    obj.name = obj.data.name = name
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.subdivide(number_cuts=cuts)
    bpy.ops.object.mode_set(mode="OBJECT")
    return obj


def scene(**options):
    """Ball on plate, chosen as hand and product. Returns both."""
    hand, product = pad(), plate(**options)
    settings = bpy.context.scene.thenar
    settings.hand, settings.product = hand, product
    bpy.context.view_layer.update()
    return hand, product


def evaluated(obj):
    """World positions (n, 3), mm, of the evaluated mesh."""
    bpy.context.view_layer.update()
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    local = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", local)
    matrix = np.array(obj.matrix_world, dtype=np.float64)
    scale = bpy.context.scene.unit_settings.scale_length
    obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh_clear()
    return (local.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]) * scale / MM


def attribute(obj, name):
    """Values of a point attribute."""
    found = obj.data.attributes[name]
    width = {"FLOAT": 1, "INT": 1, "FLOAT_VECTOR": 3, "FLOAT_COLOR": 4}[found.data_type]
    field = {1: "value", 3: "vector", 4: "color"}[width]
    out = np.empty(len(found.data) * width, np.int32 if found.data_type == "INT" else np.float32)
    found.data.foreach_get(field, out)
    return out if width == 1 else out.reshape(-1, width)


def solve():
    """Solve and return the result."""
    assert bpy.ops.thenar.solve() == {"FINISHED"}
    return bpy.context.scene.thenar.result


def raise_under(hand, product, depth=1.2, top=-6.8):
    """Move the product up or down until the hand's lowest point lies `depth` mm below its upper face."""
    lowest = evaluated(hand)[:, 2].min()
    now = evaluated(product)[:, 2].max()
    product.location.z += (lowest + depth - now) * MM / bpy.context.scene.unit_settings.scale_length
    bpy.context.view_layer.update()


def bend(hand, volume=False):
    """Bend the ball by an armature of two bones, about the tip of the first."""
    data = bpy.data.armatures.new("Rig")
    rig = bpy.data.objects.new("Rig", data)
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, start, end in (("root", -0.012, 0.0), ("tip", 0.0, 0.012)):
        bone = data.edit_bones.new(name)
        bone.head, bone.tail = (start, 0, 0.002), (end, 0, 0.002)
    data.edit_bones["tip"].parent = data.edit_bones["root"]
    bpy.ops.object.mode_set(mode="OBJECT")
    points = evaluated(hand)
    weight = np.clip(0.5 + points[:, 0] / 10, 0, 1)
    for name, values in (("root", 1 - weight), ("tip", weight)):
        group = hand.vertex_groups.new(name=name)
        for index, value in enumerate(values):
            group.add([index], float(value), "REPLACE")
    modifier = hand.modifiers.new("Armature", "ARMATURE")
    modifier.object, modifier.use_deform_preserve_volume = rig, volume
    rig.pose.bones["tip"].rotation_mode = "XYZ"
    rig.pose.bones["tip"].rotation_euler = Euler((0.9, 0.4, 0.2))
