"""Frictionless contact of two soft layers, axisymmetric and of small strain, by finite elements; nothing of Thenar.

The skin lies on rigid bone, the grip under a rigid core, both bonded, their surfaces apart by r^2 / (2 radius) before
they approach. Both are meshed flat: 9-node elements whose volume strain is linear in each element (Q9 with 3 pressures,
Hughes, The Finite Element Method, 1987, ch. 4.4), which nearly incompressible tissue does not lock. The pressure is
linear between the corner nodes that both surfaces share, never tensile, and the gap weighted by it never negative.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.optimize
import scipy.sparse
import scipy.sparse.linalg

GAUSS, WEIGHTS = np.polynomial.legendre.leggauss(3)
SHAPES = np.stack([GAUSS * (GAUSS - 1.0) / 2.0, 1.0 - GAUSS**2, GAUSS * (GAUSS + 1.0) / 2.0], axis=1)
SLOPES = np.stack([GAUSS - 0.5, -2.0 * GAUSS, GAUSS + 0.5], axis=1)
ENDLESS = 400.0  # depth and radius of a half space over the contact radius: a solid this deep is 0.2 % too stiff
DISC = 8.0  # thicknesses of a layer beyond the contact
FIRST_PASS = 24  # elements of the solve that finds the contact radius


@dataclass(frozen=True)
class Layer:
    """Isotropic layer of `thickness_mm` (None: a half space); `poisson_ratio` below 0.5."""

    thickness_mm: float | None
    youngs_mpa: float
    poisson_ratio: float

    def __post_init__(self):
        if not -1.0 < self.poisson_ratio < 0.5:
            raise ValueError(f"poisson_ratio {self.poisson_ratio} is not within -1 to 0.5")
        if self.youngs_mpa <= 0.0 or (self.thickness_mm is not None and self.thickness_mm <= 0.0):
            raise ValueError(f"{self} is not of positive thickness and modulus")

    @classmethod
    def of_shear(cls, thickness_mm, shear_mpa, poisson_ratio):
        """Layer of shear modulus `shear_mpa`, MPa."""
        return cls(thickness_mm, 2.0 * shear_mpa * (1.0 + poisson_ratio), poisson_ratio)


@dataclass(frozen=True)
class Found:
    """Contact of two layers: force N, lengths mm, pressure MPa.

    `peak_mpa`, `skin_mm` and `grip_mm` are those at the centre, displacements positive into their layer; the arrays are
    those of the surface nodes at `r_mm`, out to the edge of the disc. The contact ends somewhere within one element:
    `contact_radius_mm` is its middle, `edge_mm` half its length.
    """

    force_n: float
    contact_radius_mm: float
    edge_mm: float
    peak_mpa: float
    skin_mm: float
    grip_mm: float
    r_mm: np.ndarray
    pressure_mpa: np.ndarray
    skin_displacement_mm: np.ndarray
    grip_displacement_mm: np.ndarray


def press(skin, grip, radius_mm, approach_mm, elements=60):
    """Contact of `skin` and `grip` (Layers; grip None: rigid) that approach by `approach_mm` from their first touch.

    The gap before is r^2 / (2 radius_mm), mm; `elements` is how many lie along the contact radius, and the elements
    across the layers grow finer with it. Limits: Hertz (Johnson, Contact Mechanics, 1985, ch. 4.2) for half spaces,
    thin layers (ch. 5.8) for contacts much wider than the thickness.
    """
    if radius_mm <= 0.0 or approach_mm <= 0.0:
        raise ValueError("radius_mm and approach_mm must be positive")
    # No contact is wider than that of a thin incompressible layer, 2 sqrt(radius approach): ch. 5.8.
    widest = 2.0 * np.sqrt(radius_mm * approach_mm)

    def gap(r):
        return r**2 / (2.0 * radius_mm) - approach_mm

    rough = _press(skin, grip, gap, widest, FIRST_PASS)
    return _press(skin, grip, gap, rough.contact_radius_mm + rough.edge_mm, elements)


def hertz_force_n(layers, radius_mm, approach_mm):
    """Force N of half spaces of the `layers`' moduli by Hertz: Johnson, Contact Mechanics, 1985, eq. 4.23."""
    compliance = sum((1.0 - layer.poisson_ratio**2) / layer.youngs_mpa for layer in layers)
    return 4.0 / 3.0 / compliance * np.sqrt(radius_mm) * approach_mm**1.5


