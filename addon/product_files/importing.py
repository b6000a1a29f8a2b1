"""Blender's importers of a file: run with the scene's settings kept, and what they made removed again."""

from contextlib import contextmanager

import bpy

from .. import languages
from ..scene.checks import Refusal

_OF_THE_WINDOW = {"window_managers", "workspaces", "screens"}
_KEPT_WITH_MATERIALS = {"materials", "images", "node_groups", "textures"}


def run(found, path, **more):
    """Run Blender's importer of that format, with `more` options that it may know.

    Raises `Refusal` where Blender has none, RuntimeError where it fails."""
    for area, name in found.importers:
        if name not in dir(getattr(bpy.ops, area)):
            continue
        operator = getattr(getattr(bpy.ops, area), name)
        known = operator.get_rna_type().properties
        options = {key: value for key, value in {**found.options, **more}.items() if key in known}
        if "FINISHED" not in operator(filepath=str(path), **options):
            raise RuntimeError("Blender's importer gave up")
        return
    raise Refusal(f"this Blender has no importer for {found.title}; enable it in Preferences > Add-ons")


@contextmanager
def kept(context):
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


def everything():
    """Every data-block of the file: {name of its list: session numbers}."""
    return {name: {block.session_uid for block in blocks} for name, blocks in _lists()}


def remove_new(before, made):
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
        if isinstance(blocks, bpy.types.bpy_prop_collection) and name not in _OF_THE_WINDOW:
            yield name, blocks


def reason(error):
    """The last line of what an importer reported, without a full stop."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    marks = languages.error_marks()
    said = [languages.reported(line) for line in lines if line.startswith(marks) and "Traceback" not in line]
    text = (said or lines or [type(error).__name__])[-1 if not said else 0]
    return text.rstrip(".;") or type(error).__name__
