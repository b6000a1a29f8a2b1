"""Contact of the axisymmetric pad: a smooth tool by penalty at four points of every surface element, and its grip."""

import numpy as np
from numba import njit

POINTS = np.array([-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526])
WEIGHTS = np.array([0.34785484513745385, 0.6521451548625461, 0.6521451548625461, 0.34785484513745385])

LAST = -1
SOFT = 0.001  # mm of gap over which the penalty sets in, so that no point chatters


@njit(cache=True)
def touch(nodes, contact, now, matrix, right):
    """Adds the tool's push; returns (force along the axis, sum of pushes), N.

    `turn` counts Newton's: in the first, what touched in the last step still does, so that the skin follows a tool that
    moves away. At LAST, `touched` is moved on: what touches now, and (from the fifth column) what ever touched.
    """
    x, touched, depth, turn = now
    curvature, reach = contact[0], contact[3]
    columns, levels = nodes.shape[0], nodes.shape[1]
    block = 3 * levels - 1
    force, pushes = 0.0, 0.0
    for i in range(columns - 1):
        one = i * block + 3 * (levels - 1)
        at = np.array([one, one + 1, one + block, one + block + 1])
        r0, r1 = nodes[i, levels - 1, 0], nodes[i + 1, levels - 1, 0]
        length = np.hypot(r1 - r0, nodes[i + 1, levels - 1, 1] - nodes[i, levels - 1, 1])
        for q in range(4):
            n0, n1 = 0.5 * (1.0 - POINTS[q]), 0.5 * (1.0 + POINTS[q])
            rest = n0 * r0 + n1 * r1
            r = rest + n0 * x[at[0]] + n1 * x[at[2]]
            z = n0 * (nodes[i, levels - 1, 1] + x[at[1]]) + n1 * (nodes[i + 1, levels - 1, 1] + x[at[3]])
            gap, nr, nz, bend = _apart(r, z, depth, curvature)
            if turn == LAST:
                _marks(touched, i, q, gap / reach)
            pull, slope = _pull(gap, contact, turn == 0 and touched[i, q] > 0.0, touched[i, q + 4] > 0.0)
            if pull == 0.0 and slope == 0.0:
                continue
            area = 2.0 * np.pi * rest * WEIGHTS[q] * 0.5 * length
            force += area * pull * nz
            pushes += area * abs(pull)
            _add((area * pull, area * slope, bend), (nr, nz), (n0, n1), at, (matrix, right))
    return force, pushes


@njit(cache=True)
def _marks(touched, i, q, apart):
    """Notes at the end of a step whether a point touches, and whether its grip still spans the gap."""
    touched[i, q] = 1.0 if apart < 0.02 else 0.0
    if apart < 0.0:
        touched[i, q + 4] = 1.0
    elif apart > 8.0:
        touched[i, q + 4] = 0.0


@njit(cache=True)
def _pull(gap, contact, follows, grips):
    """Traction toward the tool (negative: push) and its slope over the gap."""
    _, penalty, grip, reach = contact
    pull, slope = 0.0, 0.0
    if gap < -SOFT or follows:
        pull, slope = penalty * gap, penalty
    elif gap < SOFT:
        pull, slope = -penalty * (gap - SOFT) ** 2 / (4.0 * SOFT), penalty * (SOFT - gap) / (2.0 * SOFT)
    if grip > 0.0 and grips and gap > 0.0:
        share = gap / reach
        pull += grip * share * np.exp(1.0 - share)
        slope += grip / reach * (1.0 - share) * np.exp(1.0 - share)
    return pull, slope


@njit(cache=True)
def _add(law, direction, shares, at, system):
    """Adds a point's pull, along the gap's gradient, to the two nodes beside it."""
    pull, slope, bend = law
    matrix, right = system
    for a in range(4):
        along = direction[a % 2] * shares[a // 2]
        right[at[a]] -= pull * along
        for b in range(4):
            if at[b] >= at[a]:
                same = 1.0 if a % 2 == b % 2 else 0.0
                turned = (same - direction[a % 2] * direction[b % 2]) * shares[a // 2] * shares[b // 2]
                matrix[at[a], at[b] - at[a]] += slope * along * direction[b % 2] * shares[b // 2] + pull * bend * turned


@njit(cache=True)
def _apart(r, z, depth, curvature):
    """Gap (negative inside the tool), the gradient of the gap, and its curvature."""
    if curvature == 0.0:
        return -depth - z, 0.0, -1.0, 0.0
    radius = 1.0 / curvature
    up = z - (radius - depth)
    far = np.hypot(r, up)
    return far - radius, r / far, up / far, 1.0 / far
