"""How deep the shown skin lies in the product, where, and what would put it out. Knows nothing of Blender.

Of a flat sheet nothing is inside: there, skin that has the sheet close beneath it has come through.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from ..scene.units import Bools, Floats, Ints
from ..steps import Cancel, Progress

TOLERANCE_MM = 0.02
"""How deep shown skin may lie in the product without a word."""
BETWEEN_MM = 0.05
"""The same between vertices, where flat triangles cut into round products."""
_REACH_MM = 4.0
"""Distances beyond this are not asked for."""
_THROUGH_MM = 0.5
"""How far skin is looked for behind a sheet."""
_BENEATH = 0.7
"""Least cosine between the skin's normal and the way back to a sheet."""
_TOUCHING_MM = 0.02
_AROUND_MM = 8.0
"""How near to a place on a sheet skin that touches it tells on which side the flesh is."""
_CHUNK = 20_000
_ROUNDS = 12
"""How often added vertices take the mean of their neighbours."""


@dataclass(frozen=True)
class Surface:
    """The shown skin: `points_mm` (m, 3) about the hand, `triangles` (t, 3), and which vertices `counts` (m,) as skin.

    The first `base_count` points are the vertices of the hand's own mesh. `before`: what was measured of a surface with
    most points in the same places, so that those are not asked for again.
    """

    points_mm: Floats
    triangles: Ints
    counts: Bools
    base_count: int
    before: "Found | None" = None


@dataclass(frozen=True)
class Found:
    """What was measured. `offsets_mm` (m, 3) bring every vertex to where it was measured, and the added ones out.

    `depth_mm` at vertices and `between_mm` at mid points of edges and centres of triangles, with their places (3);
    `vertex` is the nearest one of the hand's own mesh, -1 where nothing is inside.
    """

    depth_mm: float
    place_mm: Floats
    vertex: int
    between_mm: float
    between_place_mm: Floats
    offsets_mm: Floats
    asked: tuple["_Answers", ...] = field(default=(), repr=False, compare=False)
    """What the product answered, at vertices and between them."""


@dataclass(frozen=True)
class _Answers:
    """Gap (n,), mm, infinite where far, and the nearest point of the product (n, 3), for each of `points` (n, 3)."""

    points: Floats
    gap: Floats
    closest: Floats


def measure(
    surface: Surface,
    left_mm: Floats | None,
    place: tuple[Any, Floats],
    cancel: Cancel | None = None,
    progress: Progress | None = None,
) -> Found:
    """Measure the shown skin against a product. Returns a `Found`.

    `place`: the prepared product (`thenar.Product`), and how far it moved (3), mm.
    `left_mm` (n, 3): what the hand's own vertices still have to go, or None; vertices that modifiers added go along.
    """
    product, offset_mm = place
    offsets = np.zeros_like(surface.points_mm) if left_mm is None else spread(surface, left_mm)
    points = surface.points_mm + offsets - offset_mm
    held = np.zeros(len(points), bool)
    held[surface.triangles.ravel()] = True  # loose vertices show nothing
    rows = np.flatnonzero(held & surface.counts)
    triangles = surface.triangles[surface.counts[surface.triangles].all(axis=1)]
    asked = _Asked(product, cancel, progress)
    before = surface.before.asked if surface.before is not None else (None, None)
    at_vertices = asked.at(points[rows], lambda: _normals(points, surface.triangles)[rows], before[0])
    gap, closest = at_vertices.gap, at_vertices.closest
    inside = gap < 0.0
    added = inside & (rows >= surface.base_count)
    offsets[rows[added]] += closest[added] - points[rows[added]]
    near = np.full(len(points), np.inf)
    near[rows] = gap
    samples, faces = _between(points, triangles, near)
    at_samples = asked.at(samples, partial(_face_normals, points, faces), before[1])
    between = at_samples.gap
    worst, deepest = _deepest(gap), _deepest(between)
    here = points[rows[worst]] + offset_mm if worst >= 0 else np.zeros(3)
    there = samples[deepest] + offset_mm if deepest >= 0 else np.zeros(3)
    depth = max(-gap[worst], 0.0) if worst >= 0 else 0.0
    below = max(-between[deepest], 0.0) if deepest >= 0 else 0.0
    return Found(
        depth_mm=float(depth),
        place_mm=here,
        vertex=_nearest(surface, here if depth >= below else there) if max(depth, below) > 0.0 else -1,
        between_mm=float(below),
        between_place_mm=there,
        offsets_mm=offsets,
        asked=(at_vertices, at_samples),
    )


