"""A baked contact: positions as PC2 played by a Mesh Cache modifier, fields as NPZ played on frame changes."""

import os
import struct
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, BinaryIO, TypeAlias

import bpy
import numpy as np
from bpy.types import Object, PropertyGroup, Scene

from .. import names
from . import attributes, colors, correction, moving, own, units, write
from .checks import Refusal
from .units import Floats

Frame: TypeAlias = dict[str, Any]
"""What is kept of a frame, see `publish`."""

DEFORMERS = {
    "ARMATURE", "CAST", "CORRECTIVE_SMOOTH", "CURVE", "DISPLACE", "HOOK", "LAPLACIANDEFORM", "LAPLACIANSMOOTH",
    "LATTICE", "MESH_CACHE", "MESH_DEFORM", "SHRINKWRAP", "SIMPLE_DEFORM", "SMOOTH", "SURFACE_DEFORM", "WARP", "WAVE",
}  # fmt: skip
"""Modifiers that keep every vertex; the bake stands behind the last of the leading ones."""

_NUMBERS = ("force_n", "area_mm2", "peak_kpa", "shear_n", "work_mj", "slip_loss_mj")
_UNTOUCHED = {names.SLIP_MARGIN: 1.0}
"""What a field says where nothing touches, if that is not 0."""
_OF_ONE_PRESS = (
    names.DEPTH_MM,
    names.OVERLAP_MM,
    names.EDGE_MM,
    names.FORCE_N,
    names.DISPLACEMENT_MM,
    names.SHEAR_KPA,
    names.SLIP_MARGIN,
    names.THRESHOLD_SHARE,
    *names.REFERENCE_ATTRIBUTES,
)
"""Attributes of a press that are wrong once a bake plays, unless the bake plays them too."""
_loaded: dict[str, dict[str, Any]] = {}


def place_in_stack(hand: Object) -> int:
    """Index of the bake's modifier: behind the leading deformers, before the first that may add vertices."""
    others = [modifier for modifier in hand.modifiers if not modifier.name.startswith(names.BAKE_MODIFIER)]
    return next((index for index, modifier in enumerate(others) if modifier.type not in DEFORMERS), len(others))


def folder_of(hand: Object) -> Path:
    """The bake's folder beside the saved file, made where missing. Raises `Refusal` for an unsaved file."""
    if not bpy.data.filepath:
        raise Refusal("a bake is saved next to the file; save the file first")
    folder = Path(bpy.data.filepath).parent / names.BAKE_FOLDER
    folder.mkdir(exist_ok=True)
    return folder / str(bpy.path.clean_name(f"{Path(bpy.data.filepath).stem}-{hand.name}"))


def publish(hand: Object, stem: Path, first_frame: int, frames: Sequence[Frame]) -> None:
    """Write the baked `frames` and hang them on the hand; files are whole or not there at all.

    `frames`: dicts with `local` (n, 3) positions in object space, `fields` {attribute: (n)} of the hand, `parts` and
    `part_edges` {name: kPa, mm (k)}, the numbers of `_NUMBERS`, and `offset` (3), how far the product moves, world,
    Blender units.
    """
    pc2, npz = stem.with_name(stem.name + ".pc2"), stem.with_name(stem.name + ".npz")
    _replace(pc2, lambda file: _write_pc2(file, first_frame, frames))
    _replace(npz, lambda file: np.savez_compressed(file, **_tables(first_frame, frames)))
    for modifier in own.bake_modifiers(hand):
        hand.modifiers.remove(modifier)
    correction.remove(hand)
    index = place_in_stack(hand)
    cache = hand.modifiers.new(names.BAKE_MODIFIER, "MESH_CACHE")
    cache.cache_format, cache.filepath = "PC2", bpy.path.relpath(str(pc2))
    cache.frame_start, cache.deform_mode, cache.interpolation = first_frame, "OVERWRITE", "LINEAR"
    cache.forward_axis, cache.up_axis = "POS_Y", "POS_Z"
    hand.modifiers.move(len(hand.modifiers) - 1, index)
    hand.thenar.bake_path = bpy.path.relpath(str(npz))
    attributes.remove(hand.data, [name for name in _OF_ONE_PRESS if name not in _field_names(frames)])
    _loaded.clear()


def hand_fields(fields: write.Fields) -> dict[str, Floats]:
    """What a frame plays on the hand, float32 (n,) by attribute, from `write.Fields`."""
    values = {names.PRESSURE_KPA: units.kpa(fields.pressure_mpa), names.DEPTH_MM: fields.depth_mm}
    values[names.OVERLAP_MM] = fields.overlap_mm
    if fields.edge_mm is not None:
        values[names.EDGE_MM] = fields.edge_mm
    if fields.shear is not None:
        values |= {names.SHEAR_KPA: units.kpa(fields.shear[0]), names.SLIP_MARGIN: fields.shear[1]}
    return {name: np.asarray(value, np.float32) for name, value in values.items()}


