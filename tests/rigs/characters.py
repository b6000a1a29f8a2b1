"""Characters: the made hand on a standing body with arms, as one mesh and one armature; and a handle to grasp."""

import bpy
import numpy as np
from mathutils import Matrix, Vector
from thenar_blender.grasp import fitting
from thenar_blender.grasp_fit import fitter
from thenar_blender.hand import build, pads, products
from thenar_blender.hand_look import studio
from thenar_blender.product_objects.parts import product_parts

HEIGHT, SHOULDER, ELBOW = 1.75, (-0.02, -0.62, 0.0), (0.0, -0.3, 0.0)
"""Metres; places in the hand's space, whose fingers point to +Y and whose wrist is at the origin. The arm's length is
that of a man of 1.75 m (Drillis & Contini 1966)."""


def box(name, low, high):
    """A box between two corners, metres."""
    mesh = bpy.data.meshes.new(name)
    ends = np.array([low, high], dtype=float)
    places = [tuple(ends[k, axis] for axis, k in enumerate(which)) for which in np.ndindex(2, 2, 2)]
    mesh.from_pydata(places, [], [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def add_body(rig):
    """A spine and an upper arm above the made hand's forearm."""
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bones, parent = rig.data.edit_bones, None
    for name, head, tail in (("spine", (-0.02, -0.8, -0.6), SHOULDER), ("upper_arm", SHOULDER, ELBOW)):
        bone = bones.new(name)
        bone.head, bone.tail, bone.parent = Vector(head), Vector(tail), parent
        parent = bone
    bones["forearm"].parent = parent
    bpy.ops.object.mode_set(mode="OBJECT")


def skin_of(name, group, low, high):
    """A box whose vertices are all of one bone."""
    obj = box(name, low, high)
    obj.vertex_groups.new(name=group).add(range(8), 1.0, "REPLACE")
    return obj


def character(made, has_body=True):
    """`(mesh, rig)`: the made hand with a forearm, and with `has_body` on a body of 1.75 m; it is the scene's hand."""
    hand, rig = build.add_hand(bpy.context, made)
    if has_body:
        add_body(rig)
    more = [skin_of("Forearm", "forearm", (-0.03, -0.3, -0.03), (0.03, -0.05, 0.03))]
    if has_body:
        more.append(skin_of("Upper", "upper_arm", (-0.05, -0.62, -0.05), (0.05, -0.32, 0.05)))
        more.append(skin_of("Trunk", "spine", (-0.2, -1.1, -1.4), (0.2, -0.62, HEIGHT - 1.4)))
    with bpy.context.temp_override(active_object=hand, selected_editable_objects=[hand, *more]):
        bpy.ops.object.join()
    rig.matrix_world = Matrix.Translation((0.3, -0.2, 1.4)) @ Matrix.Rotation(0.6, 4, "Z")
    bpy.context.scene.thenar.hand = hand
    bpy.context.view_layer.update()
    return hand, rig


def handle(name="Handle", at=(1.0, 0.5, 0.2)):
    """A turned cylinder away from the hand, the scene's product."""
    material = studio.plain("Any", (0.5, 0.5, 0.5, 1.0), 0.5)
    product = studio.add_mesh(bpy.context, name, products.cylinder(44.0), material)
    product.matrix_world = Matrix.Translation(at) @ Matrix.Rotation(0.4, 4, "X")
    bpy.context.scene.thenar.product = product
    bpy.context.view_layer.update()
    return product


def world_of(obj):
    return np.array(obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world, dtype=np.float64)


def skin_mm(obj):
    """World positions (n, 3) of the evaluated mesh, mm."""
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    flat = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.attributes["position"].data.foreach_get("vector", flat)
    world = world_of(obj)
    return 1000.0 * (flat.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3])


def grasp(hand, moves="AUTO", digits=None):
    """A single light fit of hand and product of the scene, written by `moves`. Returns the fit and the grasp."""
    context = bpy.context
    context.view_layer.update()
    parts = product_parts(context.scene.thenar)
    fit = fitting.prepare(context, hand, parts, fitter.Wish(pads.LIGHT_MM, digits))
    found = fitting.compute(fit)
    fitting.finish(context, fit, found, moves)
    return fit, found
