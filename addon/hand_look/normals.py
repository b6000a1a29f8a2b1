"""Normals of a hand's skin from its triangles. Knows nothing of Blender."""

import numpy as np


def vertex_normals(vertices, triangles):
    """Area-weighted unit normals (n, 3), as the triangles turn."""
    out = np.zeros_like(vertices)
    faces = _crosses(vertices, triangles)
    for corner in range(3):
        for axis in range(3):
            out[:, axis] += np.bincount(triangles[:, corner], faces[:, axis], len(vertices))
    return out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-12)


def outward_normals(vertices, triangles):
    """`vertex_normals`, turned so that the enclosed volume is positive: a mirrored mesh is inside out."""
    middle = vertices.mean(axis=0)
    heights = (vertices[triangles[:, 0]] - middle) * _crosses(vertices, triangles)
    normals = vertex_normals(vertices, triangles)
    return normals if heights.sum() >= 0.0 else -normals


def _crosses(vertices, triangles):
    corners = vertices[triangles]
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
