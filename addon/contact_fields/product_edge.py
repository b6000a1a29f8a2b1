"""Where contact ends on the product: the skin's own edge, laid onto its vertices. Knows nothing of Blender."""

from collections.abc import Callable
from typing import Any

import numpy as np

from ..scene.units import Bools, Floats, Ints
from .skin_edge import REACH_MM, renumbered, touching

_BAND_MM = 0.7 * REACH_MM
"""Skin up to so far from the edge carries it over; the pressure on a product reaches less far beyond the contact."""
_CELL_MM = 2.5
_AWAY_MM = 1.0
"""Distance of vertices without pressure from the edge, at least: behind a thin wall they are near skin too."""


def signed_distance(
    skin: tuple[Floats, Ints, Floats], product: tuple[Floats, Ints, Floats], surface: Callable[[Floats, Ints], Any]
) -> Floats:
    """Distance (k,) of the product's vertices to the edge of the contact, mm: positive inside, within `REACH_MM`.

    `skin`: points (n, 3), mm, triangles and signed distances (n,); `product`: points (k, 3), triangles and pressure
    (k,), as they stand in the contact; `surface(points, triangles)` answers `gap_mm(points)` as `thenar.Product` does.
    """
    (skin_points, triangles, edge), (points, faces, pressure) = skin, product
    loaded = pressure > 0.0
    out = np.where(loaded, REACH_MM, -REACH_MM)
    carries = touching(triangles, np.abs(edge) < _BAND_MM)
    if not carries.any() or not loaded.any():
        return out
    rows, patch = renumbered(triangles[carries], len(skin_points))
    patch = patch.astype(np.int32)
    asked = loaded.copy()
    asked[faces[touching(faces, loaded)].ravel()] = True
    asked &= _are_near(points, skin_points[rows])
    if not asked.any():
        return out
    found = surface(skin_points[rows], patch).gap_mm(points[asked], cut_off_mm=REACH_MM)
    is_found = found["triangle"] >= 0
    corners = rows[patch[found["triangle"][is_found]]]
    at = np.flatnonzero(asked)[is_found]
    shares = _barycentric(skin_points[corners], found["closest_mm"][is_found])
    out[at] = np.einsum("ij,ij->i", shares, edge[corners])
    out[~loaded] = np.minimum(out[~loaded], -_AWAY_MM)
    distance: Floats = out
    return distance


def _are_near(points: Floats, places: Floats) -> Bools:
    """Whether each of the points lies in a cell of a grid with a place, or next to such a cell."""
    low = places.min(axis=0) - 2.0 * _CELL_MM
    size = np.floor((places.max(axis=0) - low) / _CELL_MM).astype(np.int64) + 3
    is_taken = np.zeros(size, bool)
    is_taken[tuple(np.floor((places - low) / _CELL_MM).astype(np.int64).T)] = True
    for axis in range(3):
        is_taken = is_taken | np.roll(is_taken, 1, axis) | np.roll(is_taken, -1, axis)
    cells = np.floor((points - low) / _CELL_MM).astype(np.int64)
    is_inside = ((cells >= 0) & (cells < size)).all(axis=1)
    near = np.zeros(len(points), bool)
    near[is_inside] = is_taken[tuple(cells[is_inside].T)]
    return near


def _barycentric(corners: Floats, places: Floats) -> Floats:
    """Shares (k, 3) of the corners (k, 3, 3) in places (k, 3) on their triangles."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    way = places - corners[:, 0]
    aa, ab, bb = (np.einsum("ij,ij->i", *pair) for pair in ((a, a), (a, b), (b, b)))
    wa, wb = np.einsum("ij,ij->i", way, a), np.einsum("ij,ij->i", way, b)
    det = np.maximum(aa * bb - ab * ab, 1e-30)
    v, w = np.clip((bb * wa - ab * wb) / det, 0.0, 1.0), np.clip((aa * wb - ab * wa) / det, 0.0, 1.0)
    shares: Floats = np.stack([1.0 - v - w, v, w], axis=1)
    return shares