def winkler_force_n(layer, radius_mm, approach_mm):
    """Force N of a thin compressible layer under a rigid sphere: an elastic foundation of its oedometric modulus.

    Johnson, Contact Mechanics, 1985, ch. 4.3 and 5.8: contact radius sqrt(2 radius approach).
    """
    nu = layer.poisson_ratio
    oedometric = layer.youngs_mpa * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))
    return np.pi * oedometric / layer.thickness_mm * radius_mm * approach_mm**2


def thin_incompressible_force_n(layer, radius_mm, approach_mm):
    """Force N of a thin layer of poisson_ratio 0.5, bonded below, under a frictionless rigid sphere.

    Johnson, Contact Mechanics, 1985, ch. 5.8: the layer is squeezed out like a viscous film, so the pressure is
    3 G (a^2 - r^2)^2 / (32 radius thickness^3) of contact radius a = 2 sqrt(radius approach).
    """
    shear = layer.youngs_mpa / 3.0
    return 2.0 * np.pi * shear * radius_mm**2 * approach_mm**3 / layer.thickness_mm**3


def _press(skin, grip, gap, contact, elements):
    """Contact across `gap`, a function of r, mm, on elements that are even to just beyond the radius `contact`."""
    layers = [layer for layer in (skin, grip) if layer is not None]
    even = 1.15 * contact + 2.0 * contact / elements
    step = contact / elements
    growth = 1.0 + 12.0 / elements
    thicknesses = [ENDLESS * contact if layer.thickness_mm is None else layer.thickness_mm for layer in layers]
    discs = [ENDLESS * contact if layer.thickness_mm is None else even + DISC * layer.thickness_mm for layer in layers]
    inner = np.linspace(0.0, even, int(np.ceil(even / step)) + 1)
    r = np.concatenate([inner, even + _graded(step, growth, max(discs) - even, np.inf)[1:]])

    loads = _loads(r)[:, : len(inner) - 1]
    compliances = []
    for layer, thickness in zip(layers, thicknesses, strict=True):
        is_endless = layer.thickness_mm is None
        coarsest = np.inf if is_endless else 10.0 * thickness / elements
        depths = _graded(min(step, coarsest), growth, thickness, coarsest)
        compliances.append(_displacements(layer, r, depths, loads))

    pressure = _complementarity(loads.T @ sum(compliances), loads.T @ gap(_quadratic_nodes(r)))
    if not pressure.any() or pressure[-1] > 0.0:
        raise ValueError("the contact does not end within the even elements")
    last = np.flatnonzero(pressure)[-1]
    moved = [(displacements @ pressure)[::2] for displacements in compliances]
    if grip is None:
        moved.append(np.zeros(len(r)))
    return Found(
        force_n=float((loads @ pressure).sum()),
        contact_radius_mm=float(r[last : last + 2].mean()),
        edge_mm=float(r[last + 1] - r[last]) / 2.0,
        peak_mpa=float(pressure[0]),
        skin_mm=float(moved[0][0]),
        grip_mm=float(moved[1][0]),
        r_mm=r,
        pressure_mpa=np.concatenate([pressure, np.zeros(len(r) - len(pressure))]),
        skin_displacement_mm=moved[0],
        grip_displacement_mm=moved[1],
    )


def _complementarity(matrix, offset):
    """x >= 0 with matrix x + offset >= 0 and their product 0; `matrix` is symmetric and positive definite."""
    upper = scipy.linalg.cholesky((matrix + matrix.T) / 2.0)
    return scipy.optimize.nnls(upper, -scipy.linalg.solve_triangular(upper, offset, trans="T"))[0]


def _graded(first, growth, end, coarsest):
    """Places from 0 to `end`, apart by `first` that grows to at most `coarsest`, all scaled to meet the end."""
    sizes = [first]
    while sum(sizes) < end:
        sizes.append(min(sizes[-1] * growth, coarsest))
    places = np.concatenate([[0.0], np.cumsum(sizes)])
    return places * end / places[-1]


def _quadratic_nodes(places):
    """Corner nodes with the middles between them."""
    nodes = np.empty(2 * len(places) - 1)
    nodes[::2] = places
    nodes[1::2] = (places[1:] + places[:-1]) / 2.0
    return nodes


