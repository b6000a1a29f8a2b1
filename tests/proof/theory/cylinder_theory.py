"""Line contact of a rigid cylinder: Hertz on a half space, and strips by cosine transforms on a bonded layer."""

import numpy as np
from proof.theory.complementarity import lemke
from proof.theory.layer_theory import transform


def half_width(force_per_length, radius, shear_modulus, nu):
    """Half width (mm) of a Hertzian line contact under a load in N/mm (Johnson 1985, Eq. 4.43)."""
    return np.sqrt(4.0 * force_per_length * radius * (1.0 - nu) / (np.pi * 2.0 * shear_modulus))


def strip_compliance(edges, shear_modulus, nu, thickness):
    """Mean displacement (mm) of every pair of strips +-x per unit load (N/mm) on every other, `edges` from 0."""
    finest, extent = np.diff(edges).min(), edges[-1]
    panel = min(np.pi / (2.0 * extent), 0.25)
    node, weight = np.polynomial.legendre.leggauss(5)
    start = np.arange(int(np.ceil(400.0 / finest / panel)))[:, None] * panel
    k, w = (start + (node + 1.0) * panel / 2.0).ravel(), np.tile(weight * panel / 2.0, len(start))
    strip = np.diff(np.sin(np.outer(edges, k)), axis=0) / np.diff(edges)[:, None]
    return (1.0 - nu) / (np.pi * shear_modulus) * (strip * (w * transform(k * thickness, nu) / k**3)) @ strip.T


def press(profile, edges, shear_modulus, nu, thickness):
    """Press of an endless product; `profile(x)` is the gap (mm). Returns (load N/mm, contact half width mm)."""
    middle = (edges[1:] + edges[:-1]) / 2.0
    load, _ = lemke(strip_compliance(edges, shear_modulus, nu, thickness), profile(middle))
    return load.sum(), float(edges[np.flatnonzero(load > 0.0)[-1] + 1])
