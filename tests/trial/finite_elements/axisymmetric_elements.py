"""Stiffness, residual and history of the axisymmetric pad's elements."""

import numpy as np
from numba import njit

BRANCHES, SLIDERS = 5, 3
STATE = 4 + 4 * BRANCHES + 4 * SLIDERS + 2  # last isochoric stress, overstresses, friction, energy, energy spent
GAUSS = 0.5773502691896258


@njit(cache=True)
def elements(nodes, shear, tissue, now, system):
    """Adds every element at `x`, a step of `step_s` after the state; with `keeps` 1 the state is moved on instead."""
    x, state, content, step_s, keeps = now
    matrix, right = system
    bulk_ratio, permeability = tissue[0][1], tissue[0][3]
    columns, levels = nodes.shape[0], nodes.shape[1]
    block = 3 * levels - 1
    at = np.zeros(9, dtype=np.int64)
    place, moved = np.zeros((4, 2)), np.zeros((4, 2))
    stiff, load = np.zeros((9, 9)), np.zeros(9)
    for i in range(columns - 1):
        for j in range(levels - 1):
            g = shear[i, j]
            for k in range(4):
                ci, cj = i + (k == 1 or k == 2), j + (k >= 2)
                for a in range(2):
                    at[2 * k + a] = ci * block + 3 * cj + a
                    place[k, a] = nodes[ci, cj, a]
                    moved[k, a] = x[at[2 * k + a]]
            at[8] = i * block + 3 * j + 2
            stiff[:] = 0.0
            load[:] = 0.0
            volume = _element(place, moved, (x[at[8]], g, step_s, keeps), (tissue, state[i, j]), (stiff, load))
            bulk = bulk_ratio * g
            water = load[8] - x[at[8]] * volume / bulk
            if keeps == 1:
                content[i, j] = water
                continue
            load[8] = water
            stiff[8, 8] = -volume / bulk
            if permeability > 0.0:
                load[8] -= content[i, j]
                _flow((i, j, at[8]), nodes, x, permeability * step_s, (stiff, load, matrix))
            for a in range(9):
                right[at[a]] -= load[a]
                for b in range(9):
                    if at[b] >= at[a]:
                        matrix[at[a], at[b] - at[a]] += stiff[a, b]


@njit(cache=True)
def _flow(where, nodes, x, rate, into):
    """Darcy's flow to the neighbors; the far edge is open, bone and skin are closed."""
    i, j, at = where
    stiff, load, matrix = into
    columns, levels = nodes.shape[0], nodes.shape[1]
    block = 3 * levels - 1
    width = nodes[i + 1, j, 0] - nodes[i, j, 0]
    height = nodes[i, j + 1, 1] - nodes[i, j, 1]
    ring = np.pi * (nodes[i + 1, j, 0] ** 2 - nodes[i, j, 0] ** 2)
    for side in range(4):
        if side == 0 and i > 0:
            other = at - block
            width_there = nodes[i, j, 0] - nodes[i - 1, j, 0]
            share = 2.0 * np.pi * nodes[i, j, 0] * height / (0.5 * (width + width_there))
        elif side == 1:
            share = 2.0 * np.pi * nodes[i + 1, j, 0] * height
            if i == columns - 2:
                load[8] -= rate * share / (0.5 * width) * x[at]
                stiff[8, 8] -= rate * share / (0.5 * width)
                continue
            other = at + block
            share /= 0.5 * (width + nodes[i + 2, j, 0] - nodes[i + 1, j, 0])
        elif side == 2 and j > 0:
            other = at - 3
            share = ring / (0.5 * (height + nodes[i, j, 1] - nodes[i, j - 1, 1]))
        elif side == 3 and j < levels - 2:
            other = at + 3
            share = ring / (0.5 * (height + nodes[i, j + 2, 1] - nodes[i, j + 1, 1]))
        else:
            continue
        load[8] -= rate * share * (x[at] - x[other])
        stiff[8, 8] -= rate * share
        if other > at:
            matrix[at, other - at] += rate * share


