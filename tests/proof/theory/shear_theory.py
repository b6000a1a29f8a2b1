"""Shear of a bonded elastic layer from Navier's equations alone: reference for Thenar's friction on a layer.

Must not know of Thenar. The layer is solved through its thickness by collocation, wave number by wave number.
"""

import numpy as np
from scipy.special import j0, jv

LATTICE = 3.9002649200  # -4 zeta(1/2) beta(1/2): a point's own term of a lattice sum of 1/r, over sqrt(area)


def chebyshev(n):
    """Points on [-1, 1], from 1 down, and the matrix that differentiates there (Trefethen 2000)."""
    x = np.cos(np.pi * np.arange(n + 1) / n)
    weight = np.where((np.arange(n + 1) == 0) | (np.arange(n + 1) == n), 2.0, 1.0) * (-1.0) ** np.arange(n + 1)
    away = x[:, None] - x[None]
    matrix = np.outer(weight, 1.0 / weight) / (away + np.eye(n + 1))
    return x, matrix - np.diag(matrix.sum(axis=1))


def transfer(s, nu, n=32):
    """(along, across): k G times the surface's displacement under unit shear along and across the wave, k h = s."""
    _, d = chebyshev(n)
    d, one = d * 2.0 / s, np.eye(n + 1)  # thickness s, k = 1, G = 1; the first point is the surface
    lame = 2.0 * nu / (1.0 - 2.0 * nu)
    dd, size = d @ d, n + 1
    system = np.zeros((2 * size, 2 * size), complex)
    system[:size, :size] = dd - (lame + 2.0) * one
    system[:size, size:] = 1j * (lame + 1.0) * d
    system[size:, :size] = 1j * (lame + 1.0) * d
    system[size:, size:] = (lame + 2.0) * dd - one
    right = np.zeros(2 * size, complex)
    for row, columns in ((0, (d[0], 1j * one[0])), (size, (1j * lame * one[0], (lame + 2.0) * d[0]))):
        system[row] = np.concatenate(columns)
    for row in (n, size + n):
        system[row] = np.eye(2 * size)[row]
    right[0] = 1.0
    along = np.linalg.solve(system, right)[0].real
    anti = dd - one
    anti[0], anti[n] = d[0], one[n]
    return along, np.linalg.solve(anti, np.eye(size)[0])[0]


def kernels(r, shear_modulus, nu, thickness):
    """(M, D) at the distances r: u = [M + D (2 c c' - 1)] q with c the unit chord, mm/N."""
    node, weight = np.polynomial.legendre.leggauss(160)
    s, weight = 9.0 * (node + 1.0), 9.0 * weight
    along, across = np.array([transfer(value, nu) for value in s]).T
    k, weight = s / thickness, weight / thickness
    held = [0.5 * weight * (1.0 - across + sign * (1.0 - nu - along)) for sign in (1.0, -1.0)]
    mean = (1.0 - nu / 2.0) / r - j0(np.multiply.outer(r, k)) @ held[0]
    deviator = nu / 2.0 / r - jv(2, np.multiply.outer(r, k)) @ held[1]
    return mean / (2.0 * np.pi * shear_modulus), deviator / (2.0 * np.pi * shear_modulus)


def stuck_force(points, areas, travel, material):
    """Force (N) along x that moves the surface at the points by `travel` mm along x; `material` is (G, nu, h)."""
    chord = points[:, None] - points[None]
    r = np.linalg.norm(chord, axis=-1)
    # A point's own term is the kernel near zero with 1/r replaced: there D vanishes but for its own 1/r.
    table = np.linspace(1e-3, r.max() * 1.01, 1500)
    mean, deviator = kernels(table, *material)
    smooth = np.array([mean, deviator]) - np.array([1.0 - material[1] / 2.0, material[1] / 2.0])[:, None] / (
        2.0 * np.pi * material[0] * table
    )
    own = np.sqrt(areas) / LATTICE
    far = np.where(r > 0.0, r, 1.0)
    whole = 1.0 / (2.0 * np.pi * material[0] * far)
    m = (1.0 - material[1] / 2.0) * whole + np.interp(r, table, smooth[0])
    dev = np.where(r > 0.0, material[1] / 2.0 * whole + np.interp(r, table, smooth[1]), 0.0)
    i = np.arange(len(points))
    m[i, i] = (1.0 - material[1] / 2.0) / (2.0 * np.pi * material[0] * own) + smooth[0][0]
    cx, cy = chord[..., 0] / far, chord[..., 1] / far
    n = len(points)
    matrix = np.block(
        [[m + dev * (2.0 * cx * cx - 1.0), dev * 2.0 * cx * cy], [dev * 2.0 * cx * cy, m + dev * (2.0 * cy * cy - 1.0)]]
    )
    return np.linalg.solve(matrix, np.concatenate([np.full(n, travel), np.zeros(n)]))[:n].sum()
