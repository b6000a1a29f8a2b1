"""Meshes the proof presses: flat and graded skins, fingertips, and products of known shape. Lengths in mm.

Must not know of Thenar: every function returns (vertices (n, 3) float64, triangles (m, 3) int32), wound outward.
"""

from itertools import pairwise

import numpy as np
from scipy.spatial import ConvexHull


def flat_patch(half_x, half_y, spacing, jitter=0.15, seed=1):
    """A flat skin facing +z: a triangular lattice, inner vertices moved at random by `jitter` spacings.

    The lattice is also shifted at random, so that nothing ever sits at the origin by construction.
    """
    rng = np.random.default_rng(seed)
    height = spacing * np.sqrt(3.0) / 2.0
    columns, rows = int(np.ceil(half_x / spacing)) + 1, int(np.ceil(half_y / height)) + 1
    j, i = np.mgrid[-rows : rows + 1, -columns : columns + 1]
    x = (i + 0.5 * (j % 2)) * spacing
    shift = (rng.random(2) - 0.5) * spacing
    points = np.stack([x + shift[0], j * height + shift[1], np.zeros_like(x)], axis=-1)
    angle, length = rng.random(i.shape) * 2.0 * np.pi, jitter * spacing * np.sqrt(rng.random(i.shape))
    inner = np.zeros(i.shape, bool)
    inner[1:-1, 1:-1] = True
    points[..., 0] += np.where(inner, length * np.cos(angle), 0.0)
    points[..., 1] += np.where(inner, length * np.sin(angle), 0.0)
    return points.reshape(-1, 3), _lattice_triangles(rows, columns)


def _lattice_triangles(rows, columns):
    """Triangles of the offset lattice, counter-clockwise seen from +z."""
    wide = 2 * columns + 1
    index = np.arange((2 * rows + 1) * wide).reshape(2 * rows + 1, wide)
    out = []
    for row in range(2 * rows):
        a, b = index[row, :-1], index[row, 1:]
        c, d = index[row + 1, :-1], index[row + 1, 1:]
        if (row - rows) % 2 == 0:
            out += [np.stack([a, b, c], 1), np.stack([b, d, c], 1)]
        else:
            out += [np.stack([a, b, d], 1), np.stack([a, d, c], 1)]
    return np.concatenate(out).astype(np.int32)


def disc_patch(radius, spacing, jitter=0.15, seed=1):
    """The part of `flat_patch` within `radius` of the origin."""
    vertices, triangles = flat_patch(radius, radius, spacing, jitter, seed)
    inside = np.hypot(vertices[:, 0], vertices[:, 1]) <= radius
    return keep_triangles(vertices, triangles, inside[triangles].all(axis=1))


def graded_patch(radius, spacing, coarsening, seed=1):
    """A disc whose spacing grows smoothly from `spacing` at the center to `coarsening` times that at the rim."""
    half = radius / (1.0 + (coarsening - 1.0) / 3.0)
    vertices, triangles = disc_patch(half, spacing, 0.15, seed)
    r = np.hypot(vertices[:, 0], vertices[:, 1])
    vertices[:, :2] *= (1.0 + (coarsening - 1.0) / 3.0 * (r / half) ** 2)[:, None]
    return vertices, triangles


def keep_triangles(vertices, triangles, keep):
    """Only the kept triangles and the vertices they use."""
    triangles = triangles[keep]
    used = np.unique(triangles)
    renumber = np.full(len(vertices), -1, np.int64)
    renumber[used] = np.arange(len(used))
    return vertices[used], renumber[triangles].astype(np.int32)


def convex_mesh(points):
    """Triangulated hull of points on a strictly convex surface, wound outward."""
    hull = ConvexHull(points)
    triangles = hull.simplices.astype(np.int32)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0.0
    triangles[inward] = triangles[inward][:, ::-1]
    return points.copy(), triangles


def fibonacci_sphere(count):
    """`count` nearly even points on the unit sphere."""
    k = np.arange(count) + 0.5
    z, angle = 1.0 - 2.0 * k / count, np.pi * (1.0 + np.sqrt(5.0)) * k
    r = np.sqrt(1.0 - z * z)
    return np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=1)


def ellipsoid(semi_axes, count, center=(0.0, 0.0, 0.0)):
    """A closed ellipsoid with `count` nearly even vertices."""
    unit, triangles = convex_mesh(fibonacci_sphere(count))
    return unit * np.asarray(semi_axes) + np.asarray(center), triangles


