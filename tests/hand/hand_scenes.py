"""What the tests of the hand read from scenes and products."""

import bpy
import numpy as np
from thenar_blender.grasp import fitting
from thenar_blender.grasp_fit import fitter
from thenar_blender.hand import pads, products
from thenar_blender.hand_look import studio


def evaluated_mm(obj):
    """World positions (n, 3) of an object's evaluated mesh, mm, at scene scale `1 unit = 1 m` unless scaled."""
    context = bpy.context
    context.view_layer.update()
    mesh = obj.evaluated_get(context.evaluated_depsgraph_get()).data
    flat = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.attributes["position"].data.foreach_get("vector", flat)
    world = np.array(obj.matrix_world, dtype=np.float64)
    return (flat.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3]) * 1000.0 * context.scene.unit_settings.scale_length


def triangles_of(faces):
    """Faces of three or four corners as triangles (m, 3) int32."""
    out = []
    for face in faces:
        out += [face[:3]] if len(face) == 3 else [face[:3], [face[0], face[2], face[3]]]
    return np.array(out, np.int32)


def with_cylinder(context, hand, diameter=60.0, **wish):
    """A cylinder in the scene and the grasp fitted to it."""
    material = studio.plain("Any", (0.5, 0.5, 0.5, 1.0), 0.5)
    product = studio.add_mesh(context, "Product", products.cylinder(diameter), material)
    context.scene.thenar.product = product
    context.view_layer.update()
    return product, fitting.prepare(context, hand, [product], fitter.Wish(pads.LIGHT_MM, **wish))
