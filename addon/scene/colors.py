"""Colour attributes from the maps, for Solid view and for export; the shader colours by itself."""

from collections.abc import Sequence
from functools import lru_cache
from typing import TypeAlias

import numpy as np
from bpy.types import Mesh, PropertyGroup

from .. import colormap, maps, names
from . import attributes
from .units import Floats

Color: TypeAlias = tuple[float, float, float]

SKIN: Color = (0.90, 0.74, 0.65)
"""sRGB of bare skin."""
BARE: Color = (0.84, 0.84, 0.82)
"""sRGB of a bare product."""


_STEPS = 31 * 512
"""Of the table of the pressure's colours: between its entries they are off by less than 1e-6 of 1."""


def linear(pressure_kpa: Floats, look: PropertyGroup, bare: Color) -> Floats:
    """Scene-linear RGBA (n, 4) float32 of pressures, kPa, over a bare surface colour (sRGB)."""
    return by_scale(pressure_kpa, maps.scale(maps.MAPS[maps.PRESSURE], look), bare)


def by_scale(pressure_kpa: Floats, scale: maps.Scale, bare: Color) -> Floats:
    """The same by the pressure's `maps.Scale`."""
    table, slopes = _pressure_table(scale, bare)
    place = colormap.within(scale.share(pressure_kpa)) * _STEPS
    low = place.astype(np.intp)
    beyond = (place - low.astype(place.dtype)).astype(np.float32, copy=False)
    tinted = slopes.take(low, axis=0)
    tinted *= beyond.repeat(4).reshape(-1, 4)  # numpy multiplies rows of four by a column at half the speed
    tinted += table.take(low, axis=0)
    return tinted


@lru_cache(maxsize=4)
def _pressure_table(scale: maps.Scale, bare: Color) -> tuple[Floats, Floats]:
    """Colours at even steps from no pressure to the top of the range, and how they go on from each: RGBA, float32.

    Live and bakes colour every frame, and looking up takes a third of computing.
    """
    pressure = np.linspace(0.0, scale.high, _STEPS + 1)
    table = mapped((pressure, pressure), scale, bare)
    return table, np.diff(table, axis=0, append=table[-1:])


def mapped(values: Sequence[Floats], scale: maps.Scale, bare: Color) -> Floats:
    """Scene-linear RGBA (n, 4) float32 by a `maps.Scale`; `values`: those of the map, and those that cover (n,)."""
    shown, covering = (np.asarray(part, dtype=np.float64) for part in values)
    cover = colormap.cover(covering / scale.edge)
    tinted = colormap.to_linear(colormap.channels(scale.palette, scale.share(shown)))
    under = colormap.to_linear(bare)[:, None]
    out = np.ones((len(shown), 4), np.float32)
    out[:, :3] = (under + (tinted - under) * cover).T
    return out


def recolor(mesh: Mesh, look: PropertyGroup, bare: Color) -> None:
    """Colour the mesh anew from its pressure and from the map that is shown, after a range or the colours changed."""
    pressure = attributes.read(mesh, names.PRESSURE_KPA)
    if pressure is not None:
        attributes.write(mesh, names.COLOR, "FLOAT_COLOR", linear(pressure, look, bare))
    lay_map(mesh, look, bare)


def lay_map(mesh: Mesh, look: PropertyGroup, bare: Color) -> None:
    """Colour the mesh from the map that is shown, beside the colours of the pressure."""
    view = maps.shown(look)
    read = (attributes.read(mesh, name) for name in (view.attribute, maps.covering(view)))
    values = [part for part in read if part is not None]
    if view.kind == maps.PRESSURE or len(values) < 2:
        attributes.remove(mesh, [names.MAP_COLOR])
    else:
        attributes.write(mesh, names.MAP_COLOR, "FLOAT_COLOR", mapped(values, maps.scale(view, look), bare))
    mesh.update()
