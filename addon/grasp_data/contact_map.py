"""A contact in the layout of grasp data sets: a row per pressed vertex with region, object point, normal and pressure.

Points are in the frame of the product's first part: its rotation and place taken off, its scale kept, in mm.
"""

import csv
import json
from pathlib import Path

import numpy as np

from .. import names, native
from ..batch.rows import cell
from ..product_objects import copies
from ..product_objects.parts import product_parts
from ..results import export
from ..results import result as results
from ..scene import attributes, mesh, units
from ..scene.checks import Refusal

FORMAT = "thenar contact map"
VERSION = 1
SUFFIXES = (".npz", ".csv")


def write(context, filepath):
    """Write the scene's contact to `filepath`; its suffix chooses the form. Returns the path and the number of rows.

    Raises `Refusal` for another suffix, a missing folder, or a result that is no longer on hand and product.
    """
    path = Path(filepath)
    if not path.parent.is_dir():
        raise Refusal(f"there is no folder '{path.parent}'; make it or choose another place")
    if path.suffix.lower() not in SUFFIXES:
        raise Refusal(f"'{path.name}' has no suffix of a contact map; use .npz or .csv")
    table, arrays = rows(context)
    if path.suffix.lower() == ".csv":
        export.replace_file(path, lambda partial: _save_csv(partial, table))
    else:
        export.replace_file(path, lambda partial: _save_npz(partial, {**table, **arrays}))
    return path, len(table["vertex"])


def rows(context):
    """`(table, arrays)`: columns (k, ...) of the pressed vertices, and hand and object as a whole."""
    hand = export.hand_table(context)
    parts = [_surface(context, part) for part in product_parts(context.scene.thenar)]
    parts = [part for part in parts if part is not None]
    if not parts:
        raise Refusal("the result is no longer on the product; solve again")
    frame = _frame(context, product_parts(context.scene.thenar)[0])
    pressed = np.flatnonzero(hand["in_contact"])
    points = np.stack([hand[f"{axis}_mm"] for axis in "xyz"], axis=1).astype(np.float64)
    nearest, normal, part = _nearest(parts, points[pressed])
    region_names = [region.name for region in context.scene.thenar.result.regions] or [names.WHOLE_SKIN]
    region = hand["region"][pressed]
    table = {
        "vertex": pressed.astype(np.int32),
        "region": np.array([region_names[index] if 0 <= index < len(region_names) else "" for index in region]),
        "part": np.array([parts[index].name for index in part]),
        "hand_point_mm": _into(frame, points[pressed]),
        "object_point_mm": _into(frame, nearest),
        "object_normal": normal @ frame[:3, :3],
        "pressure_kpa": hand["pressure_kpa"][pressed].astype(np.float64),
        "force_n": hand["force_n"][pressed].astype(np.float64),
    }
    return table, _whole(context, hand, parts, frame)


class _Part:
    """A part's surface as it carries the pressure: world mm."""

    def __init__(self, name, places, triangles, pressure):
        self.name, self.places, self.triangles, self.pressure = name, places, triangles, pressure


def _surface(context, part):
    """The `_Part` of a part, from the part itself or the copy that carries its pressure; None without a pressure."""
    carrier = copies.find_copy(part.name) or part
    if carrier.type != "MESH" or names.PRESSURE_KPA not in carrier.data.attributes:
        return None
    pressure = attributes.read(carrier.data, names.PRESSURE_KPA)
    matrix, scale = units.world_from_local(carrier), units.mm_per_unit(context.scene)
    if carrier.hide_viewport:
        places = mesh.positions(carrier.data)
    else:
        places = mesh.evaluated_positions(carrier, context.evaluated_depsgraph_get(), len(pressure))
    triangles = mesh.triangles(carrier.data)
    triangles = triangles[:, ::-1] if units.is_mirrored(matrix) else triangles
    return _Part(part.name, units.to_world_mm(places, matrix, scale, np.zeros(3)), triangles, pressure)


def _nearest(parts, points):
    """Nearest point (k, 3) of the parts' surfaces to each point, its outward normal (k, 3), and which part's it is."""
    origin = points.mean(axis=0) if len(points) else np.zeros(3)
    best = np.full(len(points), np.inf)
    nearest, normal, which = np.zeros_like(points), np.zeros_like(points), np.zeros(len(points), np.int32)
    for index, part in enumerate(parts if len(points) else ()):
        product = native.module.Product(part.places - origin, np.ascontiguousarray(part.triangles))
        found = product.gap_mm(points - origin)
        nearer = np.abs(found["gap_mm"]) < best
        best[nearer] = np.abs(found["gap_mm"])[nearer]
        nearest[nearer] = np.asarray(found["closest_mm"])[nearer] + origin
        normal[nearer] = np.asarray(found["normal"])[nearer]
        which[nearer] = index
    return nearest, normal, which


def _frame(context, part):
    """world_from_object (4, 4), rigid, mm."""
    place, turn, _scale = part.matrix_world.decompose()
    out = np.eye(4)
    out[:3, :3] = np.array(turn.to_matrix(), dtype=np.float64)
    out[:3, 3] = np.array(place, dtype=np.float64) * units.mm_per_unit(context.scene)
    return out


def _into(frame, points):
    return (points - frame[:3, 3]) @ frame[:3, :3]


def _whole(context, hand, parts, frame):
    """Hand and object as a whole, with what a reader of the file needs to know."""
    firsts = np.cumsum([0, *(len(part.places) for part in parts)])
    places = np.stack([hand[f"{axis}_mm"] for axis in "xyz"], axis=1)
    return {
        "format": np.array(FORMAT),
        "version": np.array(VERSION),
        "world_from_object_mm": frame,
        "hand_vertices_mm": _into(frame, places.astype(np.float64)),
        "hand_triangles": mesh.triangles(context.scene.thenar.hand.data),
        "hand_pressure_kpa": hand["pressure_kpa"],
        "hand_region": hand["region"],
        "region_names": np.array([region.name for region in context.scene.thenar.result.regions] or [names.WHOLE_SKIN]),
        "object_vertices_mm": _into(frame, np.concatenate([part.places for part in parts])),
        "object_triangles": np.concatenate(
            [part.triangles + first for part, first in zip(parts, firsts[:-1], strict=True)]
        ),
        "object_pressure_kpa": np.concatenate([part.pressure for part in parts]),
        "object_part": np.repeat(np.arange(len(parts), dtype=np.int32), np.diff(firsts)),
        "part_names": np.array([part.name for part in parts]),
        "summary_json": np.array(json.dumps(results.as_dict(context.scene.thenar.result))),
    }


def _save_npz(path, arrays):
    with path.open("wb") as file:
        np.savez_compressed(file, **arrays)


def _save_csv(path, table):
    vectors = {"hand_point_mm": "hand_{}_mm", "object_point_mm": "object_{}_mm", "object_normal": "normal_{}"}
    columns = {}
    for name, values in table.items():
        if name in vectors:
            columns.update({vectors[name].format(axis): values[:, place] for place, axis in enumerate("xyz")})
        else:
            columns[name] = values
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        texts = [
            list(map(cell, values.tolist())) if values.dtype.kind in "iuU" else np.char.mod("%.7g", values).tolist()
            for values in columns.values()
        ]
        writer.writerows(zip(*texts, strict=True))
