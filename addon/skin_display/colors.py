"""Colour attributes from the maps, for Solid view and for export; the shader colours by itself."""

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple, TypeAlias

import bpy
import numpy as np
from bpy.types import Mesh, Object, PropertyGroup

from .. import colormap, maps, names
from ..contact_fields import skin_edge
from ..ownership import owned
from ..scene import attributes, units
from ..scene import mesh as mesh_of
from ..scene.units import Floats, Ints
from . import shading

Color: TypeAlias = tuple[float, float, float]

SKIN: Color = (0.90, 0.74, 0.65)
"""sRGB of bare skin."""
BARE: Color = (0.84, 0.84, 0.82)
"""sRGB of a bare product."""
_SOFT = 1.2
_SOFTEST_MM = 2.5
"""Half of the width over which colours of vertices end a map, in spacings, and at most: from half a spacing on the
middle of the transition follows the edge between vertices, and from one on no sawtooth is seen."""
_SAMPLED = 20_000
"""Edges of a mesh, about, that stand for all in its spacing."""
_STEPS = 31 * 512
"""Of the table of the pressure's colours: between its entries they are off by less than 1e-6 of 1."""


class Ground(NamedTuple):
    """What colours are laid on: the bare surface's own, scene-linear (3) or (n, 3), and its vertices' spacing, mm."""

    color: Floats
    spacing_mm: float

    def at(self, rows: Ints) -> "Ground":
        """The same of some vertices."""
        return self if self.color.ndim == 1 else Ground(self.color[rows], self.spacing_mm)