def spread(surface: Surface, left_mm: Floats) -> Floats:
    """Offsets (m, 3) of all vertices from those (n, 3) of the hand's own: again and again their neighbours' mean."""
    count, total = surface.base_count, len(surface.points_mm)
    offsets = np.zeros((total, 3))
    offsets[:count] = left_mm
    if total == count:
        return offsets
    ends = np.concatenate([surface.triangles[:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
    ends = np.concatenate([ends, ends[:, ::-1]])
    ends = ends[ends[:, 0] >= count]
    degree = np.maximum(np.bincount(ends[:, 0], minlength=total), 1)[count:]
    here, there = np.ascontiguousarray(ends.T)
    columns = np.ascontiguousarray(offsets.T)
    for column in columns:
        for _ in range(_ROUNDS):
            column[count:] = np.bincount(here, column[there], minlength=total)[count:] / degree
    return np.ascontiguousarray(columns.T)


class _Asked:
    """Signed distances to a product, in pieces between which Esc is heard."""

    def __init__(self, product: Any, cancel: Cancel | None, progress: Progress | None) -> None:
        self.product = product
        self.is_sheet = np.asarray(product.is_sheet)
        self.hooks = {"cancel": cancel, "progress": None}
        if progress is not None:
            progress("check", 0.0)

    def at(self, points: Floats, normals_of: Callable[[], Floats], before: _Answers | None) -> _Answers:
        """The product's `_Answers`; `normals_of` gives the skin's normals (n, 3), `before` answers of an earlier time.

        Near a sheet an answer depends on all points: there nothing is taken from before.
        """
        if before is None or before.points.shape != points.shape or self.is_sheet.any():
            return _Answers(points, *self._at(points, normals_of))
        gap, closest = before.gap.copy(), before.closest.copy()
        moved = (points != before.points).any(axis=1)
        gap[moved], closest[moved] = self._at(points[moved], normals_of)
        return _Answers(points, gap, closest)

    def _at(self, points: Floats, normals_of: Callable[[], Floats]) -> tuple[Floats, Floats]:
        gap, closest = np.full(len(points), np.inf), np.full((len(points), 3), np.nan)
        on_sheet = np.zeros(len(points), bool)
        for first in range(0, len(points), _CHUNK):
            piece = slice(first, first + _CHUNK)
            found = self.product.gap_mm(points[piece], cut_off_mm=_REACH_MM, **self.hooks)
            gap[piece], closest[piece] = found["gap_mm"], found["closest_mm"]
            on_sheet[piece] = self.is_sheet[found["triangle"]] & (found["triangle"] >= 0)
        if not on_sheet.any():
            return gap, closest
        away, normals = points - closest, normals_of()
        beneath = np.einsum("ij,ij->i", away, normals)
        with np.errstate(invalid="ignore"):
            through = on_sheet & (gap > 0.0) & (gap < _THROUGH_MM) & (beneath > _BENEATH * gap)
            touching = on_sheet & (gap <= _TOUCHING_MM)
        if touching.any():
            # At the rim of a contact the skin is tangent to the sheet: there the flesh of what touches it tells.
            for row in np.flatnonzero(through):
                distance = np.linalg.norm(points[touching] - closest[row], axis=1)
                around = normals[touching][distance < _AROUND_MM]
                through[row] = not len(around) or away[row] @ around.sum(axis=0) > 0.0
        gap[through] *= -1.0
        return gap, closest


def _between(points: Floats, triangles: Ints, gap: Floats) -> tuple[Floats, Ints]:
    """Mid points of edges and centres of the triangles near contact, and the triangle (n, 3) that each belongs to."""
    triangles = triangles[np.isfinite(gap[triangles]).any(axis=1)]
    corners = points[triangles]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1, initial=0.0)
    faces = triangles[gap[triangles].min(axis=1, initial=np.inf) < longest]
    a, b, c = (points[faces[:, corner]] for corner in range(3))
    samples = np.concatenate([(a + b) / 2, (b + c) / 2, (c + a) / 2, (a + b + c) / 3])
    return samples, np.tile(faces, (4, 1))


def _crosses(points: Floats, triangles: Ints) -> Floats:
    a, b, c = (points[triangles[:, corner]] for corner in range(3))
    crosses: Floats = np.cross(b - a, c - a)
    return crosses


def _face_normals(points: Floats, faces: Ints) -> Floats:
    """Normals (n, 3) of triangles (n, 3)."""
    return _unit(_crosses(points, faces))


def _unit(vectors: Floats) -> Floats:
    unit: Floats = vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-30)
    return unit


def _normals(points: Floats, triangles: Ints) -> Floats:
    crosses, sums = _crosses(points, triangles), np.empty_like(points)
    for axis in range(3):
        weights = np.repeat(crosses[:, axis], 3)
        sums[:, axis] = np.bincount(triangles.ravel(), weights, minlength=len(points))
    return _unit(sums)


def _deepest(gap: Floats) -> int:
    return int(gap.argmin()) if len(gap) and np.isfinite(gap.min()) else -1


def _nearest(surface: Surface, place_mm: Floats) -> int:
    away = surface.points_mm[: surface.base_count] - place_mm
    return int(np.einsum("ij,ij->i", away, away).argmin())
