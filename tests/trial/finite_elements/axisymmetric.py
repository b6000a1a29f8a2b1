"""Axisymmetric finite elements of a pad over bone at finite strain, with history: the truth of the trial, in numba.

Shares nothing with Thenar. Quads with a mean dilatation (Q1/P0, the mean pressure an unknown of its own), tissue

    W = G/(2b) (exp(b (I1' - 3)) - 1) + p (J - 1) - p^2/(2K),    b = 0: neo-Hookean,

to which a `Tissue` may add, each off by default: overstress of log-spaced branches on the isochoric second Piola stress
(a stretched exponential's spectrum), pore water that flows between elements by Darcy's law and leaves a compressible
skeleton, elements of dry friction (Iwan), damage that grows with the energy spent and heals, a stiff skin, another bulk
modulus. Contact is smooth, by a penalty at four points of every surface element; a `Grip` is a cohesive traction that
those points carry once they have touched. Units: mm, N, MPa, s. Depth is positive into the skin.
"""

from dataclasses import dataclass, field

import numpy as np
from numba import njit
from trial.finite_elements.axisymmetric_contact import LAST, touch
from trial.finite_elements.axisymmetric_elements import BRANCHES, SLIDERS, STATE, elements

PENALTY = 4.0  # MPa/mm
SKIN_LEVELS = 4  # elements through a stiff skin: with one, it bends as if it could be compressed


@dataclass(frozen=True)
class Tissue:
    """What the pad is made of. Shares are over the elastic (slow) stiffness."""

    shear_mpa: float = 0.01
    rate: float = 0.0  # b
    bulk_ratio: float = 1000.0  # K/G
    overstress: tuple = (0.0,) * BRANCHES
    times_s: tuple = (0.05, 0.25, 1.2, 6.0, 30.0)
    skeleton_ratio: float = 0.0  # bulk modulus of the drained skeleton over G
    permeability: float = 0.0  # mm4/(N s)
    friction: tuple = (0.0,) * SLIDERS  # stiffness over G
    yield_ratio: tuple = (0.01, 0.03, 0.1)  # stress over G at which a slider slips
    damage: float = 0.0  # largest loss of stiffness
    damage_energy: float = 0.02  # energy spent, over G, at which 63 % of it is lost
    healing_s: float = 120.0
    skin_mm: float = 0.0
    skin_ratio: float = 1.0


@dataclass(frozen=True)
class Pad:
    """Radius of the skin, thickness over bone, and the widest contact that is to be resolved, mm."""

    radius: float
    thickness: float
    reach: float


@dataclass(frozen=True)
class Tool:
    """A sphere, or a plate for an infinite radius; and its grip: largest traction (MPa) and its gap (mm)."""

    radius: float
    grip: tuple = (0.0, 0.03)


@dataclass
class Mesh:
    """Nodes (r, z) as (nr + 1, nz + 1, 2), columns from the bone to the skin."""

    nodes: np.ndarray
    size: int = field(init=False)

    def __post_init__(self):
        columns, levels, _ = self.nodes.shape
        self.size = columns * (3 * levels - 1)


def mesh_of(pad, density=1.0, skin_mm=0.0):
    """The pad's mesh: even under the contact, then growing outward; levels closer at the top, even in a stiff skin."""
    step = pad.reach / round(26 * density)
    r = [k * step for k in range(round(26 * density) + 1)]
    while r[-1] < pad.reach + 2.2 * pad.thickness:
        step *= 1.22
        r.append(r[-1] + step)
    r = np.array(r)
    t = 1.0 - (1.0 - np.linspace(0.0, 1.0, round(9 * density) + 1)) ** 1.3
    if skin_mm > 0.0:
        below = 1.0 - skin_mm / pad.thickness
        t = np.concatenate([below * t, np.linspace(below, 1.0, round(SKIN_LEVELS * density) + 1)[1:]])
    normal = np.stack([r / pad.radius, np.ones_like(r)], axis=1)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    skin = np.stack([r, -(r**2) / (2.0 * pad.radius)], axis=1)
    return Mesh(skin[:, None] - normal[:, None] * pad.thickness * (1.0 - t)[None, :, None])


def press(pad, tissue, tool, motion, density=1.0):
    """Force (N) on the tool at the rows (time s, depth mm) of `motion`; NaN from where no equilibrium is found."""
    mesh = mesh_of(pad, density, tissue.skin_mm)
    shape = _shape(mesh, tissue)
    numbers = np.array([tissue.rate, tissue.bulk_ratio, tissue.skeleton_ratio, tissue.permeability], dtype=float)
    branches = np.array([tissue.overstress, tissue.times_s], dtype=float)
    sliders = np.array([tissue.friction, tissue.yield_ratio], dtype=float)
    softening = np.array([tissue.damage, tissue.damage_energy, tissue.healing_s], dtype=float)
    curvature = 0.0 if np.isinf(tool.radius) else 1.0 / tool.radius
    contact = np.array([curvature, PENALTY, *tool.grip], dtype=float)
    return _run(mesh.nodes, shape, (numbers, branches, sliders, softening), contact, np.ascontiguousarray(motion))