def sphere(radius, center, fine_radius, fine_spacing):
    """A closed sphere, finely meshed within the arc length `fine_radius` of its lowest point, coarse elsewhere.

    The faces lie inside the sphere by at most fine_spacing^2 / (6 radius) where it is fine.
    """
    flat, _ = disc_patch(fine_radius, fine_spacing, 0.0, 3)
    arc = [np.hypot(flat[:, 0], flat[:, 1])]
    turn = [np.arctan2(flat[:, 1], flat[:, 0])]
    distance, step = fine_radius, fine_spacing
    while distance + 1.2 * step < np.pi * radius - 0.5 * step:
        step = min(1.2 * step, 0.12 * radius)
        distance += step
        count = max(6, int(2.0 * np.pi * radius * np.sin(distance / radius) / step))
        turn.append((np.arange(count) + 0.37 * len(arc)) * 2.0 * np.pi / count)
        arc.append(np.full(count, distance))
    polar, turn = np.concatenate(arc) / radius, np.concatenate(turn)
    unit = np.stack([np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), -np.cos(polar)], axis=1)
    unit, triangles = convex_mesh(np.concatenate([unit, [[0.0, 0.0, 1.0]]]))
    return unit * radius + np.asarray(center), triangles


def revolved(profile, segments, is_loop=False):
    """A surface about z of `profile` (n, 2) in (r, z): from lower to upper axis point, or a counter-clockwise loop."""
    turn = np.arange(segments) * 2.0 * np.pi / segments
    rings, index = [], []
    total = 0
    for r, z in profile:
        if r == 0.0:
            rings.append([[0.0, 0.0, z]])
            index.append(np.full(segments, total))
            total += 1
        else:
            rings.append(np.stack([r * np.cos(turn), r * np.sin(turn), np.full(segments, z)], 1))
            index.append(total + np.arange(segments))
            total += segments
    pairs = list(pairwise(index)) + ([(index[-1], index[0])] if is_loop else [])
    triangles = []
    for low, high in pairs:
        a, b, c, d = low, np.roll(low, -1), high, np.roll(high, -1)
        triangles += [np.stack([a, b, d], 1), np.stack([a, d, c], 1)]
    triangles = np.concatenate(triangles).astype(np.int32)
    distinct = (
        (triangles[:, 0] != triangles[:, 1])
        & (triangles[:, 1] != triangles[:, 2])
        & (triangles[:, 0] != triangles[:, 2])
    )
    return np.concatenate(rings), triangles[distinct]


def cylinder(radius, length, segments, rings=1):
    """A closed cylinder about z, centered at the origin; 2 * segments * (rings + 1) triangles."""
    z = np.linspace(-length / 2.0, length / 2.0, rings + 1)
    profile = [(0.0, z[0])] + [(radius, value) for value in z] + [(0.0, z[-1])]
    return revolved(profile, segments)


def thin_cup(radius, height, wall, segments=96):
    """An open cup about z with a thin wall and floor, its mouth at the top."""
    profile = [(0.0, 0.0), (radius, 0.0), (radius, height), (radius - wall, height), (radius - wall, wall), (0.0, wall)]
    return revolved(np.array(profile), segments)


def box(low, high):
    """A closed box of 12 triangles."""
    low, high = np.asarray(low, float), np.asarray(high, float)
    corner = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return low + corner * (high - low), np.array(triangles, np.int32)


def bumpy_hand(count=9693):
    """A closed, bumpy surrogate of a hand: palm-sized ellipsoid with finger-sized bumps."""
    unit, triangles = convex_mesh(fibonacci_sphere(count))
    bump = 0.06 * np.sin(7.0 * unit[:, 0]) * np.sin(6.0 * unit[:, 1] + 1.0) + 0.03 * np.sin(11.0 * unit[:, 2])
    return unit * np.array([42.0, 90.0, 30.0]) * (1.0 + bump)[:, None], triangles


def rotation(axis, angle):
    """Rotation matrix about `axis` by `angle` in radians."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


def shuffled(vertices, triangles, seed):
    """The same mesh in another vertex and triangle order; also `order`, with new[k] = old[order[k]]."""
    rng = np.random.default_rng(seed)
    order = rng.permutation(len(vertices))
    place = np.empty(len(vertices), np.int64)
    place[order] = np.arange(len(vertices))
    turned = np.stack(
        [np.roll(t, k) for t, k in zip(place[triangles], rng.integers(0, 3, len(triangles)), strict=True)]
    )
    return vertices[order], turned[rng.permutation(len(triangles))].astype(np.int32), order


def joined(*meshes):
    """Several meshes as the parts of one."""
    start = np.cumsum([0] + [len(v) for v, _ in meshes[:-1]])
    return np.concatenate([v for v, _ in meshes]), np.concatenate(
        [t + s for (_, t), s in zip(meshes, start, strict=True)]
    ).astype(np.int32)
