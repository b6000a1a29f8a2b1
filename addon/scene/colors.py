"""Colour attributes from pressure, for Solid view and for export; the shader colours by itself."""

import numpy as np

from .. import colormap, names
from . import attributes

SKIN = (0.90, 0.74, 0.65)
"""sRGB of bare skin."""
BARE = (0.84, 0.84, 0.82)
"""sRGB of a bare product."""


def linear(pressure_kpa, look, bare):
    """Scene-linear RGBA (n, 4) float32 of pressures, kPa, over a bare surface colour (sRGB)."""
    fraction = np.asarray(pressure_kpa, dtype=np.float64) / max(look.range_kpa, 1e-9)
    cover = colormap.cover(fraction)[:, None]
    mapped = colormap.to_linear(colormap.srgb(look.palette, fraction))
    out = np.ones((len(fraction), 4), np.float32)
    out[:, :3] = colormap.to_linear(np.array(bare)) * (1.0 - cover) + mapped * cover
    return out


def recolor(mesh, look, bare):
    """Colour the mesh anew from its pressure, after the range or the colour map changed."""
    pressure = attributes.read(mesh, names.PRESSURE_KPA)
    if pressure is not None:
        attributes.write(mesh, names.COLOR, "FLOAT_COLOR", linear(pressure, look, bare))
        mesh.update()