@njit(cache=True)
def _element(place, moved, at_step, made_of, sums):
    """One element; `load[8]` becomes the growth of its volume. Returns its volume at rest."""
    pressure, g, step_s, keeps = at_step
    tissue, states = made_of
    stiff, load = sums
    volume = 0.0
    slope, value = np.zeros((4, 2)), np.zeros(4)
    bee, tangent, stress, inverse = np.zeros((4, 8)), np.zeros((4, 4)), np.zeros(4), np.zeros(4)
    for q in range(4):
        s, t = (-GAUSS if q in (0, 3) else GAUSS), (-GAUSS if q < 2 else GAUSS)
        measure, r = _shapes(place, s, t, slope, value)
        f = np.array([1.0, 0.0, 0.0, 1.0, 1.0])  # rr, rz, zr, zz, around
        for k in range(4):
            f[0] += slope[k, 0] * moved[k, 0]
            f[1] += slope[k, 1] * moved[k, 0]
            f[2] += slope[k, 0] * moved[k, 1]
            f[3] += slope[k, 1] * moved[k, 1]
            f[4] += value[k] * moved[k, 0] / r
        c = np.array([f[0] ** 2 + f[2] ** 2, f[1] ** 2 + f[3] ** 2, f[4] ** 2, f[0] * f[1] + f[2] * f[3]])
        j = (f[0] * f[3] - f[1] * f[2]) * f[4]
        plane = c[0] * c[1] - c[3] ** 2
        inverse[0], inverse[1], inverse[2], inverse[3] = c[1] / plane, c[0] / plane, 1.0 / c[2], -c[3] / plane
        _law((c, inverse, j), (pressure, g, step_s, keeps), (tissue, states[q]), stress, tangent)
        volume += measure
        load[8] += (j - 1.0) * measure
        if keeps == 1:
            continue
        _strains(f, slope, value, r, bee)
        _sum((bee, slope, value, r), (stress, tangent, inverse), (measure, measure * j), sums)
    return volume


@njit(cache=True)
def _strains(f, slope, value, r, bee):
    """Fills the changes of Green's strain (rr, zz, around, twice rz) by each displacement."""
    for k in range(4):
        n, m = slope[k, 0], slope[k, 1]
        bee[0, 2 * k], bee[0, 2 * k + 1] = f[0] * n, f[2] * n
        bee[1, 2 * k], bee[1, 2 * k + 1] = f[1] * m, f[3] * m
        bee[2, 2 * k], bee[2, 2 * k + 1] = f[4] * value[k] / r, 0.0
        bee[3, 2 * k], bee[3, 2 * k + 1] = f[0] * m + f[1] * n, f[3] * n + f[2] * m


@njit(cache=True)
def _sum(shapes, law, measures, sums):
    """Adds a point's residual and stiffness."""
    bee, slope, value, r = shapes
    stress, tangent, inverse = law
    measure, grown = measures
    stiff, load = sums
    for a in range(8):
        swell = 0.0
        row = np.zeros(4)
        for u in range(4):
            load[a] += measure * bee[u, a] * stress[u]
            swell += bee[u, a] * inverse[u]
            for v in range(4):
                row[v] += bee[u, a] * tangent[u, v]
        stiff[a, 8] += grown * swell
        stiff[8, a] += grown * swell
        for b in range(8):
            entry = row[0] * bee[0, b] + row[1] * bee[1, b] + row[2] * bee[2, b] + row[3] * bee[3, b]
            stiff[a, b] += measure * entry
    for k in range(4):
        for m in range(4):
            entry = slope[k, 0] * (stress[0] * slope[m, 0] + stress[3] * slope[m, 1])
            entry += slope[k, 1] * (stress[3] * slope[m, 0] + stress[1] * slope[m, 1])
            stiff[2 * k + 1, 2 * m + 1] += measure * entry
            stiff[2 * k, 2 * m] += measure * (entry + stress[2] * value[k] * value[m] / r**2)


@njit(cache=True)
def _shapes(place, s, t, slope, value):
    """Fills the shape functions' values and their slopes in r and z; (2 pi r dA, r) at a point."""
    corner = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    jac = np.zeros((2, 2))
    r = 0.0
    for k in range(4):
        a, b = corner[k, 0], corner[k, 1]
        value[k] = 0.25 * (1.0 + a * s) * (1.0 + b * t)
        r += value[k] * place[k, 0]
        for m in range(2):
            jac[0, m] += 0.25 * a * (1.0 + b * t) * place[k, m]
            jac[1, m] += 0.25 * b * (1.0 + a * s) * place[k, m]
    det = jac[0, 0] * jac[1, 1] - jac[0, 1] * jac[1, 0]
    for k in range(4):
        a, b = corner[k, 0], corner[k, 1]
        along, up = 0.25 * a * (1.0 + b * t), 0.25 * b * (1.0 + a * s)
        slope[k, 0] = (jac[1, 1] * along - jac[0, 1] * up) / det
        slope[k, 1] = (jac[0, 0] * up - jac[1, 0] * along) / det
    return 2.0 * np.pi * r * det, r


