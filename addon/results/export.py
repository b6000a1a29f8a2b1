"""A result as files: CSV, NPZ, and scene formats that carry the pressure as an attribute."""

import csv
import os
from contextlib import ExitStack
from pathlib import Path

import bpy
import numpy as np

from .. import names, workflow
from ..ownership import owned
from ..product_objects import copies
from ..scene import attributes, baked, mesh, units
from ..scene.checks import Refusal
from . import result as results

_SCENE = {".glb", ".gltf", ".usd", ".usda", ".usdc", ".usdz"}


def write(context, filepath):
    """Write the scene's result to `filepath`; its suffix chooses the form. Returns the paths written.

    Raises `Refusal` for an unknown suffix, a missing folder, or a result that is no longer on the hand.
    """
    path = Path(filepath)
    suffix = path.suffix.lower()
    if not path.parent.is_dir():
        raise Refusal(f"there is no folder '{path.parent}'; make it or choose another place")
    if suffix in _SCENE:
        return _write_scene(context, path, suffix)
    if suffix not in {".csv", ".npz"}:
        raise Refusal(f"'{path.name}' has no suffix that Thenar writes; use .csv, .npz, .glb, .gltf or .usd")
    tables = [("", hand_table(context)), *(("-" + name, table) for name, table in product_tables(context))]
    if suffix == ".csv":
        return _write_csv(path, tables)
    return _write_npz(context, path, tables)


def write_bake(context, filepath):
    """Write the numbers of the bake that plays, one row per frame, as CSV. Returns the path.

    Raises `Refusal` for a missing folder or a bake whose files are gone.
    """
    path, hand = Path(filepath), context.scene.thenar.hand
    if not path.parent.is_dir():
        raise Refusal(f"there is no folder '{path.parent}'; make it or choose another place")
    curves = baked.curves(hand)
    if curves is None:
        raise Refusal(f"the bake of '{hand.name}' has lost its files beside the scene; bake again")
    render = context.scene.render
    seconds = (curves["frame"] - curves["frame"][0]) * render.fps_base / render.fps
    table = {"frame": curves.pop("frame"), "time_s": seconds, **curves}
    replace_file(path, lambda partial: _save_columns(partial, table))
    return path


def hand_table(context):
    """Columns (n,) by name of the hand: world positions with contact, displacement, pressure, force, depth, region;
    shear and slip margin where the product was dragged; pressure over its threshold where comfort is judged."""
    hand = context.scene.thenar.hand
    if hand is None or hand.type != "MESH" or names.DISPLACEMENT_MM not in hand.data.attributes:
        raise Refusal("the result is no longer on the hand; solve again")
    moved = attributes.read(hand.data, names.DISPLACEMENT_MM)
    force = attributes.read(hand.data, names.FORCE_N)
    besides = (names.SHEAR_KPA, names.SLIP_MARGIN, names.THRESHOLD_SHARE)
    there = {name: attributes.read(hand.data, name) for name in besides}
    return {
        "index": np.arange(len(moved)),
        **_axes("{}_mm", _world_mm(context, hand, len(moved))),
        **_axes("d{}_mm", moved),
        "pressure_kpa": attributes.read(hand.data, names.PRESSURE_KPA),
        "force_n": force,
        "depth_mm": attributes.read(hand.data, names.DEPTH_MM),
        "region": attributes.read(hand.data, names.REGION),
        "in_contact": (force > 0.0).astype(np.int32),
        **{name: values for name, values in there.items() if values is not None},
    }


def product_tables(context):
    """(part's name, columns) of every product part, from the part itself or the copy that carries its pressure."""
    for part in workflow.product_parts(context.scene.thenar):
        carrier = copies.find_copy(part.name) or part
        if carrier.type != "MESH" or not owned.is_own(carrier.data, names.PRESSURE_KPA):
            continue
        pressure = attributes.read(carrier.data, names.PRESSURE_KPA)
        places = _world_mm(context, carrier, len(pressure))
        yield part.name, {"index": np.arange(len(pressure)), **_axes("{}_mm", places), "pressure_kpa": pressure}


def replace_file(path, write_to):
    """Write a file as a whole or not at all: `write_to(temporary path)`, then one rename."""
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        write_to(partial)
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)


def _world_mm(context, obj, count):
    matrix, scale = units.world_from_local(obj), units.mm_per_unit(context.scene)
    if obj.hide_viewport:
        places = mesh.positions(obj.data)
    else:
        places = mesh.evaluated_positions(obj, context.evaluated_depsgraph_get(), count)
    return units.to_world_mm(places, matrix, scale, np.zeros(3))


def _axes(pattern, vectors):
    return {pattern.format(axis): vectors[:, place] for place, axis in enumerate("xyz")}


def _write_csv(path, tables):
    written = []
    for suffix, table in tables:
        target = path.with_name(path.stem + bpy.path.clean_name(suffix) + path.suffix)
        replace_file(target, lambda partial, table=table: _save_columns(partial, table))
        written.append(target)
    return written


def _save_columns(path, table):
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(table)
        writer.writerows(zip(*(_texts(column) for column in table.values()), strict=True))


def _texts(column):
    return column.tolist() if column.dtype.kind in "iu" else np.char.mod("%.7g", column).tolist()


def _write_npz(context, path, tables):
    import json

    arrays = {"summary_json": np.array(json.dumps(results.as_dict(context.scene.thenar.result)))}
    for suffix, table in tables:
        prefix = f"product{suffix}" if suffix else "hand"
        arrays.update({f"{prefix}/{name}": column for name, column in table.items()})

    def save(partial):
        with partial.open("wb") as file:
            np.savez_compressed(file, **arrays)

    replace_file(path, save)
    return [path]


def _write_scene(context, path, suffix):
    with ExitStack() as undo:
        chosen = [context.scene.thenar.hand]
        for part in workflow.product_parts(context.scene.thenar):
            chosen.append(copies.find_copy(part.name) or part)
        _select(context, undo, chosen)
        if suffix in {".glb", ".gltf"}:
            _underscored(undo, chosen)
            bpy.ops.export_scene.gltf(
                filepath=str(path),
                use_selection=True,
                export_attributes=True,
                export_format="GLB" if suffix == ".glb" else "GLTF_SEPARATE",
            )
        else:
            bpy.ops.wm.usd_export(filepath=str(path), selected_objects_only=True, export_shapekeys=True)
    return [path]


def _underscored(undo, objects):
    for obj in objects:
        pressure = attributes.read(obj.data, names.PRESSURE_KPA) if obj.type == "MESH" else None
        if pressure is not None:
            attributes.write(obj.data, names.GLTF_PRESSURE, "FLOAT", pressure)
            undo.callback(attributes.remove, obj.data, [names.GLTF_PRESSURE])


def _select(context, undo, chosen):
    selected, active = list(context.selected_objects), context.view_layer.objects.active
    hidden = [obj for obj in chosen if obj.hide_viewport]

    def restore():
        for obj in hidden:
            obj.hide_viewport = True
        for obj in context.view_layer.objects:
            obj.select_set(obj in selected)
        context.view_layer.objects.active = active

    undo.callback(restore)
    for obj in hidden:
        obj.hide_viewport = False
    for obj in context.view_layer.objects:
        obj.select_set(obj in chosen)
    context.view_layer.objects.active = chosen[0]
