"""Brings the surfaces of a file into the scene as the product; nothing else of the file stays."""

from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from ..scene import mesh as meshes
from ..scene import sizes
from ..scene.checks import PRODUCT_TYPES, Refusal
from . import formats

_OF_THE_WINDOW = {"window_managers", "workspaces", "screens"}
_KEPT_WITH_MATERIALS = {"materials", "images", "node_groups", "textures"}


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
    scene, before = context.scene, _everything()
    try:
        with _kept(context):
            _import(found, path)
            context.view_layer.update()
            made = _surfaces(context, path, before)
            _remove_new(before, made)
    except Exception as error:
        _remove_new(before, [])
        if isinstance(error, Refusal):
            raise
        raise Refusal(
            f"'{path.name}' could not be read: {_reason(error)}; export it again, or as another format"
        ) from None
    parts = [_object(*row) for row in made]
    _link(context, parts, path.stem)
    context.view_layer.update()
    settings = scene.thenar
    settings.accepted_mm = 0.0
    settings.added_mm = sizes.measure(scene, settings.hand, parts).product_mm
    return Added(parts, sizes.measure(scene, settings.hand, parts))


def _import(found, path):
    """Run Blender's importer of that format. Raises `Refusal` where Blender has none, RuntimeError where it fails."""
    for area, name in found.importers:
        if name not in dir(getattr(bpy.ops, area)):
            continue
        operator = getattr(getattr(bpy.ops, area), name)
        known = operator.get_rna_type().properties
        options = {key: value for key, value in found.options.items() if key in known}
        if "FINISHED" not in operator(filepath=str(path), **options):
            raise RuntimeError("Blender's importer gave up")
        return
    raise Refusal(f"this Blender has no importer for {found.title}; enable it in Preferences > Add-ons")


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


@contextmanager
def _kept(context):
    """Selection, camera, world, frames and rate of the scene as before: importers set them."""
    scene, layer = context.scene, context.view_layer
    names = ("camera", "world", "frame_start", "frame_end")
    values = [getattr(scene, name) for name in names]
    rate = scene.render.fps, scene.render.fps_base
    now, active, selected = scene.frame_current, layer.objects.active, list(context.selected_objects)
    try:
        yield
    finally:
        for name, value in zip(names, values, strict=True):
            setattr(scene, name, value)
        scene.render.fps, scene.render.fps_base = rate
        if scene.frame_current != now:
            scene.frame_set(now)
        for obj in list(context.selected_objects):
            obj.select_set(obj in selected)
        for obj in selected:
            obj.select_set(True)
        layer.objects.active = active


def _everything():
    """Every data-block of the file: {name of its list: session numbers}."""
    return {name: {block.session_uid for block in blocks} for name, blocks in _lists()}


def _remove_new(before, made):
    """Remove every data-block that is not in `before`, but for the meshes of `made` and what their materials need."""
    wanted = {mesh.session_uid for _, mesh, _ in made}
    used = {slot.session_uid for _, mesh, _ in made for slot in mesh.materials if slot is not None}
    gone = []
    for name, blocks in _lists():
        for block in blocks:
            number = block.session_uid
            if number in before[name] or number in wanted:
                continue
            if used and name in _KEPT_WITH_MATERIALS and (name != "materials" or number in used):
                continue
            gone.append(block)
    bpy.data.batch_remove(gone)


def _lists():
    for name in dir(bpy.data):
        blocks = getattr(bpy.data, name)
        if isinstance(blocks, bpy.types.bpy_prop_collection) and name not in {
            "window_managers",
            "workspaces",
            "screens",
        }:
            yield name, blocks


def _reason(error):
    """The last line of what an importer reported, without a full stop."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    said = [line.removeprefix("Error: ") for line in lines if line.startswith("Error: ") and "Traceback" not in line]
    text = (said or lines or [type(error).__name__])[-1 if not said else 0]
    return text.rstrip(".;") or type(error).__name__
