"""Signed distances made anew, mm, < 0 inside: closed forms for simple solids, brute force for closed meshes."""

import numpy as np


def to_sphere(points, center, radius):
    """Signed distance to a sphere."""
    return np.linalg.norm(points - np.asarray(center), axis=1) - radius


def to_box(points, low, high):
    """Signed distance to an axis-aligned box."""
    low, high = np.asarray(low), np.asarray(high)
    q = np.abs(points - (low + high) / 2.0) - (high - low) / 2.0
    return np.linalg.norm(np.maximum(q, 0.0), axis=1) + np.minimum(q.max(axis=1), 0.0)


def to_cylinder(points, radius, length):
    """Signed distance to a closed cylinder about z, centered at the origin."""
    q = np.stack([np.hypot(points[:, 0], points[:, 1]) - radius, np.abs(points[:, 2]) - length / 2.0], axis=1)
    return np.linalg.norm(np.maximum(q, 0.0), axis=1) + np.minimum(q.max(axis=1), 0.0)


def to_mesh(points, vertices, triangles):
    """Signed distance to a closed mesh: every triangle for every point, sign by the winding number."""
    return np.concatenate(
        [
            _chunk(part, vertices, triangles)
            for part in np.array_split(points, max(1, len(points) * len(triangles) // 400_000))
        ]
    )


def _chunk(points, vertices, triangles):
    a, b, c = (vertices[triangles[:, k]][None] for k in range(3))
    p = points[:, None, :]
    square = np.minimum(np.minimum(_to_segment(p, a, b), _to_segment(p, b, c)), _to_segment(p, c, a))
    square = np.minimum(square, _to_face(p, a, b, c)).min(axis=1)
    return np.sqrt(square) * np.where(winding(points, vertices, triangles) > 0.5, -1.0, 1.0)


def _to_segment(p, a, b):
    edge = b - a
    length = np.maximum(np.einsum("...i,...i->...", edge, edge), 1e-300)
    t = np.clip(np.einsum("...i,...i->...", p - a, edge) / length, 0.0, 1.0)
    rest = p - a - t[..., None] * edge
    return np.einsum("...i,...i->...", rest, rest)


def _to_face(p, a, b, c):
    """Squared distance to the plane where the foot lies within the triangle, infinite elsewhere."""
    normal = np.cross(b - a, c - a)
    size = np.maximum(np.einsum("...i,...i->...", normal, normal), 1e-300)
    height = np.einsum("...i,...i->...", p - a, normal)
    inside = np.ones(height.shape, bool)
    for start, end in ((a, b), (b, c), (c, a)):
        inside &= (
            np.einsum("...i,...i->...", np.cross(np.broadcast_to(end - start, (p - start).shape), p - start), normal)
            >= 0.0
        )
    return np.where(inside & (size > 1e-200), height**2 / size, np.inf)


def winding(points, vertices, triangles):
    """Winding number (solid angle over 4 pi, van Oosterom & Strackee 1983): 1 inside, 0 outside a closed mesh."""
    a, b, c = (vertices[triangles[:, k]][None] - points[:, None, :] for k in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=-1) for v in (a, b, c))
    top = _dot(a, np.cross(b, c))
    bottom = la * lb * lc + _dot(a, b) * lc + _dot(b, c) * la + _dot(c, a) * lb
    return 2.0 * np.arctan2(top, bottom).sum(axis=1) / (4.0 * np.pi)


def _dot(u, v):
    return np.einsum("...i,...i->...", u, v)
