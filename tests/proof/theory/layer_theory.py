"""A bonded elastic layer under an axisymmetric load, by Hankel transforms: reference for Thenar's `layer` model.

G shear modulus (MPa), nu Poisson's ratio, h thickness (mm, infinite for the half space), k wave number, s = k h.
"""

import numpy as np
from proof.theory.complementarity import lemke
from scipy.special import j0, j1


def transform(s, nu):
    """K(s) of u^(k) = (1 - nu) / (G k) K(k h) p^(k), closed form: 1 for a half space, 0 for no layer at all."""
    s = np.asarray(s, float)
    kappa, far = 3.0 - 4.0 * nu, np.exp(-2.0 * s)
    top = kappa * (1.0 - far**2) - 4.0 * s * far
    bottom = kappa * (1.0 + far**2) + (4.0 * s**2 + 1.0 + kappa**2) * far
    # Below s = 0.02 the numerator cancels: its series for kappa = 1 does not.
    series = 8.0 / 3.0 * s**3 - 16.0 / 3.0 * s**4 + 88.0 / 15.0 * s**5 - 208.0 / 45.0 * s**6
    small = (s < 0.02) & (kappa == 1.0)
    return np.where(small, series, top) / bottom


def compliance(s, nu):
    """[[normal by pressure, by traction], [along by pressure, by traction]] of the surface at one s, for G = k = 1.

    By solving Navier's equations through the thickness: u_z = W(z) cos x, u_x = U(z) sin x, W = (a + b z) e^z +
    (c + d z) e^-z; no motion at the bone (z = -s), tractions at z = 0.
    """
    kappa, up, down = 3.0 - 4.0 * nu, np.exp(-s), np.exp(s)

    def waves(z, up, down):
        w = np.array([up, z * up, down, z * down])
        u = np.array([-up, -(kappa + z) * up, down, (z - kappa) * down])
        return w, u

    top, along = waves(0.0, 1.0, 1.0)
    slope, sheared = np.array([1.0, 1.0, -1.0, 1.0]), np.array([-1.0, -1.0 - kappa, -1.0, 1.0 + kappa])
    normal = 2.0 * (slope - 2.0 * nu * np.array([0.0, 1.0, 0.0, 1.0]))
    rows = np.array([*waves(-s, up, down), normal, sheared - top])
    pressed, pulled = np.linalg.solve(rows, [0, 0, -1, 0]), np.linalg.solve(rows, [0, 0, 0, 1])
    return np.array([[-top @ pressed, -top @ pulled], [along @ pressed, along @ pulled]])


def wave_numbers(edges):
    """Gauss nodes and weights on k, from 0 to where rings as fine as `edges` (mm) have nothing more to say."""
    finest, extent = np.diff(edges).min(), edges[-1]
    panel = min(np.pi / (2.0 * extent), 0.25)
    panels = int(np.ceil(60.0 / finest / panel))
    node, weight = np.polynomial.legendre.leggauss(5)
    start = np.arange(panels)[:, None] * panel
    return (start + (node + 1.0) * panel / 2.0).ravel(), np.tile(weight * panel / 2.0, panels)


def under_plate(s, nu, plate):
    """K(s) under a bonded plate: `plate(s)` is its stiffness matrix, for G = k = 1. By inverting matrices at 400 s."""
    knots = np.geomspace(s.min(), s.max() * 1.001, 400)
    found = []
    for one in knots:
        own = compliance(min(one, 12.0), nu)
        found.append(np.linalg.inv(np.linalg.inv(own) + plate(one))[0, 0] / (1.0 - nu))
    return np.exp(np.interp(np.log(s), np.log(knots), np.log(found)))


