"""Where contact ends on the skin: signed distance to the edge by vertex, mm. Knows nothing of Blender.

Near the edge of a smooth contact, pressure falls as the square root of the distance inside, and the gap opens as its
3/2 power outside (Johnson, Contact Mechanics, 4.2 and 5.1). So p^2 and gap^(2/3) are linear in that distance; divided
by their own slopes over the skin they are the distance itself, whatever the moduli.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from ..scene.units import Bools, Floats, Ints

Gaps: TypeAlias = Callable[[Floats], Floats]
"""Gaps (k,), mm, of points (k, 3); infinite or NaN where they are not known."""

REACH_MM = 5.0
"""What stands for all distances beyond, and away from the edge."""
_LEAST = 0.01
"""Least distance of a vertex from the edge, in edges of the mesh: pressed vertices lie inside, all others outside."""
_MOST = 1.5
"""Largest distance, in edges, of a vertex that has a neighbor on the other side."""
_ENCLOSED = (0.3, 0.6)
"""Share of the skin at a vertex that is pressed all over: below the first, its pressures say nothing of their slope and
its free neighbors place the edge; beyond the second, they alone do. Tests pass from (0.2, 0.5) to (0.4, 0.8)."""


@dataclass(frozen=True)
class _Patch:
    """The skin near a contact: `points` (n, 3), `faces` (m, 3), and the `ends` (6 m, 2) of their edges, both ways."""

    points: Floats
    faces: Ints
    ends: Ints
    spacing: Floats
    """(n,), mean length of the edges at each vertex."""


def signed_distance(points: Floats, triangles: Ints, pressure: Floats, gaps: Gaps | None = None) -> Floats:
    """Distance (n,) to the edge of the contact along the skin, mm: positive where it is pressed, within `REACH_MM`.

    `points` (n, 3), mm, of the pressed skin; `gaps` is asked for free vertices near the contact. Without it the
    pressure alone places the edge, less well.
    """
    inside = pressure > 0.0
    out = np.where(inside, REACH_MM, -REACH_MM)
    near = _with_neighbors(triangles, inside)
    if not (near & ~inside).any():
        return out
    band = _with_neighbors(triangles, near)
    faces = triangles[~touching(triangles, ~band)]
    rows, faces = renumbered(faces, len(points))
    here, pressed = points[rows], inside[rows]
    gap = np.full(len(rows), np.nan)
    if gaps is not None:
        gap[~pressed] = gaps(here[~pressed])
    out[rows] = _near_edge(_patch(here, faces), np.where(pressed, pressure[rows], 0.0), gap)
    return out


def _near_edge(patch: _Patch, pressure: Floats, gap: Floats) -> Floats:
    pressed, free = pressure > 0.0, pressure <= 0.0
    touches = _counted(patch, pressed) > 0
    is_rim = np.where(pressed, _counted(patch, free) > 0, touches)
    with np.errstate(invalid="ignore"):
        is_open = free & (gap > 0.0) & (gap < np.inf)
    opened = np.where(is_open, gap, 0.0) ** (2.0 / 3.0)
    outward, _ = _slopes(patch, -opened, is_open)
    inward, share = _slopes(patch, pressure**2, pressed)
    outer = -_over(opened, outward)
    inner = _over(pressure**2, inward)
    has_outer = is_open & np.isfinite(outer)
    low, high = _ENCLOSED
    weight = np.clip((share - low) / (high - low), 0.0, 1.0)
    weight *= weight * (3.0 - 2.0 * weight)
    guess = _continued(patch, outer, outward, has_outer)
    blended = np.where(np.isfinite(inner), weight * inner + (1.0 - weight) * guess, guess)
    found = np.where(np.isfinite(guess), blended, inner)
    has_inner = pressed & np.isfinite(inner)
    fallback = _continued(patch, inner, inward, has_inner)
    found = np.where(pressed, found, np.where(has_outer, outer, fallback))
    side = np.where(pressed, 1.0, -1.0)
    unknown = np.where(is_rim, 0.5 * patch.spacing, REACH_MM)
    size = np.where(np.isfinite(found), side * found, unknown)
    least = np.where(is_rim, _LEAST, 1.0) * patch.spacing
    most = np.where(is_rim, _MOST * patch.spacing, np.maximum(REACH_MM, patch.spacing))
    placed = side * np.clip(size, least, most)
    even = _evened(patch, placed, least)
    # Distances are taken to a polygon inside a round edge; what a second pass would take away again is given back.
    even += even - _evened(patch, even, least)
    distance: Floats = np.clip(side * np.maximum(side * even, least), -REACH_MM, REACH_MM)
    return distance


def _evened(patch: _Patch, values: Floats, least: Floats) -> Floats:
    """`values` made distances to their own zero near it, at `least` so large.

    The two sides were scaled each by its own slope; with this the field is as steep on both, and a line along its zero
    equally wide everywhere.
    """
    distance, side = _to_zero(patch, values), np.sign(values)
    return np.where(np.isfinite(distance), side * np.maximum(distance, least), values)


def _to_zero(patch: _Patch, values: Floats) -> Floats:
    """Distance (n,) of the corners of triangles that the zero of `values` crosses to that zero; infinite elsewhere."""
    nearest = np.full(len(patch.points), np.inf)
    for turn in range(3):
        faces = np.roll(patch.faces, turn, axis=1)
        a, b, c = values[faces].T
        alone = ((a > 0.0) != (b > 0.0)) & ((a > 0.0) != (c > 0.0))
        faces = faces[alone]
        a, b, c = a[alone, None], b[alone, None], c[alone, None]
        p, q, r = (patch.points[faces[:, corner]] for corner in range(3))
        start = p + (q - p) * a / (a - b)
        along = p + (r - p) * a / (a - c) - start
        length = np.maximum(np.einsum("ij,ij->i", along, along), 1e-18)
        for corner, point in enumerate((p, q, r)):
            share = np.clip(np.einsum("ij,ij->i", point - start, along) / length, 0.0, 1.0)
            away = np.linalg.norm(point - start - share[:, None] * along, axis=1)
            np.minimum.at(nearest, faces[:, corner], away)
    return nearest


def renumbered(faces: Ints, count: int) -> tuple[Ints, Ints]:
    """The vertices of `count` that the faces use, in order, and the faces in terms of those."""
    used = np.zeros(count, bool)
    used[faces.ravel()] = True
    place = np.cumsum(used) - 1
    return np.flatnonzero(used), place[faces]


def touching(triangles: Ints, chosen: Bools) -> Bools:
    """Which triangles (m,) have a corner among the `chosen` vertices; by columns, since `any` over rows is slow."""
    a, b, c = (chosen[triangles[:, corner]] for corner in range(3))
    return a | b | c


def _with_neighbors(triangles: Ints, chosen: Bools) -> Bools:
    more: Bools = chosen.copy()
    more[triangles[touching(triangles, chosen)].ravel()] = True
    return more


def _patch(points: Floats, faces: Ints) -> _Patch:
    a, b, c = faces.T
    ends = np.stack([np.concatenate([a, b, c, b, c, a]), np.concatenate([b, c, a, a, b, c])], axis=1)
    lengths = np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1)
    total = np.bincount(ends[:, 0], lengths, minlength=len(points))
    spacing = total / np.maximum(np.bincount(ends[:, 0], minlength=len(points)), 1)
    return _Patch(points, faces, ends, np.maximum(spacing, 1e-9))


def _counted(patch: _Patch, chosen: Bools) -> Ints:
    """How many edges of faces lead from each vertex to one of the `chosen`."""
    counts: Ints = np.bincount(patch.ends[chosen[patch.ends[:, 1]], 0], minlength=len(patch.points))
    return counts


def _slopes(patch: _Patch, values: Floats, among: Bools) -> tuple[Floats, Floats]:
    """Gradient (n, 3) of `values` by vertex of `among`, and the share of its triangles that lie wholly in `among`.

    The mean of those triangles by area; where there is none, the mean of the neighbors' gradients; else NaN.
    """
    a, b, c = (patch.points[patch.faces[:, corner]] for corner in range(3))
    cross = np.cross(b - a, c - a)
    twice = np.linalg.norm(cross, axis=1)
    whole = ~touching(patch.faces, ~among) & (twice > 1e-12)
    faces = patch.faces[whole]
    a, b, c, normal = a[whole], b[whole], c[whole], cross[whole] / twice[whole, None]
    f = values[faces]
    # Gradient of a linear function over the triangle, times twice its area.
    turned = np.cross(normal, f[:, :1] * (c - b) + f[:, 1:2] * (a - c) + f[:, 2:] * (b - a))
    count = len(patch.points)
    sums = np.stack([np.bincount(faces.ravel(), np.repeat(turned[:, k], 3), minlength=count) for k in range(3)], axis=1)
    weight = np.bincount(faces.ravel(), np.repeat(twice[whole], 3), minlength=count)
    around = np.bincount(patch.faces.ravel(), np.repeat(twice, 3), minlength=count)
    with np.errstate(invalid="ignore", divide="ignore"):
        slopes = sums / weight[:, None]
    missing = among & (weight <= 0.0)
    slopes[missing] = _neighbors_mean(patch, slopes, weight > 0.0)[missing]
    return slopes, weight / np.maximum(around, 1e-30)


def _over(values: Floats, slopes: Floats) -> Floats:
    """`values` over the steepness of their slopes; NaN where there is none."""
    steep = np.linalg.norm(slopes, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(steep > 0.0, values / steep, np.nan)


def _continued(patch: _Patch, distance: Floats, slopes: Floats, known: Bools) -> Floats:
    """Distance at each vertex as its `known` neighbors continue theirs along their slopes, in the mean; else NaN."""
    ends = patch.ends[known[patch.ends[:, 1]]]
    here, there = ends[:, 0], ends[:, 1]
    unit = slopes[there] / np.linalg.norm(slopes[there], axis=1, keepdims=True)
    guess = distance[there] + np.einsum("ij,ij->i", unit, patch.points[here] - patch.points[there])
    count = len(patch.points)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean: Floats = np.bincount(here, guess, minlength=count) / np.bincount(here, minlength=count)
    return mean


def _neighbors_mean(patch: _Patch, vectors: Floats, known: Bools) -> Floats:
    ends = patch.ends[known[patch.ends[:, 1]]]
    counts = np.bincount(ends[:, 0], minlength=len(patch.points))
    sums = [np.bincount(ends[:, 0], vectors[ends[:, 1], k], minlength=len(patch.points)) for k in range(3)]
    with np.errstate(invalid="ignore", divide="ignore"):
        mean: Floats = np.stack(sums, axis=1) / counts[:, None]
    return mean
