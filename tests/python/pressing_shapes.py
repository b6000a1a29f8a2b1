"""Small meshes for the tests of the native module, made with numpy alone."""

import numpy as np


def sheet(count=21, spacing=1.0, jitter=0.0):
    """A flat skin around the origin at z = 0, facing +z, `count` by `count` vertices; interior jittered, mm."""
    line = (np.arange(count) - (count - 1) / 2) * spacing
    x, y = np.meshgrid(line, line, indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), np.zeros(count * count)])
    inner = np.zeros((count, count), bool)
    inner[1:-1, 1:-1] = True
    shift = np.random.default_rng(7).uniform(-jitter, jitter, (count * count, 2)) * spacing
    vertices[inner.ravel(), :2] += shift[inner.ravel()]
    corner = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    lower = np.column_stack([corner, corner + count, corner + count + 1])
    upper = np.column_stack([corner, corner + count + 1, corner + 1])
    return vertices, np.concatenate([lower, upper]).astype(np.int32)


def ball(radius=10.0, center=(0.0, 0.0, 10.0), rings=16):
    """A closed sphere with outward triangles, mm."""
    polar = np.linspace(0, np.pi, rings + 1)[1:-1]
    around = np.arange(2 * rings) * np.pi / rings
    theta, phi = np.meshgrid(polar, around, indexing="ij")
    points = np.column_stack(
        [(np.sin(theta) * np.cos(phi)).ravel(), (np.sin(theta) * np.sin(phi)).ravel(), np.cos(theta).ravel()]
    )
    points = np.concatenate([[[0, 0, 1]], points, [[0, 0, -1]]])
    number = 1 + np.arange((rings - 1) * 2 * rings).reshape(rings - 1, 2 * rings)
    following = np.roll(number, -1, axis=1)
    last = len(points) - 1
    parts = [
        np.column_stack([np.zeros(2 * rings, int), number[0], following[0]]),
        np.column_stack([number[:-1].ravel(), number[1:].ravel(), following[1:].ravel()]),
        np.column_stack([number[:-1].ravel(), following[1:].ravel(), following[:-1].ravel()]),
        np.column_stack([np.full(2 * rings, last), following[-1], number[-1]]),
    ]
    return points * radius + np.asarray(center), np.concatenate(parts).astype(np.int32)


def vertex_areas(vertices, triangles):
    """A third of every triangle at each of its corners, mm2."""
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    return np.bincount(triangles.ravel(), np.repeat(area / 3, 3), len(vertices))
