"""A baked contact: positions as PC2 played by a Mesh Cache modifier, fields as NPZ played on frame changes."""

import hashlib
import json
import os
import shutil
import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, TypeAlias
from zipfile import BadZipFile

import bpy
import numpy as np
from bpy.types import Modifier, Object, PropertyGroup, Scene

from .. import names
from ..ownership import own
from ..product_objects import moving
from ..skin_display import colors
from . import attributes, correction, units, write
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
_GROUPS = ("fields", "parts", "part_edges")
"""What of a `Frame` is a dictionary itself."""
_LONGEST = 120
"""Most bytes of a file's name before its digest; file systems take 255."""
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


def stem_of(hand: Object, take: str) -> Path:
    """Path of a take's files without their suffix, in the folder next to the saved file, which is made where missing.

    A digest tells names apart that differ by what no file name holds. Raises `Refusal` for an unsaved file.
    """
    if not bpy.data.filepath:
        raise Refusal("a bake is saved next to the file; save the file first")
    folder = Path(bpy.data.filepath).parent / names.BAKE_FOLDER
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise Refusal(f"a bake is saved next to the file, but '{folder}' cannot be made: {error.strerror}") from None
    parts = Path(bpy.data.filepath).stem, hand.name, take
    digest = hashlib.blake2b("\0".join(parts).encode(), digest_size=4).hexdigest()
    plain = str(bpy.path.clean_name("-".join(parts))).encode()[:_LONGEST].decode(errors="ignore")
    return folder / f"{plain}-{digest}"


@dataclass(frozen=True)
class Take:
    """A bake of one name: its files' path without suffix, first frame, and `sums`, the values of `hand.thenar.bake`."""

    name: str
    stem: Path
    first_frame: int
    sums: dict[str, Any]


def take_names(hand: Object) -> list[str]:
    """Names of the hand's takes, oldest first."""
    return [_take_name(modifier) for modifier in reversed(own.bake_modifiers(hand))]


def is_playing(hand: Object, take: str) -> bool:
    """Whether the take of this name plays."""
    playing = _playing(hand)
    return playing is not None and _take_name(playing) == take


def free_name(hand: Object) -> str:
    """The first of `Take 1`, `Take 2`, ... that no take has."""
    taken, number = set(take_names(hand)), 1
    while f"Take {number}" in taken:
        number += 1
    return f"Take {number}"


def publish(hand: Object, take: Take, frames: Sequence[Frame], parts: Sequence[Object]) -> None:
    """Write the baked `frames` and hang them on the hand; files are whole or not there at all. Other takes stay.

    `frames`: dicts with `local` (n, 3) positions in object space, `fields` {attribute: (n)} of the hand, `parts` and
    `part_edges` {name: kPa, mm (k)}, the numbers of `_NUMBERS`, and `offset` (3), how far the product moves, world,
    Blender units.
    """
    pc2, npz = (take.stem.with_name(take.stem.name + suffix) for suffix in (".pc2", ".npz"))
    keys = _keys_of(hand, parts)
    _replace(pc2, lambda file: _write_pc2(file, take.first_frame, frames))
    _replace(npz, lambda file: np.savez_compressed(file, **_tables(take, frames, keys)))
    for modifier in own.bake_modifiers(hand):
        if _take_name(modifier) == take.name:
            hand.modifiers.remove(modifier)
    correction.remove(hand)
    index = place_in_stack(hand)
    cache = hand.modifiers.new(f"{names.BAKE_MODIFIER}: {take.name}", "MESH_CACHE")
    cache.cache_format, cache.filepath = "PC2", bpy.path.relpath(str(pc2))
    cache.frame_start, cache.deform_mode, cache.interpolation = take.first_frame, "OVERWRITE", "LINEAR"
    cache.frame_scale = 1.0 / _stretch(bpy.context.scene)
    cache.forward_axis, cache.up_axis = "POS_Y", "POS_Z"
    hand.modifiers.move(len(hand.modifiers) - 1, index)
    hand.thenar.bake_path = bpy.path.relpath(str(npz))
    attributes.remove(hand.data, [name for name in _OF_ONE_PRESS if name not in _field_names(frames)])
    _loaded.clear()
    choose(hand, take.name)


