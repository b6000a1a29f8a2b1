"""Textbook solvers for s = M f + gap, s >= 0, f >= 0, s f = 0: Lemke's pivoting and projected Gauss-Seidel."""

import numpy as np


class SecondaryRay(Exception):
    """Lemke's path ended on a ray: the solver has no solution to offer."""


class TooManyPivots(Exception):
    """Lemke's path was given up at the pivot limit."""


def lemke(matrix, gap, cover=None, max_pivots=20_000):
    """Solves w = M z + q by Lemke's method (Cottle, Pang & Stone, Algorithm 4.4.5).

    `cover` is the covering vector, ones unless given. The condensed n x (n + 2) tableau is exchanged in place.
    Returns (z, pivots).

    Raises SecondaryRay, TooManyPivots.
    """
    n = len(gap)
    cover = np.ones(n) if cover is None else cover
    if (gap >= 0.0).all():
        return np.zeros(n), 0
    # Row i reads basic_i = constant + sum over columns; columns are z_0 (artificial) and z_1..z_n at first.
    table = np.column_stack([gap, cover, matrix]).astype(float)
    basic, free = np.arange(n), np.concatenate([[2 * n], np.arange(n, 2 * n)])
    row = int(np.argmin(gap / cover))
    column, pivots = 0, 0
    while True:
        _exchange(table, row, column + 1)
        basic[row], free[column] = free[column], basic[row]
        pivots += 1
        left = free[column]
        if left == 2 * n:
            break
        if pivots >= max_pivots:
            raise TooManyPivots
        column = int(np.flatnonzero(free == (left + n if left < n else left - n))[0])
        slope = table[:, column + 1]
        falling = slope < -1e-13 * np.abs(table[:, 1:]).max(axis=1)
        if not falling.any():
            raise SecondaryRay
        ratio = np.where(falling, -table[:, 0] / np.where(falling, slope, 1.0), np.inf)
        best = ratio.min()
        tied = np.flatnonzero(ratio <= best + 1e-14 * (1.0 + abs(best)))
        artificial = tied[basic[tied] == 2 * n]
        row = int(artificial[0]) if len(artificial) else int(tied[np.argmax(-slope[tied])])
    z = np.zeros(2 * n + 1)
    z[basic] = table[:, 0]
    return np.maximum(z[n : 2 * n], 0.0), pivots


def _exchange(table, row, column):
    """Swaps the basic variable of `row` with the free variable of `column` (0 is the constant)."""
    pivot = table[row, column]
    line = -table[row] / pivot
    line[column] = 1.0 / pivot
    old = table[:, column].copy()
    old[row] = 0.0
    table[:, column] = 0.0
    table += old[:, None] * line[None]
    table[row] = line


def projected_gauss_seidel(matrix, gap, tolerance=1e-12, max_sweeps=200_000):
    """The same problem for a symmetric positive definite matrix, one unknown after the other.

    Ends when no force changes by more than `tolerance` times the largest in a sweep. Returns the forces.
    """
    force, slack, diagonal = np.zeros(len(gap)), np.array(gap, float), np.diag(matrix).copy()
    columns = np.ascontiguousarray(matrix.T)
    for _ in range(max_sweeps):
        largest_step = 0.0
        for i in np.flatnonzero((force > 0.0) | (slack < 0.0)):
            step = max(-slack[i] / diagonal[i], -force[i])
            if step != 0.0:
                force[i] += step
                slack += columns[i] * step
                largest_step = max(largest_step, abs(step))
        if largest_step <= tolerance * max(force.max(initial=0.0), 1e-300):
            return force
    raise TooManyPivots


def residual(matrix, gap, force):
    """Largest |min(s, f)| over the largest overlap, forces counted in mm through the diagonal."""
    slack = matrix @ force + gap
    natural = np.abs(np.minimum(slack, force * np.diag(matrix)))
    return float(natural.max() / np.abs(gap[gap < 0.0]).max())
