"""The rows of friction: Thenar's solver and Siconos' fastest on one dense problem; both must give the same forces.

Of Siconos 4.4's solvers for this problem ADMM is the fastest, then the nonsmooth Newton of Alart and Curnier; NSGS and
the Tresca fixed point take three to five times as long.
"""

import ctypes

import numpy as np
import thenar
from bench.peers import siconos
from bench.peers.problems import LATTICE
from bench.rows import TARGET, faster, left_out
from bench.timing import cpu_ms, once_ms
from proof import meshes

CONTACTS, SPACING_MM = 1412, 1.0
SHEAR_MODULUS, FRICTION, SHARE = 0.03, 0.4, 0.5  # MPa, 1, Q / (mu P)
DENSE = 0  # NM_DENSE
SOLVERS = {"siconos ADMM (Debian)": 523, "siconos NSN_AC (Debian)": 504}
# The largest natural residual, relative to the travel, with which an answer counts.
RESIDUAL, THEIR_TOLERANCE, THEIR_STEPS = 1e-7, 1e-9, 20000


class _Problem(ctypes.Structure):
    _fields_ = (
        ("dimension", ctypes.c_int),
        ("contacts", ctypes.c_int),
        ("matrix", ctypes.c_void_p),
        ("q", ctypes.c_void_p),
        ("friction", ctypes.c_void_p),
    )


class _Options(ctypes.Structure):
    """The head of Siconos' SolverOptions: as far as the tolerance."""

    _fields_ = (
        ("solver", ctypes.c_int),
        ("is_set", ctypes.c_bool),
        ("integers", ctypes.c_int),
        ("iparam", ctypes.POINTER(ctypes.c_int)),
        ("numbers", ctypes.c_int),
        ("dparam", ctypes.POINTER(ctypes.c_double)),
    )


def problem():
    """(matrix mm/N, travel mm, normal force N): a Hertz contact on jittered points, dragged to half of its grip."""
    points, _ = meshes.disc_patch(2.0 * np.sqrt(CONTACTS), SPACING_MM, 0.15, 9)
    points = points[np.argsort(np.hypot(points[:, 0], points[:, 1]))[:CONTACTS], :2]
    points = points[np.random.default_rng(4).permutation(CONTACTS)]
    chord = points[:, None] - points[None]
    r = np.linalg.norm(chord, axis=-1)
    np.fill_diagonal(r, 1.0)
    chord /= r[..., None]
    unit, own = 1.0 / (4.0 * np.pi * SHEAR_MODULUS), np.arange(CONTACTS)
    matrix = np.zeros((CONTACTS, 2, CONTACTS, 2))
    for a in range(2):
        for b in range(2):
            matrix[:, a, :, b] = unit * ((a == b) + chord[..., a] * chord[..., b]) / r
    area = SPACING_MM**2 * np.sqrt(0.75)
    matrix[own, :, own, :] = 1.5 * LATTICE * unit / np.sqrt(area) * np.eye(2)
    matrix = matrix.reshape(2 * CONTACTS, 2 * CONTACTS)
    distance = np.hypot(points[:, 0], points[:, 1])
    radius = 1.01 * distance.max()
    normal = 0.02 * area * np.sqrt(1.0 - (distance / radius) ** 2)
    whole = 4.5 * FRICTION * normal.sum() / (16.0 * SHEAR_MODULUS * radius)  # Mindlin 1949: travel at total slip
    travel = whole * (1.0 - (1.0 - SHARE) ** (2.0 / 3.0)) * np.array([0.8, 0.6])
    return 0.5 * (matrix + matrix.T), np.tile(travel, (CONTACTS, 1)), normal


def residual(matrix, travel, limit, force):
    """Largest natural residual of Coulomb's law, relative to the travel: the same for every solver."""
    own = np.diag(matrix)[::2, None]
    target = force - ((matrix @ force.ravel()).reshape(-1, 2) - travel) / own
    length = np.linalg.norm(target, axis=1)
    within = target * np.minimum(1.0, limit / np.maximum(length, 1e-300))[:, None]
    return (np.linalg.norm(force - within, axis=1) * own[:, 0]).max() / np.linalg.norm(travel[0])


def prepare(library, solver, matrix, travel, normal):
    """A call without arguments that solves the problem anew and returns the shear forces (n, 2).

    The normal part is diagonal and has the normal forces as its answer: Siconos need only find the shear.
    """
    own = matrix[0, 0]
    whole = np.zeros((CONTACTS, 3, CONTACTS, 3))
    whole[:, 1:, :, 1:] = matrix.reshape(CONTACTS, 2, CONTACTS, 2)
    whole[np.arange(CONTACTS), 0, np.arange(CONTACTS), 0] = own
    whole = np.asfortranarray(whole.reshape(3 * CONTACTS, 3 * CONTACTS))
    offset = np.column_stack([-own * normal, -travel]).ravel()
    friction = np.full(CONTACTS, FRICTION)
    library.solver_options_create.restype = ctypes.c_void_p
    library.fc3d_driver.restype = ctypes.c_int
    library.fc3d_driver.argtypes = [ctypes.c_void_p] * 4
    dense = library.NM_create_from_data(DENSE, 3 * CONTACTS, 3 * CONTACTS, whole.ctypes.data)
    stated = _Problem(3, CONTACTS, dense, offset.ctypes.data, friction.ctypes.data)

    def solve(_keep=(whole, offset, friction)):
        options = library.solver_options_create(solver)
        head = ctypes.cast(options, ctypes.POINTER(_Options)).contents
        head.iparam[0], head.dparam[0] = THEIR_STEPS, THEIR_TOLERANCE
        force, velocity = np.zeros((CONTACTS, 3)), np.zeros((CONTACTS, 3))
        info = library.fc3d_driver(ctypes.byref(stated), force.ctypes.data, velocity.ctypes.data, options)
        if info != 0:
            raise ArithmeticError(f"siconos solver {solver} ended with {info}")
        return force[:, 1:]

    return solve


def friction_rows():
    """The dense friction problem, cold."""
    matrix, travel, normal = problem()
    limit = FRICTION * normal
    solved = thenar.solve_stick_slip(matrix, travel, limit)
    slipping = int((np.linalg.norm(solved.force_n, axis=1) > limit * (1.0 - 1e-9)).sum())
    ours = residual(matrix, travel, limit, solved.force_n)
    if ours > RESIDUAL:
        raise AssertionError(f"Thenar's residual is {ours:.1e}")
    what = f"friction, {CONTACTS:,} contacts, {slipping} slipping, cold"
    try:
        library = siconos.load(TARGET)
    except siconos.Unavailable as reason:
        return [left_out(what, "siconos", str(reason))]
    time = cpu_ms(lambda: thenar.solve_stick_slip(matrix, travel, limit), 9)
    rows = []
    for name, solver in SOLVERS.items():
        their_time, force = once_ms(prepare(library, solver, matrix, travel, normal))
        theirs = residual(matrix, travel, limit, force)
        if theirs > RESIDUAL or np.abs(force - solved.force_n).max() > 1e-5 * limit.max():
            raise AssertionError(f"{name} gave other forces, its residual is {theirs:.1e}")
        note = f"natural residual over travel: {ours:.0e}, theirs {theirs:.0e}"
        rows.append(faster(what, name, (time, their_time), 20, note))
    return rows