def keep_frame(stem: Path, digest: str, frame: Frame) -> None:
    """Keep a solved frame until its bake ends, under the `digest` of what it was solved from."""
    place = _frame_place(stem, digest)
    place.parent.mkdir(exist_ok=True)
    grouped = {f"{group}/{name}": values for group in _GROUPS for name, values in frame[group].items()}
    plain = {name: value for name, value in frame.items() if name not in _GROUPS}
    _replace(place, lambda file: np.savez(file, **grouped, **plain))


def kept_frame(stem: Path, digest: str) -> Frame | None:
    """The frame that a bake kept which ended in a crash; None where there is none, or it is not whole."""
    try:
        with np.load(_frame_place(stem, digest), allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except (OSError, ValueError, EOFError, BadZipFile):
        return None
    frame: Frame = {group: {} for group in _GROUPS}
    for name, values in arrays.items():
        group, slash, key = name.partition("/")
        if slash:
            frame[group][key] = values
        else:
            frame[name] = values if values.ndim else float(values)
    return frame


def forget_frames(stem: Path) -> None:
    """Remove the frames that were kept while a bake ran."""
    shutil.rmtree(_frame_place(stem, "").parent, ignore_errors=True)


def choose(hand: Object, take: str) -> None:
    """Let the hand play the take of this name. Raises `Refusal` where there is none, or its file is gone."""
    modifiers = {_take_name(modifier): modifier for modifier in own.bake_modifiers(hand)}
    if take not in modifiers:
        raise Refusal(f"'{hand.name}' has no take '{take}'; it has {', '.join(modifiers) or 'none'}")
    for name, modifier in modifiers.items():
        modifier.show_viewport = modifier.show_render = name == take
    tables = _load(hand)
    if tables is None:
        raise Refusal(f"the file of take '{take}' is missing: '{_path(hand)}'; bake it again")
    if "sums_json" in tables:
        for name, value in json.loads(str(tables["sums_json"])).items():
            setattr(hand.thenar.bake, name, value)
    own.remove_bake_curves(hand)
    first, stretch = int(tables["first_frame"]), _stretch(bpy.context.scene)
    for name, column in own.BAKE_CURVES.items():
        for row, value in enumerate(tables[column]):
            setattr(hand.thenar.bake, name, float(value))
            hand.keyframe_insert(f"thenar.bake.{name}", frame=(first + row) * stretch, group=names.BAKE_MODIFIER)


def notes(hand: Object, parts: Sequence[Object]) -> list[str]:
    """What of the take that plays is missing or no longer fits, a sentence each."""
    playing = _playing(hand)
    if playing is None:
        return ["no take is shown; choose one, or switch its modifier on"]
    tables = _load(hand)
    if tables is None:
        return [f"its file is missing or damaged: '{_path(hand)}'; put it back, or bake again"]
    found = []
    pressure = tables.get(f"hand/{names.PRESSURE_KPA}", tables.get("hand"))
    if pressure is not None and len(pressure[0]) != len(hand.data.vertices):
        found.append(f"'{hand.name}' had {len(pressure[0])} vertices when it was baked; bake again")
    if playing.time_mode != "FRAME":
        found.append("the modifier counts time otherwise than in frames: pressure plays by frames; set it back")
    for part in parts:
        values = tables.get(f"part/{_key_of(hand, part)}")
        if values is None and part.type == "MESH":
            found.append(f"'{part.name}' is not in this bake and shows no pressure of it")
        elif values is not None and len(values[0]) != len(part.data.vertices):
            found.append(f"'{part.name}' had {len(values[0])} vertices when it was baked; bake again")
    return found


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
    moment = _moment(hand, scene, len(tables["force_n"]))
    fields = {
        name.removeprefix("hand/"): _at(rows, moment) for name, rows in tables.items() if name.startswith("hand/")
    }
    _show(hand, fields or {names.PRESSURE_KPA: _at(tables["hand"], moment)}, scene.thenar, colors.SKIN)
    parts = find_parts(scene.thenar)
    for part in parts:
        key = _key_of(hand, part)
        values = tables.get(f"part/{key}")
        if values is not None and part.type == "MESH" and part.mode != "EDIT":
            edges = tables.get(f"edge/{key}")
            shown = {names.PRESSURE_KPA: _at(values, moment)}
            shown |= {} if edges is None else {names.EDGE_MM: _at(edges, moment)}
            _show(part, shown, scene.thenar, colors.BARE)
    offsets = tables["offset"]
    for part in own.roots(parts) if np.any(offsets) else ():
        moving.shift(part, _at(offsets, moment))


def curves(hand: Object) -> dict[str, Any] | None:
    """Columns (k,) by name of the hand's bake, one row per frame; None where its file is gone."""
    tables = _load(hand)
    if tables is None:
        return None
    frames = int(tables["first_frame"]) + np.arange(len(tables["force_n"]))
    return {"frame": frames, **{name: tables[name] for name in _NUMBERS if name in tables}}


def is_missing(hand: Object) -> bool:
    """Whether the hand's bake names a file that is not there."""
    return bool(hand.thenar.bake_path) and not os.path.exists(_path(hand))


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
    path = _path(hand)
    if path not in _loaded:
        _loaded.clear()
        if not os.path.exists(path):
            return None
        try:
            with np.load(path, allow_pickle=False) as file:
                _loaded[path] = {name: file[name] for name in file.files}
        except (OSError, ValueError, EOFError, BadZipFile):
            return None  # damaged, or being written: as a file that is missing
    return _loaded[path]


def _frame_place(stem: Path, digest: str) -> Path:
    name = hashlib.blake2b(digest.encode(), digest_size=16).hexdigest()
    return stem.with_name(f"{stem.name}.frames") / f"{name}.npz"


def _playing(hand: Object) -> Modifier | None:
    """The modifier that plays the shape, or None."""
    return next((modifier for modifier in own.bake_modifiers(hand) if modifier.show_viewport), None)


def _path(hand: Object) -> str:
    """The file of the fields: next to that of the shape, which Blender keeps right when the file is saved elsewhere."""
    playing = _playing(hand)
    path = hand.thenar.bake_path
    if playing is not None and playing.filepath.endswith(".pc2"):
        path = playing.filepath.removesuffix(".pc2") + ".npz"
    return str(bpy.path.abspath(path, library=hand.library))


def _take_name(modifier: Modifier) -> str:
    """A take's name; that of bakes of earlier versions is empty."""
    return str(modifier.name.removeprefix(names.BAKE_MODIFIER).removeprefix(": "))


def _stretch(scene: Scene) -> float:
    """By how much the scene's time stretching slows its animation: the frame that is evaluated over the frame shown."""
    return float(scene.render.frame_map_old / scene.render.frame_map_new)


def _moment(hand: Object, scene: Scene, count: int) -> float:
    """Which of the `count` baked frames plays, counted from 0: as the modifier has it that plays the shape."""
    playing = _playing(hand)
    moment = scene.frame_current_final
    if playing is not None:
        moment = playing.frame_scale * moment - playing.frame_start
        if playing.play_mode == "CUSTOM":
            moment = playing.eval_frame
        if playing.interpolation == "NONE":
            moment = np.floor(moment + 0.5)
    return float(np.clip(moment, 0, count - 1))


def _at(rows: Floats, moment: float) -> Floats:
    """The row at a moment, between two rows in proportion."""
    before = int(moment)
    share = moment - before
    row: Floats = rows[before]
    if share >= 1e-4:
        row = ((1.0 - share) * row + share * rows[before + 1]).astype(rows.dtype)
    return row


def _keys_of(hand: Object, parts: Sequence[Object]) -> dict[str, str]:
    """The key of every part in a bake's files, by the part's present name; new parts get a row with their own."""
    known = hand.thenar.bake.parts
    for part in parts:
        if all(row.object != part for row in known):
            taken, key = {row.name for row in known}, part.name
            while key in taken:
                key += "'"
            row = known.add()
            row.name, row.object = key, part
    return {part.name: _key_of(hand, part) for part in parts}


def _key_of(hand: Object, part: Object) -> str:
    """The key of a part in a bake's files: the name that it had when it was baked first."""
    return str(next((row.name for row in hand.thenar.bake.parts if row.object == part), part.name))


def _tables(take: Take, frames: Sequence[Frame], keys: dict[str, str]) -> dict[str, Any]:
    tables: dict[str, Any] = {"first_frame": np.int32(take.first_frame), "sums_json": np.array(json.dumps(take.sums))}
    for name in _field_names(frames):
        plain = np.full(len(frames[0]["local"]), _UNTOUCHED.get(name, 0.0), np.float32)
        tables[f"hand/{name}"] = np.stack([frame["fields"].get(name, plain) for frame in frames])
    for name in frames[0]["parts"]:
        tables[f"part/{keys[name]}"] = np.stack([frame["parts"][name] for frame in frames])
        tables[f"edge/{keys[name]}"] = np.stack([frame["part_edges"][name] for frame in frames])
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