def play(scene: Scene, find_parts: Callable[[PropertyGroup], Sequence[Object]]) -> None:
    """Write the pressures of the scene's frame onto hand and product, and move the product; nothing without a bake.

    `find_parts(settings)` gives the product's objects. A missing file is left for the panel to tell.
    """
    hand = scene.thenar.hand
    if hand is None or not hand.thenar.bake_path or hand.type != "MESH" or hand.mode == "EDIT":
        return
    tables = _load(hand)
    if tables is None:
        return
    row = int(np.clip(scene.frame_current - int(tables["first_frame"]), 0, len(tables["force_n"]) - 1))
    fields = {name.removeprefix("hand/"): table[row] for name, table in tables.items() if name.startswith("hand/")}
    _show(hand, fields or {names.PRESSURE_KPA: tables["hand"][row]}, scene.thenar, colors.SKIN)
    parts = find_parts(scene.thenar)
    for part in parts:
        values = tables.get(f"part/{part.name}")
        if values is not None and part.type == "MESH" and part.mode != "EDIT":
            edges = tables.get(f"edge/{part.name}")
            shown = {names.PRESSURE_KPA: values[row]} | ({} if edges is None else {names.EDGE_MM: edges[row]})
            _show(part, shown, scene.thenar, colors.BARE)
    offsets = tables["offset"]
    for part in own.roots(parts) if np.any(offsets) else ():
        moving.shift(part, offsets[row])


def curves(hand: Object) -> dict[str, Any] | None:
    """Columns (k,) by name of the hand's bake, one row per frame; None where its file is gone."""
    tables = _load(hand)
    if tables is None:
        return None
    frames = int(tables["first_frame"]) + np.arange(len(tables["force_n"]))
    return {"frame": frames, **{name: tables[name] for name in _NUMBERS if name in tables}}


def is_missing(hand: Object) -> bool:
    """Whether the hand's bake names a file that is not there."""
    return bool(hand.thenar.bake_path) and not os.path.exists(bpy.path.abspath(hand.thenar.bake_path))


def forget() -> None:
    """Drop loaded bakes."""
    _loaded.clear()


def _show(obj: Object, fields: dict[str, Floats], look: PropertyGroup, bare: colors.Color) -> None:
    mesh = obj.data
    if any(len(values) != len(mesh.vertices) for values in fields.values()):
        return
    attributes.remove(mesh, [name for name in (names.EDGE_MM, names.OVERLAP_MM) if name not in fields])
    for name, values in fields.items():
        attributes.write(mesh, name, "FLOAT", values)
    colors.recolor(obj, look, bare)


def _load(hand: Object) -> dict[str, Floats] | None:
    path = bpy.path.abspath(hand.thenar.bake_path)
    if path not in _loaded:
        _loaded.clear()
        if not os.path.exists(path):
            return None
        with np.load(path, allow_pickle=False) as file:
            _loaded[path] = {name: file[name] for name in file.files}
    return _loaded[path]


def _tables(first_frame: int, frames: Sequence[Frame]) -> dict[str, Any]:
    tables: dict[str, Any] = {"first_frame": np.int32(first_frame)}
    for name in _field_names(frames):
        plain = np.full(len(frames[0]["local"]), _UNTOUCHED.get(name, 0.0), np.float32)
        tables[f"hand/{name}"] = np.stack([frame["fields"].get(name, plain) for frame in frames])
    for name in frames[0]["parts"]:
        tables[f"part/{name}"] = np.stack([frame["parts"][name] for frame in frames])
        tables[f"edge/{name}"] = np.stack([frame["part_edges"][name] for frame in frames])
    for name in (*_NUMBERS, "offset"):
        tables[name] = np.array([frame[name] for frame in frames])
    return tables


def _field_names(frames: Sequence[Frame]) -> list[str]:
    return sorted({name for frame in frames for name in frame["fields"]})


def _write_pc2(file: BinaryIO, first_frame: int, frames: Sequence[Frame]) -> None:
    count = len(frames[0]["local"])
    file.write(struct.pack("<12siiffi", b"POINTCACHE2\0", 1, count, float(first_frame), 1.0, len(frames)))
    for frame in frames:
        file.write(np.ascontiguousarray(frame["local"], "<f4").tobytes())


def _replace(path: Path, put: Callable[[BinaryIO], object]) -> None:
    partial = path.with_name(f".{path.name}.partial")
    try:
        with partial.open("wb") as file:
            put(file)
            file.flush()
            os.fsync(file.fileno())
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)
