"""Which edges of a skin to halve and how to cut the triangles at them, level by level. Arrays alone, no Blender.

Edges are halved, and the triangles at them cut to fit, so that neighbors keep common edges. Vertices that lie at one
place, as along a seam of doubled vertices, are halved alike, so that no crack opens.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..contact_fields import between
from ..scene.checks import Refusal

LEAST_MM = 0.25
"""No edge is made shorter: skin ridges are about 0.5 mm apart, and the model knows none."""
MOST_VERTICES = 60_000
"""A hand is refined up to so many vertices."""
HALVES = 0.75
"""Edges longer than this share of the median edge are halved by one press, to about half the spacing on average."""
MOST_LEVELS = 8


@dataclass(frozen=True)
class Mesh:
    """The hand: `posed_mm` (n, 3), `triangles` (m, 3), the polygon `owner` (m,) of each, `regions` (n,).

    `is_triangle`: of every polygon; `place` (n,): a number that vertices at one place at rest share.
    """

    posed_mm: np.ndarray
    triangles: np.ndarray
    owner: np.ndarray
    is_triangle: np.ndarray
    regions: np.ndarray
    place: np.ndarray


@dataclass(frozen=True)
class Level:
    """One round: `first` (c, 2) cuts polygons into their triangles; then the edges `parents` (k, 2) are halved.

    The new vertices are numbered on and take after their `ends` (k,); last `cuts` (d, 2) join vertices across faces.
    """

    first: np.ndarray
    parents: np.ndarray
    ends: np.ndarray
    cuts: np.ndarray


@dataclass(frozen=True)
class Plan:
    """The `levels`, and the median edge near the product before and after, mm."""

    levels: tuple
    before_mm: float
    after_mm: float


def plan(mesh, product, asked, cancel=None, progress=None):
    """The `Plan` that refines `mesh` where `product` (`thenar.Product`) needs it.

    `asked`: names of hand and product, for sentences, and the longest edge near the product, mm, or 0 to halve the
    spacing where the product is finer than the skin. Raises `Refusal` where there is nothing to refine, or too much.
    """
    names, spacing_mm = asked
    levels, count, before, wanted = [], len(mesh.posed_mm), 0.0, spacing_mm
    reached = np.ones(count, bool)
    for level in range(MOST_LEVELS):
        posed = between.Posed(mesh.posed_mm, mesh.triangles, mesh.regions >= 0, _of(reached, mesh.triangles))
        measured = between.measure(product, posed, cancel, progress)
        chosen = measured.close if spacing_mm > 0.0 else between.coarse(measured, posed)
        lengths = between.edges_mm(mesh.posed_mm[mesh.triangles])
        if level == 0:
            _check(measured, chosen, names)
            before = float(np.median(lengths[chosen]))
            if spacing_mm == 0.0:
                wanted = HALVES * before
        grown = _grown(mesh, chosen)
        is_long = (lengths > max(wanted, 2.0 * LEAST_MM)) & grown[:, None]
        if not is_long.any():
            break
        reached = np.zeros(len(mesh.posed_mm), bool)
        reached[mesh.triangles[grown]] = True
        mesh, made = _halved(mesh, is_long, names)
        reached = np.concatenate([reached, np.ones(len(made.parents), bool)])
        levels.append(made)
    if not levels:
        raise Refusal(
            f"the skin of {names[0]} is as fine as may be where {names[1]} is close, with edges of {before:.2f} mm: "
            f"none is made shorter than {LEAST_MM:g} mm, or than the Spacing; solve it as it is"
        )
    after = between.edges_mm(mesh.posed_mm[mesh.triangles[(mesh.triangles >= count).any(axis=1)]])
    return Plan(tuple(levels), before, float(np.median(after)))


def _check(measured, chosen, names):
    if chosen.any():
        return
    if not measured.close.any():
        raise Refusal(
            f"no skin of {names[0]} comes within {between.NEAR_MM:g} mm of {names[1]}, so nothing was refined; "
            "move hand and product together first"
        )
    raise Refusal(
        f"the skin of {names[0]} is already as fine as {names[1]} needs where they are close; "
        "give a Spacing to refine it all the same"
    )


def _of(chosen, triangles):
    """Which triangles have all their corners among the vertices `chosen` (n,)."""
    return chosen[triangles[:, 0]] & chosen[triangles[:, 1]] & chosen[triangles[:, 2]]


def _grown(mesh, chosen):
    """The chosen triangles and those that share a vertex with them, doubled vertices taken as one."""
    at = np.zeros(mesh.place.max() + 1, bool)
    at[mesh.place[mesh.triangles[chosen]]] = True
    a, b, c = at[mesh.place][mesh.triangles].T
    return a | b | c


def _halved(mesh, is_long, names):
    """`mesh` with the edges `is_long` (m, 3) and their doubles halved, and the `Level` that does it."""
    count = len(mesh.posed_mm)
    ends = np.stack([mesh.triangles, np.roll(mesh.triangles, -1, axis=1)], axis=2).astype(np.int64)
    ends.sort(axis=2)
    width = int(mesh.place.max()) + 1
    at = np.sort(mesh.place[ends], axis=2)
    places = at[..., 0] * width + at[..., 1]
    halves = np.isin(places, np.unique(places[is_long]))
    keys, first, index = np.unique(
        (ends[..., 0] * count + ends[..., 1])[halves], return_index=True, return_inverse=True
    )
    parents = np.stack([keys // count, keys % count], axis=1)
    if count + len(parents) > MOST_VERTICES:
        raise Refusal(
            f"{names[0]} would have {count + len(parents):,} vertices, more than the {MOST_VERTICES:,} allowed; "
            "give a larger Spacing, or move hand and product so that less skin is close"
        )
    middle = np.full(mesh.triangles.shape, -1)
    middle[halves] = count + index.ravel()
    new_places = width + np.unique(places[halves][first], return_inverse=True)[1].ravel()
    takes_after = _ends(mesh.regions, parents)
    points = np.concatenate([mesh.posed_mm, 0.5 * (mesh.posed_mm[parents[:, 0]] + mesh.posed_mm[parents[:, 1]])])
    opened, is_triangle = _opened(mesh, middle)
    triangles, owner, cuts = _cut(points, (mesh.triangles, mesh.owner), middle)
    made = replace(
        mesh,
        posed_mm=points,
        triangles=triangles,
        owner=owner,
        is_triangle=is_triangle,
        regions=np.concatenate([mesh.regions, mesh.regions[takes_after]]),
        place=np.concatenate([mesh.place, new_places]),
    )
    return made, Level(opened, parents, takes_after, cuts)


def _ends(regions, parents):
    """The end (k,) after which the vertex between two `parents` (k, 2) takes: the older, which has the lower number.

    So a border between regions moves by no more than a quarter of an edge across it, to either side.
    """
    return parents[:, 0]


def _opened(mesh, middle):
    """Diagonals (c, 2) of the polygons that are cut for the first time, and which polygons are triangles then."""
    is_triangle = mesh.is_triangle.copy()
    polygons = np.unique(mesh.owner[(middle >= 0).any(axis=1)])
    polygons = polygons[~is_triangle[polygons]]
    is_triangle[polygons] = True
    rows = np.flatnonzero(np.isin(mesh.owner, polygons))
    ends = np.stack([mesh.triangles[rows], np.roll(mesh.triangles[rows], -1, axis=1)], axis=2).astype(np.int64)
    sides = np.concatenate([np.repeat(mesh.owner[rows], 3)[:, None], np.sort(ends.reshape(-1, 2), axis=1)], axis=1)
    unique, uses = np.unique(sides, axis=0, return_counts=True)
    return unique[uses == 2][:, 1:], is_triangle


def _cut(points, faces, middle):
    """(triangles, owner, cuts) after edge k of each triangle, from corner k, got the vertex `middle[:, k]`, or -1."""
    triangles, owner = faces
    count = (middle >= 0).sum(axis=1)
    # Turned so that a halved edge comes first, and where two are halved the whole one comes last.
    first = np.where(count == 2, np.argmin(middle >= 0, axis=1) + 1, np.argmax(middle >= 0, axis=1)) % 3
    turn = (first[:, None] + np.arange(3)) % 3
    (a, b, c), (ab, bc, ca) = np.take_along_axis(triangles, turn, 1).T, np.take_along_axis(middle, turn, 1).T
    is_shorter = np.linalg.norm(points[a] - points[bc], axis=1) <= np.linalg.norm(points[ab] - points[c], axis=1)
    out, owners, cuts = [triangles[count == 0]], [owner[count == 0]], []
    for rows, faces_made, joined in (
        (count == 1, ((a, ab, c), (ab, b, c)), ((ab, c),)),
        ((count == 2) & is_shorter, ((ab, b, bc), (a, ab, bc), (a, bc, c)), ((ab, bc), (a, bc))),
        ((count == 2) & ~is_shorter, ((ab, b, bc), (a, ab, c), (ab, bc, c)), ((ab, bc), (ab, c))),
        (count == 3, ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)), ((ab, bc), (bc, ca), (ca, ab))),
    ):
        out += [np.stack(corners, axis=1)[rows] for corners in faces_made]
        owners += [owner[rows]] * len(faces_made)
        cuts += [np.stack(pair, axis=1)[rows] for pair in joined]
    return np.concatenate(out), np.concatenate(owners), np.concatenate(cuts)