def _loads(r):
    """Forces N on the surface nodes (quadratic) from pressures of 1 MPa at the corner nodes (linear)."""
    loads = np.zeros((2 * len(r) - 1, len(r)))
    linear = np.stack([(1.0 - GAUSS) / 2.0, (1.0 + GAUSS) / 2.0], axis=1)
    for e, half in enumerate(np.diff(r) / 2.0):
        rings = 2.0 * np.pi * (r[e] + half * (1.0 + GAUSS)) * half * WEIGHTS
        loads[2 * e : 2 * e + 3, e : e + 2] += np.einsum("g,gi,gj->ij", rings, SHAPES, linear)
    return loads


def _displacements(layer, r, depths, loads):
    """Displacements of the surface nodes into the layer, mm, one column for each of the `loads`, N."""
    stiffness, is_held = _stiffness(layer, r, depths)
    free = np.flatnonzero(~is_held)
    surface = 2 * np.arange(len(loads)) + 1
    forces = np.zeros((len(is_held), loads.shape[1]))
    forces[surface] = loads
    factor = scipy.sparse.linalg.splu(
        stiffness[free][:, free].tocsc(), "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    )
    moved = np.zeros_like(forces)
    moved[free] = factor.solve(forces[free])
    return moved[surface]


def _stiffness(layer, r, depths):
    """Stiffness N/mm of a disc, rows (radial, inward) by node, surface nodes first; which rows are held."""
    n_r, n_z = len(r) - 1, len(depths) - 1
    wide, deep = 2 * n_r + 1, 2 * n_z + 1
    i, j = (index.ravel() for index in np.meshgrid(np.arange(n_r), np.arange(n_z)))
    half_r, half_z = np.diff(r)[i] / 2.0, np.diff(depths)[j] / 2.0
    shear = layer.youngs_mpa / (2.0 * (1.0 + layer.poisson_ratio))
    bulk = layer.youngs_mpa / (3.0 * (1.0 - 2.0 * layer.poisson_ratio))
    deviatoric = shear * (np.diag([2.0, 2.0, 2.0, 1.0]) - np.outer([1, 1, 1, 0], [1, 1, 1, 0]) * 2.0 / 3.0)

    blocks = np.zeros((len(i), 18, 18))
    volume, mass = np.zeros((len(i), 3, 18)), np.zeros((len(i), 3, 3))
    for p in range(3):
        for q in range(3):
            place = r[i] + half_r * (1.0 + GAUSS[p])
            weight = 2.0 * np.pi * place * half_r * half_z * WEIGHTS[p] * WEIGHTS[q]
            by_r = np.outer(1.0 / half_r, np.outer(SHAPES[q], SLOPES[p]).ravel())
            by_z = np.outer(1.0 / half_z, np.outer(SLOPES[q], SHAPES[p]).ravel())
            strain = np.zeros((len(i), 4, 18))  # radial, axial, hoop, shear
            strain[:, 0, ::2] = strain[:, 3, 1::2] = by_r
            strain[:, 1, 1::2] = strain[:, 3, ::2] = by_z
            strain[:, 2, ::2] = np.outer(1.0 / place, np.outer(SHAPES[q], SHAPES[p]).ravel())
            blocks += strain.transpose(0, 2, 1) @ (weight[:, None, None] * (deviatoric @ strain))
            linear = np.array([1.0, GAUSS[p], GAUSS[q]])
            volume += weight[:, None, None] * linear[:, None] * strain[:, :3].sum(axis=1)[:, None, :]
            mass += weight[:, None, None] * np.outer(linear, linear)
    blocks += bulk * volume.transpose(0, 2, 1) @ np.linalg.solve(mass, volume)

    local = (wide * np.arange(3)[:, None] + np.arange(3)).ravel()
    nodes = (2 * j * wide + 2 * i)[:, None] + local
    rows = np.stack([2 * nodes, 2 * nodes + 1], axis=2).reshape(len(i), 18)
    shape = (2 * wide * deep,) * 2
    where = np.repeat(rows, 18, axis=1).ravel(), np.tile(rows, (1, 18)).ravel()
    is_held = np.zeros((deep, wide, 2), dtype=bool)
    is_held[-1] = True  # bonded
    is_held[:, 0, 0] = True  # the axis
    return scipy.sparse.csr_matrix((blocks.ravel(), where), shape), is_held.ravel()
