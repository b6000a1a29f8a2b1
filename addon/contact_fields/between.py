"""Where a product is finer than the skin that it touches, or passes between its vertices. Knows nothing of Blender.

Distances are asked for at a lattice of points in every triangle near the product. Where they differ from what the
triangle's corners say, the product has a feature that the corners miss.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..results import grades
from ..scene.units import Bools, Floats, Ints
from ..steps import Cancel, Progress

NEAR_MM = 1.0
"""Product up to so far before the skin is close to it."""
BENEATH_MM = 4.0
"""The same behind the skin, within the flesh: a wire may have sunk in between vertices."""
SAMPLES_MM = 0.5
"""Largest step between the points asked for in a triangle, unless that takes more than `MOST_STEPS`."""
MOST_STEPS = 12
FINE = 1.0 / 16.0
"""Error of distances from the corners alone, over the longest edge, from which the product is finer than the skin. On a
round of radius R an edge h errs by h^2 / (8 R), so this holds for edges longer than half the radius."""
MOST_ERROR_MM = grades.CUT_MM
"""Errors beyond this make the product finer than the skin in any case."""
LEAST_ERROR_MM = 0.02
"""Errors up to this are none: the shown skin may lie so deep in the product without a word."""
FEW = 12
"""Vertices that touch in one piece, below which the contact is not resolved there; the library warns below 6."""
PASSES_MM = 0.1
"""A product so near to a point between vertices passes there."""


@dataclass(frozen=True)
class Measured:
    """Skin against a product: `gap_mm` (n,) of vertices, cut off; of every triangle (m,) the least distance of its
    points `nearest_mm`, the largest error of what its corners say of them `error_mm`, and whether it is `close`."""

    gap_mm: Floats
    nearest_mm: Floats
    error_mm: Floats
    close: Bools


@dataclass(frozen=True)
class Posed:
    """A posed skin: `points_mm` (n, 3), `triangles` (m, 3), which vertices are `skin` (n,).

    `asked` (m,): the triangles that are measured.
    """

    points_mm: Floats
    triangles: Ints
    skin: Bools
    asked: Bools


def measure(product: Any, posed: Posed, cancel: Cancel | None = None, progress: Progress | None = None) -> Measured:
    """Measure `posed` against a prepared product (`thenar.Product`). Returns a `Measured`."""
    points, faces = posed.points_mm, posed.triangles
    corners = points[faces]
    longest = longest_mm(corners)
    counts = posed.asked & (posed.skin[faces[:, 0]] | posed.skin[faces[:, 1]] | posed.skin[faces[:, 2]])
    cut_off = BENEATH_MM + 2.0 * float(longest[counts].max(initial=0.0))
    face_normals = _normals(corners)
    gap = np.full(len(points), cut_off)
    used = np.unique(faces[counts])
    if progress is not None:
        progress("measure", 0.0)
    gap[used] = _asked(product, points[used], _at_vertices(face_normals, faces, len(points))[used], cut_off, cancel)[0]
    nearest, error, close = np.full(len(faces), np.inf), np.zeros(len(faces)), np.zeros(len(faces), bool)
    at = np.abs(gap)[faces]
    near = counts & (np.minimum(np.minimum(at[:, 0], at[:, 1]), at[:, 2]) <= BENEATH_MM + longest)
    steps = np.clip(np.ceil(longest / SAMPLES_MM), 2, MOST_STEPS).astype(int)
    for count in np.unique(steps[near]):
        rows = np.flatnonzero(near & (steps == count))
        shares = _lattice(int(count))
        samples = np.einsum("wk,mkx->mwx", shares, corners[rows])
        normals = np.repeat(_normals(corners[rows]), len(shares), axis=0)
        found, is_beneath = _asked(product, samples.reshape(-1, 3), normals, cut_off, cancel)
        found, is_beneath = found.reshape(samples.shape[:2]), is_beneath.reshape(samples.shape[:2])
        nearest[rows] = found.min(axis=1)
        error[rows] = np.abs(found - gap[faces[rows]] @ shares.T).max(axis=1)
        close[rows] = ((found <= NEAR_MM) | is_beneath).any(axis=1)
    return Measured(gap, nearest, error, close)


def coarse(measured: Measured, posed: Posed) -> Bools:
    """Triangles (m,) that are too coarse for what the product has there, or for a contact of few vertices."""
    longest = longest_mm(posed.points_mm[posed.triangles])
    is_fine = measured.error_mm <= np.clip(FINE * longest, LEAST_ERROR_MM, MOST_ERROR_MM)
    few = _in_small_pieces(posed, (measured.gap_mm < 0.0) & posed.skin)
    return measured.close & (~is_fine | few[posed.triangles].any(axis=1))


def passes(product: Any, posed: Posed, cancel: Cancel | None = None, progress: Progress | None = None) -> bool:
    """Whether the product passes through the skin between vertices none of which it touches."""
    measured = measure(product, posed, cancel, progress)
    touches = ((measured.gap_mm <= 0.0) & posed.skin)[posed.triangles].any(axis=1)
    return bool((coarse(measured, posed) & ~touches & (measured.nearest_mm < PASSES_MM)).any())


def edges_mm(corners: Floats) -> Floats:
    """Lengths (m, 3) of the edges of triangles given by their corners (m, 3, 3); edge k leaves corner k."""
    ways = [corners[:, k] - corners[:, (k + 1) % 3] for k in range(3)]
    lengths: Floats = np.sqrt(np.stack([np.einsum("ij,ij->i", way, way) for way in ways], axis=1))
    return lengths


def longest_mm(corners: Floats) -> Floats:
    """Length (m,) of the longest edge of each triangle."""
    lengths = edges_mm(corners)
    longest: Floats = np.maximum(np.maximum(lengths[:, 0], lengths[:, 1]), lengths[:, 2])
    return longest


def _asked(
    product: Any, points: Floats, normals: Floats, cut_off: float, cancel: Cancel | None
) -> tuple[Floats, Bools]:
    """Gap (n,), mm, at most `cut_off`, and whether the product lies close behind the skin at the point."""
    if not len(points):
        return np.zeros(0), np.zeros(0, bool)
    found = product.gap_mm(points, skin_normals=normals, cut_off_mm=cut_off, cancel=cancel)
    gap = np.minimum(np.asarray(found["gap_mm"]), cut_off)
    away = np.nan_to_num(np.asarray(found["closest_mm"]) - points, nan=cut_off)
    distance = np.sqrt(np.einsum("ij,ij->i", away, away))
    beneath = (distance <= BENEATH_MM) & (np.einsum("ij,ij->i", away, normals) < -0.5 * distance)
    return gap, beneath


def _in_small_pieces(posed: Posed, touching: Bools) -> Bools:
    """Of the vertices that touch (n,), those in pieces of fewer than `FEW`."""
    whole = posed.triangles[touching[posed.triangles].sum(axis=1) > 1]
    ends = np.concatenate([whole[:, [0, 1]], whole[:, [1, 2]], whole[:, [2, 0]]])
    ends = ends[touching[ends].all(axis=1)]
    label = np.arange(len(touching))
    while len(ends):
        lowest, after = label[ends].min(axis=1), label.copy()
        for side in (0, 1):
            np.minimum.at(after, ends[:, side], lowest)
        after = after[after]
        if np.array_equal(after, label):
            break
        label = after
    sizes = np.bincount(label[touching], minlength=len(label))
    few: Bools = touching & (sizes[label] < FEW)
    return few


def _lattice(steps: int) -> Floats:
    """Shares (w, 3) of the corners at the points of a lattice in a triangle, its corners included."""
    i, j = np.mgrid[0 : steps + 1, 0 : steps + 1]
    keep = i + j <= steps
    shares: Floats = np.stack([i[keep], j[keep], steps - i[keep] - j[keep]], axis=1) / steps
    return shares


def _normals(corners: Floats) -> Floats:
    return _unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))


def _unit(vectors: Floats) -> Floats:
    lengths = np.sqrt(np.einsum("ij,ij->i", vectors, vectors))
    unit: Floats = vectors / np.maximum(lengths, 1e-30)[:, None]
    return unit


def _at_vertices(face_normals: Floats, faces: Ints, count: int) -> Floats:
    sums = np.zeros((count, 3))
    for axis in range(3):
        sums[:, axis] = np.bincount(faces.ravel(), np.repeat(face_normals[:, axis], 3), minlength=count)
    return _unit(sums)
