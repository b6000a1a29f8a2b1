"""An axisymmetric finite-element layer, bonded below; mixed Q2/Q1 (Taylor and Hood), so that nu = 1/2 is exact.

Shares nothing with `layer_theory.py` but the rings: a second, independent way to the same compliance.
"""

import numpy as np
from proof.theory.complementarity import lemke
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu


def graded(fine_edges, end, growth=1.15):
    """`fine_edges` continued to `end` with steps that grow."""
    edges, step = list(fine_edges), fine_edges[-1] - fine_edges[-2]
    while edges[-1] < end:
        step *= growth
        edges.append(edges[-1] + step)
    return np.array(edges)


def ring_compliance(edges, shear_modulus, nu, thickness):
    """Mean displacement (mm) of every ring under a unit force (N) on every other, as in `layer_theory`."""
    rings = len(edges) - 1
    return _compliances(edges, shear_modulus, nu, thickness)[rings:, rings:]


def press_by_sphere(radius, depth, edges, layer):
    """Frictionless press of a rigid sphere, its contact held along its own normals where the surface lies once moved.

    `layer` is (G, nu, h); G a number, or a function of distance from the axis and height over the bottom. Small strain,
    but geometry as it is. Returns (force N, contact radius mm).
    """
    rings = len(edges) - 1
    both = _compliances(edges, *layer)
    start = np.stack([np.sqrt((edges[1:] ** 2 + edges[:-1] ** 2) / 2.0), np.zeros(rings)], axis=1)
    center, place, old = np.array([0.0, radius - depth]), start, None
    for _ in range(40):
        offset = place - center
        inward = (
            offset / np.linalg.norm(offset, axis=1)[:, None]
        )  # the sphere's outward normal: the way the skin yields
        inward *= np.sign(-inward[:, 1:])
        along = np.concatenate([np.diag(inward[:, 0]), np.diag(-inward[:, 1])])
        gap = np.linalg.norm(offset, axis=1) - radius - ((place - start) * inward).sum(axis=1)
        force, _ = lemke(along.T @ both @ along, gap)
        moved = both @ along @ force
        place = start + np.stack([moved[:rings], -moved[rings:]], axis=1)
        if old is not None and np.abs(force - old).max() < 1e-7 * force.max():
            break
        old = force
    return float((force * -inward[:, 1]).sum()), float(edges[np.flatnonzero(force > 0.0)[-1] + 1])


def _compliances(edges, shear_modulus, nu, thickness):
    """Mean displacement of every ring, outward then downward, under unit forces on every other in the same order."""
    r_edges = graded(edges, edges[-1] + 7.0 * thickness)
    below = graded([0.0, edges[1] - edges[0]], thickness, 1.2)
    z_edges = thickness - below[::-1] * thickness / below[-1]
    system = _assemble(r_edges, z_edges, shear_modulus, nu)
    ring = _ring_loads(r_edges, z_edges, len(edges) - 1, system.shape[0])
    free = np.setdiff1d(np.arange(system.shape[0]), _held(r_edges, z_edges))
    solved = splu(system[free][:, free].tocsc()).solve(ring[free])
    area = np.tile(np.pi * np.diff(edges**2), 2)
    return ring[free].T @ solved / np.outer(area, area)


def _numbering(r_edges, z_edges):
    """Nodes of the Q2 grid as (2 nr + 1, 2 nz + 1) and of the Q1 grid as (nr + 1, nz + 1)."""
    nr, nz = len(r_edges) - 1, len(z_edges) - 1
    return np.arange((2 * nr + 1) * (2 * nz + 1)).reshape(2 * nr + 1, -1), np.arange((nr + 1) * (nz + 1)).reshape(
        nr + 1, -1
    )


def _held(r_edges, z_edges):
    """Displacement unknowns held at zero: both at the bonded bottom and far edge, the radial one on the axis."""
    node, _ = _numbering(r_edges, z_edges)
    fixed = np.concatenate([node[:, 0], node[-1, :]])
    return np.unique(np.concatenate([2 * fixed, 2 * fixed + 1, 2 * node[0, :]]))


