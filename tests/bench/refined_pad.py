"""A curved pad at any number of vertices, the same shape each time, and the handle it is pressed on. Lengths in mm."""

import numpy as np
from bench.peers import problems

HALF_AXES_MM = (30.0, 22.0, 12.0)
"""A pad about as large as the ball of a thumb and the palm beside it."""
BUMP_SHARE = 0.015
"""Height of the bumps, in parts of the radius: the pad is nowhere a quadric."""
FREQUENCIES = {10_000: 32, 100_000: 100, 1_000_000: 316}
"""Cuts of an edge of the icosahedron that give about so many vertices: 10 f^2 + 2."""


def pad(vertices):
    """(positions (n, 3), triangles (m, 3)) of the pad with about so many vertices."""
    sphere, triangles = geodesic(FREQUENCIES[vertices])
    x, y, z = sphere.T
    waves = np.sin(5.0 * x + 1.0) * np.sin(4.0 * y) + np.sin(7.0 * z + 3.0 * x)
    return sphere * (1.0 + BUMP_SHARE * waves)[:, None] * HALF_AXES_MM, triangles


def handle(positions, depth_mm):
    """The handle of 48 mm about y, sunk into the top of the pad by `depth_mm`."""
    vertices, triangles = problems.handle()
    under = vertices[:, 2].min()
    # The deepest place lies where the handle's arc and the pad come nearest, straight above one another.
    radius = np.hypot(vertices[:, 0], vertices[:, 2]).max()
    inside = (np.abs(positions[:, 0]) < radius) & (positions[:, 2] > 0.0)
    arc = radius - np.sqrt(radius**2 - positions[inside, 0] ** 2)
    reach = (positions[inside, 2] - arc).max()
    return vertices + np.array([0.0, 0.0, reach - depth_mm - under]), triangles


def geodesic(frequency):
    """The icosahedron with every edge cut in `frequency` parts, blown up to the unit sphere; wound outward."""
    corners, faces = _icosahedron()
    steps = [(i, j) for i in range(frequency + 1) for j in range(frequency + 1 - i)]
    number = {step: k for k, step in enumerate(steps)}
    up = [(number[i, j], number[i + 1, j], number[i, j + 1]) for i, j in steps if i + j < frequency]
    down = [(number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]) for i, j in steps if i + j < frequency - 1]
    local, share = np.array(up + down), np.array(steps) / frequency
    share = np.column_stack([1.0 - share.sum(axis=1), share])
    points = np.concatenate([share @ corners[face] for face in faces])
    triangles = np.concatenate([local + k * len(steps) for k in range(len(faces))])
    _, first, place = np.unique(np.round(points, 9), axis=0, return_index=True, return_inverse=True)
    kept = points[first]
    return kept / np.linalg.norm(kept, axis=1, keepdims=True), place.reshape(-1)[triangles].astype(np.int32)


def _icosahedron():
    ratio = (1.0 + np.sqrt(5.0)) / 2.0
    corners = np.array([(0, s, t * ratio) for s in (-1, 1) for t in (-1, 1)])
    corners = np.concatenate([corners, corners[:, [1, 2, 0]], corners[:, [2, 0, 1]]])
    near = np.isclose(np.linalg.norm(corners[:, None] - corners, axis=-1), 2.0)
    faces = [
        (a, b, c) for a in range(12) for b in range(a) for c in range(b) if near[a, b] and near[b, c] and near[a, c]
    ]
    outward = [f if np.linalg.det(corners[list(f)]) > 0.0 else f[::-1] for f in faces]
    return corners, [list(face) for face in outward]
