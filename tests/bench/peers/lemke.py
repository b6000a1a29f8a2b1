"""A textbook Lemke: the condensed n x (n + 2) tableau, one rank-one update a pivot, compiled by numba."""

import numpy as np

try:
    from numba import njit
except ImportError:  # Plain numpy is the fallback; the table says which ran.
    njit = None

SOLVED, RAY, LIMIT = 0, 1, 2


def name():
    """What the table calls it."""
    return "textbook Lemke (numba)" if njit else "textbook Lemke (numpy)"


def _pivot(table, row, column):
    """Exchanges the basic variable of `row` and the free one of `column`."""
    inverse = -1.0 / table[row, column]
    width = table.shape[1]
    for j in range(width):
        table[row, j] *= inverse
    table[row, column] = -inverse
    for i in range(table.shape[0]):
        if i != row:
            factor = table[i, column]
            if factor != 0.0:
                table[i, column] = 0.0
                for j in range(width):
                    table[i, j] += factor * table[row, j]


def _pivot_numpy(table, row, column):
    inverse = -1.0 / table[row, column]
    table[row] *= inverse
    table[row, column] = -inverse
    factor = table[:, column].copy()
    factor[row] = 0.0
    table[:, column] *= 0.0
    table[row, column] = -inverse
    table += factor[:, None] * table[row]


def _leaving(table, column):
    """The row that blocks first, ties to the largest pivot; -1 on a ray."""
    best, row = np.inf, -1
    for i in range(table.shape[0]):
        slope = table[i, column]
        if slope < -1e-12:
            ratio = -table[i, 0] / slope
            if ratio < best or (ratio == best and slope < table[row, column]):
                best, row = ratio, i
    return row


if njit:
    _pivot = njit(fastmath=True)(_pivot)
    _leaving = njit(_leaving)
else:
    _pivot = _pivot_numpy


def solve(matrix, gap):
    """Forces z with w = M z + q, w >= 0, z >= 0, w z = 0. Raises ArithmeticError on a ray."""
    n = len(gap)
    table = np.column_stack([gap, np.ones(n), matrix])
    basic, free = list(range(n)), [2 * n, *range(n, 2 * n)]
    place = {variable: k for k, variable in enumerate(free)}
    row, column = int(np.argmin(gap)), 0
    while gap.min() < 0.0:
        _pivot(table, row, column + 1)
        left, entered = basic[row], free[column]
        basic[row], free[column], place[left] = entered, left, column
        if left == 2 * n:
            break
        column = place[left + n if left < n else left - n]
        row = _leaving(table, column + 1)
        if row < 0:
            raise ArithmeticError("the textbook Lemke ended on a ray")
    z = np.zeros(2 * n + 1)
    z[basic] = table[:, 0]
    return z[n : 2 * n]