def _ring_loads(r_edges, z_edges, rings, size):
    """Load vectors of a unit outward, then downward traction on each of the first `rings` surface elements."""
    node, _ = _numbering(r_edges, z_edges)
    load = np.zeros((size, 2 * rings))
    point, weight = np.polynomial.legendre.leggauss(3)
    for e in range(rings):
        length = r_edges[e + 1] - r_edges[e]
        r = r_edges[e] + (point + 1.0) * length / 2.0
        nodal = 2.0 * np.pi * (_quadratic(point)[0] * (weight * r * length / 2.0)).sum(axis=1)
        load[2 * node[2 * e : 2 * e + 3, -1], e] = nodal
        load[2 * node[2 * e : 2 * e + 3, -1] + 1, rings + e] = -nodal
    return load


def _quadratic(t):
    """Values and slopes of the three quadratic shape functions on -1..1."""
    return np.array([t * (t - 1) / 2, 1 - t * t, t * (t + 1) / 2]), np.array([t - 0.5, -2 * t, t + 0.5])


def _assemble(r_edges, z_edges, shear_modulus, nu):
    """The symmetric indefinite matrix of (u_r, u_z by node, then pressure by Q1 node)."""
    node, corner = _numbering(r_edges, z_edges)
    point, weight = np.polynomial.legendre.leggauss(3)
    value, slope = _quadratic(point)
    line = np.array([(1 - point) / 2, (1 + point) / 2])
    nr, nz, u_count = len(r_edges) - 1, len(z_edges) - 1, 2 * node.size
    dr, dz = np.diff(r_edges)[:, None], np.diff(z_edges)[None, :]
    shape = (nr, nz)
    block = np.zeros((*shape, 22, 22))
    for a in range(3):
        for b in range(3):
            n = np.einsum("i,j->ij", value[:, a], value[:, b]).ravel()
            n_r = np.einsum("i,j->ij", slope[:, a], value[:, b]).ravel() * (2.0 / dr)[..., None]
            n_z = np.einsum("i,j->ij", value[:, a], slope[:, b]).ravel() * (2.0 / dz)[..., None]
            q = np.einsum("i,j->ij", line[:, a], line[:, b]).ravel()
            r = (r_edges[:-1, None] + (point[a] + 1.0) * dr / 2.0) * np.ones(shape)
            modulus = shear_modulus
            if callable(shear_modulus):
                z = (z_edges[None, :-1] + (point[b] + 1.0) * dz / 2.0) * np.ones(shape)
                modulus = shear_modulus(r, z)
            measure = 2.0 * np.pi * r * weight[a] * weight[b] * dr * dz / 4.0
            strain = np.zeros((*shape, 4, 18))  # rr, zz, hoop, sqrt(2) rz
            strain[..., 0, 0::2] = n_r
            strain[..., 1, 1::2] = n_z
            strain[..., 2, 0::2] = n / r[..., None]
            strain[..., 3, 0::2] = n_z / np.sqrt(2.0)
            strain[..., 3, 1::2] = n_r / np.sqrt(2.0)
            divergence = strain[..., :3, :].sum(axis=-2)
            block[..., :18, :18] += (
                2.0 * (modulus * measure)[..., None, None] * np.einsum("...ai,...aj->...ij", strain, strain)
            )
            mixed = measure[..., None, None] * np.einsum("...i,j->...ij", divergence, q)
            block[..., :18, 18:] -= mixed
            block[..., 18:, :18] -= np.swapaxes(mixed, -1, -2)
            block[..., 18:, 18:] -= (
                (1.0 - 2.0 * nu) / (2.0 * nu) * (measure / modulus)[..., None, None] * np.outer(q, q)
            )
    i, j = np.mgrid[0:nr, 0:nz]
    nodes = np.stack([node[2 * i + p, 2 * j + q] for p in range(3) for q in range(3)], axis=-1)
    unknown = np.concatenate(
        [
            np.stack([2 * nodes, 2 * nodes + 1], -1).reshape(*shape, 18),
            u_count + np.stack([corner[i + p, j + q] for p in range(2) for q in range(2)], -1),
        ],
        axis=-1,
    )
    rows, columns = (
        np.broadcast_to(unknown[..., :, None], block.shape),
        np.broadcast_to(unknown[..., None, :], block.shape),
    )
    size = u_count + corner.size
    return coo_matrix((block.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size)).tocsr()
