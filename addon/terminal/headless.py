"""What every run without a window does: open and save a file whole, choose hand and product, solve."""

import json
import os
from pathlib import Path

import bpy

from .. import workflow
from ..results import export
from ..results import result as results
from ..scene.checks import Refusal


def open_file(path):
    """Open a .blend file. Raises `Refusal` where it is missing or unreadable."""
    if not Path(path).is_file():
        raise Refusal(f"there is no file '{path}'")
    try:
        bpy.ops.wm.open_mainfile(filepath=str(Path(path).resolve()), load_ui=False)
    except RuntimeError as error:
        raise Refusal(f"'{path}' cannot be opened: {' '.join(str(error).split())}") from None
    if bpy.context.scene.thenar.live:
        bpy.context.scene.thenar.live = False


def save_file(path):
    """Save the open file as a copy at `path`, whole or not at all."""
    target = Path(path).resolve()
    target.parent.mkdir(parents=True, exist_ok=True)
    partial = target.with_name(f".{target.stem}.{os.getpid()}.partial.blend")
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(partial), copy=True, compress=True)
        os.replace(partial, target)
    except RuntimeError as error:
        raise Refusal(f"'{target}' cannot be written: {' '.join(str(error).split())}") from None
    finally:
        partial.unlink(missing_ok=True)
        partial.with_name(partial.name + "@").unlink(missing_ok=True)  # what Blender writes first


def save_json(path, values):
    """Write `values` as JSON at `path`, whole or not at all."""
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(values, indent=1)
    export.replace_file(target, lambda partial: partial.write_text(text + "\n", encoding="utf-8"))


def press(options):
    """Set hand, product, force and frame as asked for, and solve. Returns the result as plain values."""
    choose(options)
    workflow.solve(bpy.context)
    return results.as_dict(bpy.context.scene.thenar.result)


def choose(options):
    """Set hand, product, model, force and frame of the open file as asked for. Raises `Refusal`."""
    scene = bpy.context.scene
    settings = scene.thenar
    if options.frame is not None:
        scene.frame_set(options.frame)
    if options.hand:
        settings.hand = _find(options.hand, "hand")
    if options.product:
        _set_product(settings, options.product)
    if options.model:
        settings.model = options.model.upper()
    if options.force is not None:
        if options.force <= 0.0:
            raise Refusal(f"a force of {options.force:g} N cannot be reached; give one above zero")
        settings.use_force, settings.force_n = True, options.force


def _find(name, role):
    found = bpy.data.objects.get(name)
    if found is None:
        listed = ", ".join(sorted(obj.name for obj in bpy.data.objects if obj.type == "MESH")[:8]) or "none"
        raise Refusal(f"there is no object '{name}' for the {role}; meshes in the file: {listed}")
    return found


def _set_product(settings, name):
    if name not in bpy.data.objects and name in bpy.data.collections:
        settings.product, settings.product_collection = None, bpy.data.collections[name]
    else:
        settings.product, settings.product_collection = _find(name, "product"), None
