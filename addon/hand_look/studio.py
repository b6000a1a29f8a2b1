"""The stage of a sample: camera, key light at 35 degrees, soft fill, backdrop, and materials of products."""

import math

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ..scene.units import mm_per_unit
from .shader import Tree

LOOK_MM = 420.0
"""Distance of the lights from what they light; a hand is about 190 mm long."""


def add_mesh(context, name, shape, material):
    """A mesh object from `(vertices mm, faces)` with a material; smooth, linked to the scene."""
    vertices, faces = shape
    unit = 1.0 / mm_per_unit(context.scene)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata((vertices * unit).tolist(), [], faces)
    forget_selection(mesh)
    mesh.shade_smooth()
    mesh.materials.append(material)
    obj = bpy.data.objects.new(name, mesh)
    context.scene.collection.objects.link(obj)
    return obj


def forget_selection(mesh):
    """Select nothing: Blender leaves the edges it finds selected by chance, and files shall hold the same each time."""
    for name in (".select_vert", ".select_edge", ".select_poly"):
        if name in mesh.attributes:
            mesh.attributes.remove(mesh.attributes[name])


def set_units(scene):
    """Metres as Blender's unit, shown in millimetres."""
    scene.unit_settings.system = "METRIC"
    scene.unit_settings.scale_length = 1.0
    scene.unit_settings.length_unit = "MILLIMETERS"


def frame(context, target_mm, eye_mm, lens_mm=70.0):
    """Camera at `eye_mm` looking at `target_mm` (world mm)."""
    unit = 1.0 / mm_per_unit(context.scene)
    data = bpy.data.cameras.new("Camera")
    data.lens = lens_mm
    data.clip_start, data.clip_end = 0.01, 20.0
    camera = bpy.data.objects.new("Camera", data)
    camera.matrix_world = aimed(Vector(eye_mm) * unit, Vector(target_mm) * unit)
    context.scene.collection.objects.link(camera)
    context.scene.camera = camera
    return camera


def aimed(eye, target):
    """World matrix of a camera or light at `eye` whose -Z looks at `target`, upright."""
    turn = (target - eye).to_track_quat("-Z", "Y").to_matrix().to_4x4()
    return Matrix.Translation(eye) @ turn


def light(context, camera, target_mm):
    """Key from the camera's left, 35 degrees up; a broad fill from the right; a rim light from behind."""
    unit = 1.0 / mm_per_unit(context.scene)
    target = Vector(target_mm) * unit
    side = camera.matrix_world.to_3x3()
    for name, azimuth, elevation, watts, size_mm, color in (
        ("Key Light", -48.0, 38.0, 3.5, 170.0, (1.0, 0.955, 0.90)),
        ("Fill Light", 55.0, 12.0, 0.7, 500.0, (0.86, 0.93, 1.0)),
        ("Rim Light", 150.0, 40.0, 2.4, 200.0, (1.0, 0.98, 0.95)),
    ):
        data = bpy.data.lights.new(name, "AREA")
        data.energy = watts * (unit * 1000.0) ** 2
        data.size = size_mm * unit
        data.color = color
        obj = bpy.data.objects.new(name, data)
        a, e = math.radians(azimuth), math.radians(elevation)
        away = side @ Vector((math.sin(a) * math.cos(e), 0.0, math.cos(a) * math.cos(e))) + Vector((0, 0, math.sin(e)))
        obj.matrix_world = aimed(target + away.normalized() * LOOK_MM * unit, target)
        context.scene.collection.objects.link(obj)


def backdrop(context, camera, target_mm, floor_mm):
    """A sheet that lies under the scene and curves up behind it, as in a photographer's studio."""
    back = camera.matrix_world.to_3x3() @ Vector((0.0, 0.0, -1.0))
    back = Vector((back.x, back.y, 0.0))
    back = back.normalized() if back.length > 0.1 else Vector((0.0, 1.0, 0.0))
    right = Vector((back.y, -back.x, 0.0))
    profile = [(-1500.0, 0.0), (450.0, 0.0)]
    profile += [
        (450.0 + 400.0 * math.sin(t), 400.0 * (1 - math.cos(t))) for t in (math.pi / 2 * k / 12 for k in range(1, 13))
    ]
    profile += [(850.0, 2200.0)]
    start = Vector((target_mm[0], target_mm[1], floor_mm))
    vertices = []
    for along, up in profile:
        for across in (-2200.0, 2200.0):
            vertices.append(start + back * along + right * across + Vector((0, 0, up)))
    faces = [(2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2) for k in range(len(profile) - 1)]
    return add_mesh(context, "Backdrop", (np.array(vertices), faces), plain("Backdrop", (0.33, 0.345, 0.36, 1), 0.9))


def plain(name, color, roughness, **inputs):
    """A material of one color; further Principled inputs by name, spaces as underscores."""
    tree = Tree(name)
    values = {"Base Color": color, "Roughness": roughness}
    values.update({key.replace("_", " "): value for key, value in inputs.items()})
    material = tree.finish(tree.node("ShaderNodeBsdfPrincipled", values).outputs[0])
    material.diffuse_color = color
    material.roughness = roughness
    return material


def clear(name, tint):
    """Clear acrylic without refraction: what lies behind stays where it is, and few samples suffice."""
    tree = Tree(name)
    through = tree.node("ShaderNodeBsdfTransparent", {"Color": tint}).outputs[0]
    gloss = tree.node("ShaderNodeBsdfGlossy", {"Roughness": 0.04}).outputs[0]
    facing = tree.math("POWER", tree.node("ShaderNodeLayerWeight").outputs["Facing"], 4.0)
    share = tree.math("ADD", 0.03, tree.math("MULTIPLY", facing, 0.5))
    mixed = tree.node("ShaderNodeMixShader", {0: share, 1: through, 2: gloss}).outputs[0]
    material = tree.finish(mixed)
    material.diffuse_color = (*tint[:3], 0.3)
    return material


def fabric(name, color):
    """Woven cloth for the sleeve."""
    tree = Tree(name)
    where = tree.node("ShaderNodeTexCoord").outputs["Object"]
    weave = tree.node("ShaderNodeTexNoise", {"Vector": where, "Scale": 1600.0, "Detail": 1.0}).outputs[0]
    bump = tree.node("ShaderNodeBump", {"Strength": 0.35, "Distance": 0.0006, "Height": weave}).outputs[0]
    surface = tree.node(
        "ShaderNodeBsdfPrincipled",
        {
            "Base Color": color,
            "Roughness": 0.85,
            "Normal": bump,
            "Sheen Weight": 0.25,
        },
    )
    material = tree.finish(surface.outputs[0])
    material.diffuse_color = color
    return material


def render_settings(scene):
    """Cycles on the CPU, few samples, 800 by 600."""
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 32
    scene.cycles.use_denoising = False
    scene.cycles.seed = 1
    scene.render.resolution_x, scene.render.resolution_y = 800, 600
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "AgX"
    world = bpy.data.worlds.new("Thenar Studio")
    scene.world = world
    if world.node_tree is None:
        world.use_nodes = True
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.80, 0.87, 1.0, 1.0)
    background.inputs["Strength"].default_value = 0.10
