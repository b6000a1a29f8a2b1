"""Formats of product files, and the check of a file before Blender's importer opens it. Knows nothing of Blender.

Blender's importers read the beginning of a file that is cut off, or crash on one of another kind: such files are
refused here.
"""

import json
import struct
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..scene.checks import Refusal

LISTED = "STL, OBJ, PLY, GLB, USD or FBX"
_HEAD = 65536
"""Bytes in which the header of a PLY file must end."""
_STL_ROW = np.dtype([("normal", "<f4", 3), ("corners", "<f4", 9), ("color", "<u2")])
_PLY_BYTES = {
    "char": 1, "uchar": 1, "int8": 1, "uint8": 1, "short": 2, "ushort": 2, "int16": 2, "uint16": 2, "int": 4,
    "uint": 4, "int32": 4, "uint32": 4, "float": 4, "float32": 4, "double": 8, "float64": 8,
}  # fmt: skip


@dataclass(frozen=True)
class Format:
    """A format: its `title`; importers as (area, name, options), the first one that Blender has is used; `check`.

    `check(path)` returns what is wrong with the file, empty if nothing is.
    """

    title: str
    importers: tuple
    check: object
    options: dict = field(default_factory=dict)


def format_of(path):
    """The `Format` of a file by its extension. Raises `Refusal` for one that is not read."""
    suffix = Path(path).suffix.lower()
    found = FORMATS.get(suffix)
    if found is None:
        kind = f"'{suffix}' files" if suffix else "files without an extension"
        raise Refusal(f"{kind} cannot be read as a product; export '{Path(path).name}' as {LISTED}")
    return found


def check(path):
    """Refuse a file that is missing, empty, cut off or of another kind. Raises `Refusal`. Returns its `Format`."""
    path = Path(path)
    found = format_of(path)
    if not path.is_file():
        raise Refusal(f"there is no file '{path.name}' in '{path.parent}'; choose the product's file")
    try:
        problem = found.check(path) if path.stat().st_size else "it is empty"
    except OSError as error:
        raise Refusal(f"'{path.name}' cannot be opened ({error.strerror}); check its permissions") from None
    if problem:
        raise Refusal(f"'{path.name}' is no complete {found.title} file: {problem}; export it again")
    return found


def _stl(path):
    size = path.stat().st_size
    head, tail = _ends(path)
    count = struct.unpack("<I", head[80:84])[0] if len(head) >= 84 else 0
    if count and size >= 84 + 50 * count and not (head.startswith(b"solid") and b"facet" in head):
        rows = np.memmap(path, _STL_ROW, "r", 84, (count,))
        return "" if np.isfinite(rows["corners"]).all() else "it holds corners that are no numbers"
    if head.lstrip().startswith(b"solid"):
        return "" if b"endsolid" in tail else "it ends before its last line, 'endsolid'"
    if count == 0 and size == 84:
        return "it holds no triangle"
    return f"it has {size:,} bytes where {count:,} triangles need {84 + 50 * count:,}"


def _ply(path):
    head, _ = _ends(path)
    header, end, _ = head.partition(b"end_header")
    if not head.startswith(b"ply") or not end:
        return "it has no PLY header"
    lines = [line.split() for line in header.decode("latin-1").splitlines()]
    counts, least, name = {}, {}, ""
    try:
        for line in lines:
            if line[:1] == ["element"]:
                name, counts[line[1]], least[line[1]] = line[1], int(line[2]), 0
            elif line[:1] == ["property"] and name:
                is_list = line[1] == "list"
                each = _PLY_BYTES[line[2]] + 3 * _PLY_BYTES[line[3]] if is_list else _PLY_BYTES[line[1]]
                least[name] += each
    except (IndexError, KeyError, ValueError):
        return "its header cannot be read"
    if counts.get("face", 0) < 1:
        return "it holds points but no faces"
    if ["format", "ascii", "1.0"] in lines:
        held = sum(1 for line in path.read_bytes().partition(b"end_header")[2].splitlines() if line.strip())
        return "" if held >= sum(counts.values()) else f"it has {held:,} lines of {sum(counts.values()):,}"
    needed = len(header) + sum(counts[key] * least[key] for key in ("vertex", "face") if key in counts)
    size = path.stat().st_size
    return "" if size >= needed else f"it has {size:,} bytes where its header promises {needed:,} at least"


def _obj(path):
    points = faces = 0
    with path.open("rb") as file:
        if b"\0" in file.read(1024):
            return "it is no text"
        file.seek(0)
        for line in file:
            is_point = line.startswith((b"v ", b"v\t"))
            if is_point and (b"n" in line or b"N" in line):
                return f"its point {points + 1:,} is no number"
            points += is_point
            faces += line.startswith((b"f ", b"f\t"))
    return "" if points >= 3 and faces else f"it holds {points:,} points and {faces:,} faces"


def _glb(path):
    with path.open("rb") as file:
        head = file.read(12)
    if len(head) < 12 or head[:4] != b"glTF":
        return "it does not begin as one"
    version, length = struct.unpack("<II", head[4:12])
    if version != 2:
        return f"it is of version {version}, and Blender reads version 2"
    size = path.stat().st_size
    return "" if size >= length else f"it has {size:,} bytes of {length:,}"


def _gltf(path):
    try:
        held = json.loads(path.read_bytes())
    except (ValueError, RecursionError):
        return "its text is no JSON"
    return "" if isinstance(held, dict) and "asset" in held else "it names no asset"


def _fbx(path):
    head, _ = _ends(path)
    return "" if head.startswith(b"Kaydara FBX Binary") or b"FBX" in head[:200] else "it does not begin as one"


def _usd(path):
    head, _ = _ends(path)
    return "" if head.lstrip().startswith((b"PXR-USDC", b"#usda", b"PK\x03\x04")) else "it does not begin as one"


def _ends(path):
    """The beginning and the last 512 bytes of a file."""
    with path.open("rb") as file:
        head = file.read(_HEAD)
        file.seek(max(0, path.stat().st_size - 512))
        return head, file.read()


_MESH = Format("STL", (("wm", "stl_import"),), _stl)
_GLTF = (("import_scene", "gltf"),)
_USD_FORMAT = Format("USD", (("wm", "usd_import"),), _usd, {"set_frame_range": False})
FORMATS = {
    ".stl": _MESH,
    ".obj": Format("OBJ", (("wm", "obj_import"),), _obj),
    ".ply": Format("PLY", (("wm", "ply_import"),), _ply),
    ".glb": Format("GLB", _GLTF, _glb),
    ".gltf": Format("glTF", _GLTF, _gltf),
    ".usd": _USD_FORMAT,
    ".usda": _USD_FORMAT,
    ".usdc": _USD_FORMAT,
    ".usdz": _USD_FORMAT,
    ".fbx": Format("FBX", (("wm", "fbx_import"), ("import_scene", "fbx")), _fbx, {"use_anim": False}),
}
"""Extension -> `Format`."""