def _shape(mesh, tissue):
    """Shear modulus of every element."""
    columns, levels, _ = mesh.nodes.shape
    shear = np.full((columns - 1, levels - 1), tissue.shear_mpa)
    if tissue.skin_mm > 0.0:
        depth = mesh.nodes[0, -1, 1] - 0.5 * (mesh.nodes[0, 1:, 1] + mesh.nodes[0, :-1, 1])
        shear[:, depth < tissue.skin_mm] *= tissue.skin_ratio
    return shear


@njit(cache=True)
def _run(nodes, shear, tissue, contact, motion):
    columns, levels = nodes.shape[0], nodes.shape[1]
    block = 3 * levels - 1
    size, band = columns * block, block + 5
    x = np.zeros(size)
    state = np.zeros((columns - 1, levels - 1, 4, STATE))
    content = np.zeros((columns - 1, levels - 1))
    touched = np.zeros((columns - 1, 8))
    forces = np.full(len(motion), np.nan)
    last = np.array([0.0, 0.0])
    for k in range(len(motion)):
        before = (x.copy(), state.copy(), content.copy(), touched.copy(), last.copy())
        parts = 1
        while parts <= 16:
            good = True
            force = 0.0
            for part in range(parts):
                target = before[4] + (motion[k] - before[4]) * (part + 1) / parts
                good, force = _step(nodes, shear, tissue, contact, (x, state, content, touched, last, target, band))
                if not good:
                    break
                last[:] = target
            if good:
                break
            x[:], state[:], content[:], touched[:], last[:] = before
            parts *= 4
        if not good:
            return forces
        forces[k] = force
    return forces


@njit(cache=True)
def _step(nodes, shear, tissue, contact, now):
    x, state, content, touched, last, target, band = now
    start = x.copy()
    step_s = target[0] - last[0]
    matrix = np.zeros((len(x), band))
    right = np.zeros(len(x))
    change = 1.0
    for turn in range(36):
        matrix[:] = 0.0
        right[:] = 0.0
        elements(nodes, shear, tissue, (x, state, content, step_s, 0), (matrix, right))
        force, push = touch(nodes, contact, (x, touched, target[1], turn), matrix, right)
        _held(nodes, matrix, right)
        if turn > 0 and np.abs(right).max() < 1e-4 * max(push, 1e-5) and change < 1e-4:
            elements(nodes, shear, tissue, (x, state, content, step_s, 1), (matrix, right))
            touch(nodes, contact, (x, touched, target[1], LAST), matrix, right)
            return True, force
        if not _solve(matrix, right):
            x[:] = start
            return False, 0.0
        change = 0.0
        block = 3 * nodes.shape[1] - 1
        for i in range(nodes.shape[0]):
            for j in range(nodes.shape[1]):
                for a in range(2):
                    change = max(change, abs(right[i * block + 3 * j + a]))
        if not np.isfinite(change) or change > 3.0:
            x[:] = start
            return False, 0.0
        x += right if turn < 12 else 0.5 * right
    x[:] = start
    return False, 0.0


@njit(cache=True)
def _held(nodes, matrix, right):
    """Bone held, the axis kept, unused pressures of the last column set."""
    columns, levels = nodes.shape[0], nodes.shape[1]
    block = 3 * levels - 1
    for i in range(columns):
        _fix(matrix, right, i * block)
        _fix(matrix, right, i * block + 1)
    for j in range(levels):
        _fix(matrix, right, 3 * j)
    for j in range(levels - 1):
        _fix(matrix, right, (columns - 1) * block + 3 * j + 2)


@njit(cache=True)
def _fix(matrix, right, k):
    band = matrix.shape[1]
    matrix[k, :] = 0.0
    for j in range(1, min(band, k + 1)):
        matrix[k - j, j] = 0.0
    matrix[k, 0] = 1.0
    right[k] = 0.0


@njit(cache=True, fastmath=True)
def _solve(matrix, right):
    """L D L^T of a symmetric quasi-definite band (row k holds columns k, k + 1, ...); the solution replaces `right`."""
    size, band = matrix.shape
    for k in range(size):
        pivot = matrix[k, 0]
        if pivot == 0.0 or not np.isfinite(pivot):
            return False
        most = min(band, size - k)
        for i in range(1, most):
            value = matrix[k, i]
            if value != 0.0:
                share = value / pivot
                for j in range(i, most):
                    matrix[k + i, j - i] -= share * matrix[k, j]
                right[k + i] -= share * right[k]
    for k in range(size - 1, -1, -1):
        total = right[k]
        for j in range(1, min(band, size - k)):
            total -= matrix[k, j] * right[k + j]
        right[k] = total / matrix[k, 0]
    return True
