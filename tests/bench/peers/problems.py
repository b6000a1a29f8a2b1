"""The problems of the benchmark: a dense contact problem of the paper's largest region, and a hand on a handle."""

import numpy as np
from proof import meshes
from proof.theory.complementarity import lemke

VERTICES, CONTACTS = 869, 336
SHEAR_MODULUS = 0.03  # MPa
LATTICE = 3.9003  # -4 zeta(1/2) beta(1/2): self term of a point rule on a lattice, over sqrt(area)


def palm():
    """(matrix mm/N, gap mm): a flat patch of 869 vertices under a parabola that leaves 336 of them in contact."""
    vertices, _ = meshes.disc_patch(55.0, 3.0, 0.15, 9)
    vertices = vertices[np.argsort(np.hypot(vertices[:, 0], vertices[:, 1]))[:VERTICES]]
    vertices = vertices[np.random.default_rng(4).permutation(VERTICES)]
    r = np.linalg.norm(vertices[:, None] - vertices[None], axis=-1)
    np.fill_diagonal(r, np.sqrt(9.0 * np.sqrt(3.0) / 2.0) / LATTICE)
    matrix = 1.0 / (4.0 * np.pi * SHEAR_MODULUS * r)
    shape = np.hypot(vertices[:, 0], vertices[:, 1]) ** 2 / 240.0
    low, high = 0.0, 8.0
    while True:
        depth = (low + high) / 2.0
        touching = int((lemke(matrix, shape - depth)[0] > 0.0).sum())
        if touching == CONTACTS or high - low < 1e-6:
            return matrix, shape - depth
        low, high = (depth, high) if touching < CONTACTS else (low, depth)


def handle():
    """A cylinder of 48 mm with 20,200 triangles, about y."""
    vertices, triangles = meshes.cylinder(24.0, 160.0, 100, 100)
    return vertices @ meshes.rotation((1.0, 0.0, 0.0), np.pi / 2.0).T, triangles