@njit(cache=True)
def _law(strain, at_step, made_of, stress, tangent):
    """Second Piola stress (rr, zz, around, rz) and its tangent at a point; moves the state on if told so."""
    c, inverse, j = strain
    pressure, g, step_s, keeps = at_step
    (numbers, branches, sliders, softening), state = made_of
    rate, skeleton = numbers[0], numbers[2] * g
    trace = c[0] + c[1] + c[2]
    small = j ** (-2.0 / 3.0)
    grown = np.exp(min(rate * (small * trace - 3.0), 30.0))
    iso, one = np.zeros(4), np.array([1.0, 1.0, 1.0, 0.0])
    for a in range(4):
        iso[a] = g * grown * small * (one[a] - trace / 3.0 * inverse[a])
    factor = 1.0
    for a in range(4):
        stress[a] = iso[a]
    factor += _overstress(branches, step_s, (iso, state, keeps), stress)
    for k in range(SLIDERS):
        if sliders[0, k] > 0.0:
            factor += _slide((sliders[0, k], sliders[1, k] * g, keeps), iso, state, 4 + 4 * (BRANCHES + k), stress)
    loss = 1.0
    if softening[0] > 0.0:
        loss = 1.0 - softening[0] * (1.0 - np.exp(-state[STATE - 1] / (softening[1] * g)))
    if keeps == 1:
        _spend(0.5 * g * (small * trace - 3.0) * grown, np.exp(-step_s / softening[2]), iso, state)
        return
    factor *= loss
    mean = pressure + skeleton * (j - 1.0)
    for a in range(4):
        stress[a] = loss * stress[a] + mean * j * inverse[a]
    second = g * grown * small * factor
    curve = 2.0 * rate * g * grown * small * small * factor
    wide = mean * j + skeleton * j * j
    for a in range(4):
        for b in range(4):
            both = _both(inverse, a, b)
            da, db = one[a] - trace / 3.0 * inverse[a], one[b] - trace / 3.0 * inverse[b]
            outer = inverse[a] * inverse[b]
            value = -2.0 / 3.0 * (one[a] * inverse[b] + inverse[a] * one[b]) + 2.0 / 9.0 * trace * outer
            value = second * (value + 2.0 / 3.0 * trace * both) + curve * da * db
            tangent[a, b] = value + wide * outer - 2.0 * mean * j * both


@njit(cache=True)
def _overstress(branches, step_s, history, stress):
    """Adds what the viscous branches carry on top; their share of the tangent."""
    iso, state, keeps = history
    factor = 0.0
    for k in range(BRANCHES):
        share = branches[0, k]
        if share == 0.0:
            continue
        fade, half = np.exp(-step_s / branches[1, k]), np.exp(-0.5 * step_s / branches[1, k])
        factor += share * half
        for a in range(4):
            over = fade * state[4 + 4 * k + a] + share * half * (iso[a] - state[a])
            stress[a] += over
            if keeps == 1:
                state[4 + 4 * k + a] = over
    return factor


@njit(cache=True)
def _spend(energy, heals, iso, state):
    """Moves the history on: the energy spent, which heals, and the stress of the step."""
    state[STATE - 1] = state[STATE - 1] * heals + abs(energy - state[STATE - 2])
    state[STATE - 2] = energy
    for a in range(4):
        state[a] = iso[a]


@njit(cache=True)
def _slide(slider, iso, state, first, stress):
    """An element of dry friction on the isochoric stress; its share of the tangent."""
    share, most, keeps = slider
    trial = np.zeros(4)
    size = 0.0
    for a in range(4):
        trial[a] = state[first + a] + share * (iso[a] - state[a])
        size += (2.0 if a == 3 else 1.0) * trial[a] ** 2
    size = np.sqrt(size)
    scale = 1.0 if size <= most else most / size
    for a in range(4):
        stress[a] += scale * trial[a]
        if keeps == 1:
            state[first + a] = scale * trial[a]
    return share * scale


@njit(cache=True)
def _both(inverse, a, b):
    """(C^-1_ik C^-1_jl + C^-1_il C^-1_jk)/2 in the order rr, zz, around, rz."""
    rr, zz, around, rz = inverse[0], inverse[1], inverse[2], inverse[3]
    if a > b:
        a, b = b, a
    if a == 2 or b == 2:
        return around * around if a == b else 0.0
    if b < 3:
        if a == b:
            return rr * rr if a == 0 else zz * zz
        return rz * rz
    if a == 3:
        return 0.5 * (rr * zz + rz * rz)
    return rr * rz if a == 0 else zz * rz
