"""Colour attributes from the maps, for Solid view and for export; the shader colours by itself."""

import numpy as np

from .. import colormap, maps, names
from . import attributes

SKIN = (0.90, 0.74, 0.65)
"""sRGB of bare skin."""
BARE = (0.84, 0.84, 0.82)
"""sRGB of a bare product."""


def linear(pressure_kpa, look, bare):
    """Scene-linear RGBA (n, 4) float32 of pressures, kPa, over a bare surface colour (sRGB)."""
    return mapped((pressure_kpa, pressure_kpa), maps.scale(maps.MAPS[maps.PRESSURE], look), bare)


def mapped(values, scale, bare):
    """Scene-linear RGBA (n, 4) float32 by a `maps.Scale`; `values`: those of the map, and those that cover (n,)."""
    shown, covering = (np.asarray(part, dtype=np.float64) for part in values)
    cover = colormap.cover(covering / scale.edge)[:, None]
    tinted = colormap.to_linear(colormap.srgb(scale.palette, scale.share(shown)))
    out = np.ones((len(shown), 4), np.float32)
    out[:, :3] = colormap.to_linear(np.array(bare)) * (1.0 - cover) + tinted * cover
    return out


def recolor(mesh, look, bare):
    """Colour the mesh anew from its pressure and from the map that is shown, after a range or the colours changed."""
    pressure = attributes.read(mesh, names.PRESSURE_KPA)
    if pressure is not None:
        attributes.write(mesh, names.COLOR, "FLOAT_COLOR", linear(pressure, look, bare))
    view = maps.shown(look)
    values = [attributes.read(mesh, name) for name in (view.attribute, maps.covering(view))]
    if view.kind == maps.PRESSURE or any(part is None for part in values):
        attributes.remove(mesh, [names.MAP_COLOR])
    else:
        attributes.write(mesh, names.MAP_COLOR, "FLOAT_COLOR", mapped(values, maps.scale(view, look), bare))
    mesh.update()
