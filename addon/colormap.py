"""The colour maps of the pressure: 32 stops of each, as a shader's ramp holds them.

Cividis: Nunez, Anderton & Renslow 2018. Viridis: van der Walt & Smith 2015 (CC0). Between stops the ramps are at
most 5.5 of 255 off the 256-step maps.
"""

import numpy as np

_STOPS = {
    "CIVIDIS": (
        "00224e00285b002e6a0533711c396f293f6e33446d3c4a6c45506c4d556c555b6d5c616e6467706b6d72727274787877"
        "807f78888578908b78979177a09875a89e73b0a571b9ab6dc2b369cbb965d3c05fdcc859e6d051efd748f8df3cfee838"
    ),
    "VIRIDIS": (
        "440154470d6048186a482374472e7c4538824241863e4a893a548c365d8d32658e2e6d8e2b758e287d8e25848e228c8d"
        "1f948c1e9c8920a38625ab822eb37c3aba7648c16e58c7656ccd5a7fd34e93d741a8db34c0df25d5e21aeae51afde725"
    ),
}


def stops(name):
    """The map's stops (32, 3), sRGB 0 to 1, from low to high."""
    return np.frombuffer(bytes.fromhex(_STOPS[name]), np.uint8).reshape(-1, 3) / 255.0


def srgb(name, fraction):
    """Colours (n, 3), sRGB, at `fraction` (n,) of the range; clipped to its ends."""
    table = stops(name)
    place = np.clip(np.nan_to_num(fraction), 0.0, 1.0) * (len(table) - 1)
    low = np.minimum(place.astype(np.intp), len(table) - 2)
    part = (place - low)[..., None]
    return table[low] * (1.0 - part) + table[low + 1] * part


def to_linear(color):
    """sRGB to scene-linear, by the standard's two branches."""
    color = np.asarray(color, dtype=np.float64)
    return np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4)


def cover(fraction):
    """How far pressure covers the surface (0 to 1) at `fraction` of the range: a soft edge where contact begins."""
    edge = np.clip(np.asarray(fraction, dtype=np.float64) / EDGE, 0.0, 1.0)
    return edge * edge * (3.0 - 2.0 * edge)


EDGE = 0.06
"""Fraction of the range over which the colour fades in."""
