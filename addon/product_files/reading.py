"""Brings the surfaces of a file into the scene as the product; nothing else of the file stays."""

from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from ..scene import mesh as meshes
from ..scene import sizes
from ..scene.checks import PRODUCT_TYPES, Refusal
from . import formats, importing


@dataclass(frozen=True)
class Added:
    """What a file gave: the `parts` in the scene, and the `Sizes` of hand and product."""

    parts: list
    sizes: sizes.Sizes


def add_product(context, path):
    """Read a file, and make what it holds the scene's product: one object, or a collection of parts. Returns `Added`.

    Parts are still meshes at the places that the file gives them; cameras, lights, armatures and animation are left
    out. Raises `Refusal`, with file and scene as before, where the file cannot be read or holds no surface.
    """
    path = Path(path)
    found = formats.check(path)
    scene, before = context.scene, importing.everything()
    try:
        with importing.kept(context):
            importing.run(found, path)
            context.view_layer.update()
            made = _surfaces(context, path, before)
            importing.remove_new(before, made)
    except Exception as error:
        importing.remove_new(before, [])
        if isinstance(error, Refusal):
            raise
        raise Refusal(
            f"'{path.name}' could not be read: {importing.reason(error)}; export it again, or as another format"
        ) from None
    parts = [_object(*row) for row in made]
    _link(context, parts, path.stem)
    context.view_layer.update()
    settings = scene.thenar
    settings.accepted_mm = 0.0
    settings.added_mm = sizes.measure(scene, settings.hand, parts).product_mm
    return Added(parts, sizes.measure(scene, settings.hand, parts))


def _surfaces(context, path, before):
    """(name, mesh, world matrix) of every surface that the file put into the scene, as shown. Raises `Refusal`."""
    made = []
    for shown in context.evaluated_depsgraph_get().object_instances:
        owner = shown.parent if shown.is_instance else shown.object
        if owner.original.session_uid in before["objects"] or shown.object.type not in PRODUCT_TYPES:
            continue
        mesh = bpy.data.meshes.new_from_object(shown.object)
        if len(mesh.polygons) == 0:
            continue
        matrix = shown.matrix_world.copy()
        points = meshes.positions(mesh)
        if not (np.isfinite(points).all() and np.isfinite(np.array(matrix)).all()):
            raise Refusal(f"'{path.name}' holds points that are no numbers, in '{owner.name}'; export it again")
        made.append((shown.object.original.name, mesh, matrix))
    if not made:
        raise Refusal(f"'{path.name}' holds no surface; export the product's faces, not its curves or points")
    if len(made) == 1:
        made = [(path.stem, *made[0][1:])]
    return made


def _object(name, mesh, matrix):
    mesh.name = name
    obj = bpy.data.objects.new(name, mesh)
    obj.matrix_world = matrix
    return obj


def _link(context, parts, name):
    """Put the parts into the scene and choose them, instead of the product that was chosen before."""
    settings, home = context.scene.thenar, context.scene.collection
    settings.product = settings.product_collection = None
    if len(parts) > 1:
        home = bpy.data.collections.new(name)
        context.scene.collection.children.link(home)
        settings.product_collection = home
    for part in parts:
        home.objects.link(part)
    if len(parts) == 1:
        settings.product = parts[0]
    for other in context.selected_objects:
        other.select_set(False)
    for part in parts:
        part.select_set(True)
    context.view_layer.objects.active = parts[0]