def ring_compliance(edges, shear_modulus, nu, thickness, skin=()):
    """Mean displacement (mm) of every ring under a unit force (N) on every other; rings between `edges` (n + 1).

    `skin`: bending stiffness (N mm), tension (N/mm) and stiffness against stretch (N/mm) of a thin plate that is bonded
    on top, and how far its middle lies above the layer (mm).
    """
    k, weight = wave_numbers(edges)
    outer = edges[:, None] * j1(np.outer(edges, k))
    ring = np.diff(outer, axis=0)  # k times the transform of a unit pressure on the ring
    factor = np.ones_like(k) if np.isinf(thickness) else transform(k * thickness, nu)
    if any(skin):
        deep = thickness if np.isfinite(thickness) else 1e3 * edges[-1]
        factor = under_plate(k * deep, nu, lambda s: bonded_plate(s / deep, skin) / shear_modulus)
    area = np.pi * np.diff(edges**2)
    spread = (ring * (weight * factor / k**2)) @ ring.T
    # Beyond the last k only K = 1 and the mean of r J1(k r)^2 r = r / (pi k) are left, on the shared edges.
    tail = np.zeros_like(spread)
    rest = 1.0 / (2.0 * np.pi * k.max() ** 2)
    i = np.arange(len(edges) - 1)
    tail[i, i] = (edges[:-1] + edges[1:]) * rest
    tail[i[:-1], i[1:]] = tail[i[1:], i[:-1]] = -edges[1:-1] * rest
    if any(skin):
        tail[:] = 0.0  # a skin answers short waves with nothing
    return (1.0 - nu) / shear_modulus * 2.0 * np.pi * (spread + tail) / np.outer(area, area)


def bonded_plate(k, skin):
    """Stiffness (MPa) over k against sinking and moving along of the surface under a plate, by its energy at k.

    Bending D k^4 w^2 / 2, tension N k^2 w^2 / 2, and stretch M k^2 v^2 / 2 of its middle, which moves by v = u - c k w.
    """
    bending, tension, stretch, middle = skin
    turn = np.array([-middle * k, 1.0])
    return (np.diag([bending * k**4 + tension * k**2, 0.0]) + stretch * k**2 * np.outer(turn, turn)) / k


def press(profile, edges, shear_modulus, nu, thickness):
    """Frictionless press of a rigid axisymmetric product into the layer.

    `profile(r)` is the gap (mm, < 0 in overlap). Returns (force N, pressure MPa by ring, contact radius mm).
    """
    middle = np.sqrt((edges[1:] ** 2 + edges[:-1] ** 2) / 2.0)
    force, _ = lemke(ring_compliance(edges, shear_modulus, nu, thickness), profile(middle))
    pressed = np.flatnonzero(force > 0.0)
    area = np.pi * np.diff(edges**2)
    return force.sum(), force / area, float(edges[pressed[-1] + 1]) if len(pressed) else 0.0


def force_through_skin(profile, edges, material, skin):
    """Force (N) of such a press on a layer `material` (G, nu, h) under a plate `skin` (as in `ring_compliance`)."""
    middle = np.sqrt((edges[1:] ** 2 + edges[:-1] ** 2) / 2.0)
    return lemke(ring_compliance(edges, *material, skin), profile(middle))[0].sum()


def surface_displacement(radius, edges, pressure, material):
    """Displacement (mm) at the radii given, under pressure (MPa) by ring; `material` is (G, nu, h)."""
    shear_modulus, nu, thickness = material
    k, weight = wave_numbers(np.concatenate([edges, [max(edges[-1], np.max(radius)) * 1.01]]))
    load = (np.diff(edges[:, None] * j1(np.outer(edges, k)), axis=0) * pressure[:, None]).sum(axis=0) / k
    factor = np.ones_like(k) if np.isinf(thickness) else transform(k * thickness, nu)
    return (1.0 - nu) / shear_modulus * (j0(np.outer(radius, k)) @ (weight * load * factor))


def smooth_kernel(x, nu=0.5):
    """Phi(x) = integral of (1 - K(s)) J0(s x) ds, the layer's departure from 1/r (physics.md section 5)."""
    node, weight = np.polynomial.legendre.leggauss(12)
    start = np.arange(120)[:, None] * 0.25
    s, w = (start + (node + 1.0) * 0.125).ravel(), np.tile(weight * 0.125, 120)
    return j0(np.outer(np.atleast_1d(x), s)) @ (w * (1.0 - transform(s, nu)))


def sneddon_sphere(radius, contact_radius, shear_modulus, nu):
    """(depth mm, force N) of a true rigid sphere, not its parabola, on a half space (Sneddon 1965)."""
    modulus, a, log = (
        2.0 * shear_modulus / (1.0 - nu),
        contact_radius,
        np.log((radius + contact_radius) / (radius - contact_radius)),
    )
    return a / 2.0 * log, modulus * ((a * a + radius * radius) / 2.0 * log - a * radius)