def ground(obj: Object, color: Color) -> Ground:
    """The `Ground` of a mesh object: its materials' viewport colours, as Solid view shows them; else `color` (sRGB)."""
    mesh = obj.data
    ends = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", ends)
    ends = ends.reshape(-1, 2)[:: max(1, len(ends) // (2 * _SAMPLED))]
    points = mesh_of.positions(mesh)
    lengths = np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1)
    size = abs(np.linalg.det(units.world_from_local(obj)[:3, :3])) ** (1.0 / 3.0)
    spacing = float(np.median(lengths)) if len(lengths) else 0.0
    return Ground(_bare(obj, color), spacing * size * units.mm_per_unit(bpy.context.scene))


def _bare(obj: Object, color: Color) -> Floats:
    plain = colormap.to_linear(color)
    tints = [plain if own is None else np.array(own.diffuse_color[:3]) for own in shading.own_materials(obj)] or [plain]
    if len(tints) == 1:
        return np.asarray(tints[0])
    faces, corners = obj.data.polygons, np.empty(len(obj.data.loops), np.int32)
    chosen, sizes = np.empty(len(faces), np.int32), np.empty(len(faces), np.int32)
    faces.foreach_get("material_index", chosen)
    faces.foreach_get("loop_total", sizes)
    obj.data.loops.foreach_get("vertex_index", corners)
    by_vertex = np.zeros(len(obj.data.vertices), np.int32)
    by_vertex[corners] = np.repeat(np.clip(chosen, 0, len(tints) - 1), sizes)
    return np.asarray(tints)[by_vertex]


def linear(fields: tuple[Floats, Floats | None], look: PropertyGroup, under: Ground) -> Floats:
    """Scene-linear RGBA (n, 4) float32 over a bare surface.

    `fields`: pressure (n,), kPa, and signed distance (n,) to the edge of the contact, mm, or None where not known.
    """
    return by_scale(fields, maps.scale(maps.MAPS[maps.PRESSURE], look), under)


def by_scale(fields: tuple[Floats, Floats | None], scale: maps.Scale, under: Ground) -> Floats:
    """The same by the pressure's `maps.Scale`."""
    pressure_kpa, edge_mm = fields
    table, slopes = _pressure_table(scale.palette)
    place = colormap.within(scale.share(pressure_kpa)) * _STEPS
    low = place.astype(np.intp)
    beyond = (place - low.astype(place.dtype)).astype(np.float32, copy=False)
    tinted = slopes.take(low, axis=0)
    tinted *= beyond.repeat(4).reshape(-1, 4)  # numpy multiplies rows of four by a column at half the speed
    tinted += table.take(low, axis=0)
    faded = pressure_kpa / (colormap.FADE * scale.high)
    cover = colormap.cover(faded) if edge_mm is None else _cover(edge_mm, scale, under)
    return _laid(tinted, cover, under)


@lru_cache(maxsize=4)
def _pressure_table(palette: str) -> tuple[Floats, Floats]:
    """Colours at even steps from no pressure to the top of the range, and how they go on from each: RGBA, float32.

    Live and bakes colour every frame, and looking up takes a third of computing.
    """
    table = _tints(np.linspace(0.0, 1.0, _STEPS + 1), palette)
    return table, np.diff(table, axis=0, append=table[-1:])


def mapped(values: Sequence[Floats], scale: maps.Scale, under: Ground) -> Floats:
    """Scene-linear RGBA (n, 4) float32 by a `maps.Scale`; `values`: those of the map, and those that cover (n,)."""
    shown, covering = (np.asarray(part, dtype=np.float64) for part in values)
    return _laid(_tints(scale.share(shown), scale.palette), _cover(covering, scale, under), under)


def recolor(obj: Object, look: PropertyGroup, color: Color) -> None:
    """Color the object again from its pressure and from the map that is shown, after a range or the colours changed."""
    mesh, under = obj.data, ground(obj, color)
    pressure, changed = attributes.read(mesh, names.PRESSURE_KPA), False
    if pressure is not None:
        changed = _require_edge(obj, pressure)
        edge = attributes.read(mesh, names.EDGE_MM)
        changed |= attributes.settle(mesh, names.COLOR, "FLOAT_COLOR", linear((pressure, edge), look, under))
    changed |= lay_map(mesh, look, under)
    if changed:
        mesh.update()


def lay_map(mesh: Mesh, look: PropertyGroup, under: Ground) -> bool:
    """Color the mesh from the map that is shown, next to the colors of the pressure.

    Returns whether it changed; then `mesh.update()` is due.
    """
    view = maps.shown(look)
    read = (attributes.read(mesh, name) for name in (view.attribute, maps.covering(view)))
    values = [part for part in read if part is not None]
    if view.kind == maps.PRESSURE or len(values) < 2:
        is_there = owned.is_own(mesh, names.MAP_COLOR)
        attributes.remove(mesh, [names.MAP_COLOR])
        return is_there
    laid = mapped(values, maps.scale(view, look), under)
    return attributes.settle(mesh, names.MAP_COLOR, "FLOAT_COLOR", laid)


def _tints(share: Floats, palette: str) -> Floats:
    """The map's own colours, RGBA (n, 4) float32, at shares of its range."""
    out = np.ones((len(share), 4), np.float32)
    out[:, :3] = colormap.to_linear(colormap.channels(palette, share)).T
    return out


def _cover(covering: Floats, scale: maps.Scale, under: Ground) -> Floats:
    """How far the map covers each vertex, 0 to 1."""
    low, high = scale.edge
    if scale.is_distance:
        high = max(high, min(_SOFT * under.spacing_mm, _SOFTEST_MM))
        low = -high
    return colormap.cover((covering - low) / (high - low))


def _laid(tinted: Floats, cover: Floats, under: Ground) -> Floats:
    """`tinted`, which is written to, over the bare surface as far as it covers."""
    rows = np.flatnonzero(cover < 1.0)
    bare = under.at(rows).color.astype(np.float32)
    tinted[rows, :3] = bare + (tinted[rows, :3] - bare) * cover[rows, None].astype(np.float32)
    return tinted


def _require_edge(obj: Object, pressure: Floats) -> bool:
    """Give the mesh the edges that its maps end at, from its pressures alone, where it has none.

    That is so in files and bakes of earlier versions, and after Live with no map shown. Returns whether it wrote.
    """
    wrote = False
    needed = {names.EDGE_MM: pressure, names.REFERENCE_EDGE_MM: attributes.read(obj.data, names.REFERENCE_KPA)}
    for name, values in needed.items():
        if values is not None and attributes.read(obj.data, name) is None:
            scale = units.mm_per_unit(bpy.context.scene)
            points = units.to_world_mm(mesh_of.positions(obj.data), units.world_from_local(obj), scale, np.zeros(3))
            edge = skin_edge.signed_distance(points, mesh_of.triangles(obj.data), values)
            attributes.write(obj.data, name, "FLOAT", edge)
            wrote = True
    depth = attributes.read(obj.data, names.DEPTH_MM)
    if depth is not None and attributes.read(obj.data, names.OVERLAP_MM) is None:
        attributes.write(obj.data, names.OVERLAP_MM, "FLOAT", np.where(depth > 0.0, depth, -skin_edge.REACH_MM))
        wrote = True
    return wrote
