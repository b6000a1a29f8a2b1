"""The colour maps: 32 stops of each, as a shader's ramp holds them.

Ember begins light, so that a map ends softly on skin: in OKLab (Ottosson 2020) its lightness falls evenly from 0.965 to
0.26, from cream over orange and red to plum, in steps that are alike within 7 %.
Cividis: Nunez, Anderton & Renslow 2018. Viridis, Plasma: van der Walt & Smith 2015 (CC0). Warm to cool: Moreland 2009,
his blue-white-red turned round. Between stops the ramps are at most 5.5 of 255 off the 256-step maps.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from .scene.units import Floats

_STOPS = {
    "EMBER": (
        "f9f4daf6ecc8f3e4b6f0dba4efd292efc881efbe70f0b25ff1a74ff19a3ff08e33ef822aec7624e96a21e65d20e24f23"
        "dc432ad33b33c9333ac02b3fb62343ac1c46a1164a95134f8911527c1055700f56640f54580f514c0f4d410f48370e42"
    ),
    "CIVIDIS": (
        "00224e00285b002e6a0533711c396f293f6e33446d3c4a6c45506c4d556c555b6d5c616e6467706b6d72727274787877"
        "807f78888578908b78979177a09875a89e73b0a571b9ab6dc2b369cbb965d3c05fdcc859e6d051efd748f8df3cfee838"
    ),
    "VIRIDIS": (
        "440154470d6048186a482374472e7c4538824241863e4a893a548c365d8d32658e2e6d8e2b758e287d8e25848e228c8d"
        "1f948c1e9c8920a38625ab822eb37c3aba7648c16e58c7656ccd5a7fd34e93d741a8db34c0df25d5e21aeae51afde725"
    ),
    "PLASMA": (
        "0d08872206903105973f049c4e02a25b01a56700a87401a88104a78d0ba59814a0a21d9aad2793b6308bbf3984c7427c"
        "cf4c74d6556ddd5e66e3685fe97257ef7c51f3874af79143fa9e3bfca934fdb52efdc229fcd025f9dd25f5eb27f0f921"
    ),
    "WARMCOOL": (
        "b40426c0292fcc3f39d65243df634ee67359ed8265f29071f59d7ef7a98bf7b498f6bfa5f3c8b2efcfbee9d6cbe1dbd7"
        "d9dce2d0daeac6d7f1bcd2f7b1ccfba7c4fe9bbcff90b2fe85a8fc799cf86e90f26383eb5976e24e68d8455acd3b4cc0"
    ),
}


def stops(name: str) -> Floats:
    """The map's stops (32, 3), sRGB 0 to 1, from low to high; not to be written to."""
    return _channels(name)[0].T


def srgb(name: str, fraction: Floats) -> Floats:
    """Colours (n, 3), sRGB, at `fraction` (n,) of the range; clipped to its ends."""
    return channels(name, fraction).T


def channels(name: str, fraction: Floats) -> Floats:
    """Red, green and blue (3, n), sRGB, as `srgb` gives them: each in a row, which numpy computes faster."""
    table, steps = _channels(name)
    place = within(fraction) * steps.shape[1]
    low = np.minimum(place.astype(np.intp), steps.shape[1] - 1)
    found: Floats = table.take(low, axis=1) + steps.take(low, axis=1) * (place - low)
    return found


@lru_cache
def _channels(name: str) -> tuple[Floats, Floats]:
    """The map's stops (3, 32), and the steps from each to the next (3, 31)."""
    stored = "WARMCOOL" if name == "COOLWARM" else name
    table = np.frombuffer(bytes.fromhex(_STOPS[stored]), np.uint8).reshape(-1, 3).T / 255.0
    table = np.ascontiguousarray(table[:, ::-1] if name == "COOLWARM" else table)
    steps = np.diff(table)
    table.flags.writeable = steps.flags.writeable = False
    return table, steps


def to_linear(color: ArrayLike) -> Floats:
    """sRGB to scene-linear, by the standard's two branches."""
    encoded = np.asarray(color, dtype=np.float64)
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def cover(share: ArrayLike) -> Floats:
    """How far a map covers the surface (0 to 1) at `share` of its edge, softly."""
    edge = within(np.asarray(share, dtype=np.float64))
    return edge * edge * (3.0 - 2.0 * edge)


def within(share: Floats) -> Floats:
    """`share` clipped to 0 to 1, NaN to 0."""
    return np.minimum(np.fmax(share, 0.0), 1.0)


FADE = 0.06
"""Fraction of the range over which pressure fades in where the edge of the contact is not known."""
