"""A coarse product cut finer where the hand is, flat, so that its pressure map has places to stand on.

The surface stays where it was: edges are halved, and the triangles at them, so that neighbors keep their common edges.
"""

from dataclasses import replace
from typing import cast

import numpy as np

from ..scene.read import HandReading, ProductReading, Refinement
from ..scene.units import Bools, Floats, Ints

FOR_MAPS = (4.0, 1.5)
"""Product edges longer than so many edges of the hand smear the map, and the library warns from there on; they are
halved down to so many."""
FOR_GRIPS = (1.0, 1.0)
"""The same for a soft grip, whose vertices move."""
REACH_MM = 10.0
"""Surface up to so far from the skin is refined: skin overlaps a product by no more."""
THINNED_MM = 8.0
"""One skin vertex in a cube of this size stands for all of it."""
MOST_LEVELS = 14
MOST_TRIANGLES = 300_000
"""Products are refined up to so many triangles; beyond, the map stays coarse and the library warns."""
_CHUNK = 4_000_000


def refined(product: ProductReading, skin: HandReading, edges: tuple[float, float] = FOR_MAPS) -> ProductReading:
    """`product` refined near `skin`, part by part.

    `edges`: which are too long, and what they are halved to, in edges of the hand.
    """
    spacing = _median_edge(skin)
    near = _thinned(skin.posed_mm[skin.regions >= 0])
    if not np.isfinite(spacing) or spacing <= 0.0 or not len(near) or len(product.triangles) > MOST_TRIANGLES:
        return product
    vertices, triangles, parts, first = [], [], [], 0
    for part in product.parts:
        last = part.first + part.count
        inside = (product.triangles >= part.first).all(axis=1) & (product.triangles < last).all(axis=1)
        points = product.vertices_mm[part.first : last]
        faces = product.triangles[inside] - part.first
        new_points, new_faces, parents = _cut(points, faces, near, (edges[0] * spacing, edges[1] * spacing))
        if parents:
            kept = Refinement(parents, len(points), _vertex_areas(points, faces), _vertex_areas(new_points, new_faces))
            part = replace(part, refinement=kept)
        parts.append(replace(part, first=first, count=len(new_points)))
        vertices.append(new_points)
        triangles.append(new_faces + first)
        first += len(new_points)
    joined = np.concatenate(triangles).astype(np.int32)
    return replace(product, vertices_mm=np.concatenate(vertices), triangles=joined, parts=tuple(parts))


def gathered(pressure: Floats, refinement: Refinement) -> Floats:
    """Pressure (own_count,) on the part's own vertices with the same force as `pressure` on the refined ones."""
    force, last = pressure * refinement.areas_mm2, len(pressure)
    for pair in reversed(refinement.parents):
        added = force[last - len(pair) : last]
        for side in (0, 1):
            np.add.at(force, pair[:, side], 0.5 * added)
        last -= len(pair)
    force, areas = force[: refinement.own_count], refinement.own_areas_mm2
    return np.divide(force, areas, out=np.zeros_like(force), where=areas > 0.0)


def _cut(
    points: Floats, faces: Ints, near: Floats, edges_mm: tuple[float, float]
) -> tuple[Floats, Ints, tuple[Ints, ...]]:
    """Points, faces and parents by level after halving what is too long."""
    levels, (longest, wanted) = [], edges_mm
    for _ in range(MOST_LEVELS):
        ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2)  # (m, 3 edges, 2)
        is_long = np.linalg.norm(points[ends[..., 0]] - points[ends[..., 1]], axis=2) > longest
        pairs = np.sort(ends[is_long], axis=1).astype(np.int64)
        keys, place = np.unique(pairs[:, 0] * len(points) + pairs[:, 1], return_inverse=True)
        parents = np.stack([keys // len(points), keys % len(points)], axis=1)
        is_near = _is_near(points[parents], near)
        if not is_near.any() or len(faces) + 2 * is_near.sum() > MOST_TRIANGLES:
            break
        longest = wanted  # what is coarse anywhere is made fine wherever skin is near
        parents, added = parents[is_near], len(points) + np.cumsum(is_near) - 1
        middle = np.full(faces.shape, -1)
        middle[is_long] = np.where(is_near, added, -1)[place.ravel()]
        points = np.concatenate([points, 0.5 * (points[parents[:, 0]] + points[parents[:, 1]])])
        faces = _split(faces, middle)
        levels.append(parents)
    return points, faces, tuple(levels)


def _split(faces: Ints, middle: Ints) -> Ints:
    """Triangles after edge k of each, from corner k to the next, got the vertex `middle[:, k]`, or -1."""
    count = (middle >= 0).sum(axis=1)
    out = [faces[count == 0]]
    # Turned so that a halved edge comes first, and where two are halved the whole one comes last.
    first = np.where(count == 2, np.argmin(middle >= 0, axis=1) + 1, np.argmax(middle >= 0, axis=1)) % 3
    turn = (first[:, None] + np.arange(3)) % 3
    (a, b, c), (ab, bc, ca) = np.take_along_axis(faces, turn, 1).T, np.take_along_axis(middle, turn, 1).T
    for halved, cut in (
        (1, ((a, ab, c), (ab, b, c))),
        (2, ((ab, b, bc), (a, ab, bc), (a, bc, c))),
        (3, ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))),
    ):
        rows = count == halved
        out += [np.stack(corners, axis=1)[rows] for corners in cut]
    return np.concatenate(out)


def _is_near(ends: Floats, near: Floats) -> Bools:
    """Whether each edge, given by its two ends (k, 2, 3), comes near the skin."""
    middle, half = ends.mean(axis=1), 0.5 * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    reach = REACH_MM + THINNED_MM + half
    low, high = near.min(axis=0), near.max(axis=0)
    is_near: Bools = ((middle >= low - reach[:, None]) & (middle <= high + reach[:, None])).all(axis=1)
    rows = np.flatnonzero(is_near)
    step = max(_CHUNK // len(near), 1)
    for first in range(0, len(rows), step):
        some = rows[first : first + step]
        squared = ((middle[some, None] - near[None]) ** 2).sum(axis=2).min(axis=1)
        is_near[some] = squared <= reach[some] ** 2
    return is_near


def _thinned(points: Floats) -> Floats:
    """One of the points in every cube."""
    _, first = np.unique(np.floor(points / THINNED_MM), axis=0, return_index=True)
    some: Floats = points[np.sort(first)]
    return some


def _median_edge(skin: HandReading) -> float:
    corners = skin.posed_mm[skin.triangles]
    return float(np.median(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)))


def _vertex_areas(points: Floats, faces: Ints) -> Floats:
    """A third of the triangles at each vertex, mm2."""
    a, b, c = points[faces[:, 0]], points[faces[:, 1]], points[faces[:, 2]]
    third = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6.0
    areas = np.bincount(faces.ravel(), np.repeat(third, 3), minlength=len(points))
    return cast(Floats, areas)  # with weights NumPy sums floats, which its types do not know
