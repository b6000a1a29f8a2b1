"""A rigid sphere on a viscoelastic half space: Lee & Radok (loading), Ting (unloading), and the drainage master curve.

Poisson's ratio 1/2, instantaneous shear modulus (MPa), radius and depth (mm), relaxation function g(t), g(0) = 1.
"""

import numpy as np
from proof.theory.layer_theory import sneddon_sphere
from scipy.optimize import brentq

FINE = 4000


def elastic_sphere(shear_modulus, radius, deepest):
    """(force N of depth, contact radius mm of depth) of a true sphere on the elastic half space (Sneddon 1965)."""
    a = np.linspace(0.0, min(1.2 * np.sqrt(radius * deepest), 0.99 * radius), FINE)
    depth, force = sneddon_sphere(radius, a, shear_modulus, 0.5)
    return lambda d: np.interp(d, depth, force), lambda d: np.interp(d, depth, a)


def hereditary(relaxation, times, values, at):
    """Integral of g(at - s) dv(s) over the path of `values` against `times`, up to the end of `times`, v(0) at once."""
    middle = 0.5 * (times[1:] + times[:-1])
    return relaxation(at - times[0]) * values[0] + np.sum(relaxation(at - middle) * np.diff(values))


def ting(relaxation, path, elastic, at):
    """(force N, contact radius mm) at time `at` of the depth `path(t)` (mm) that first grows, then falls (Ting 1966).

    `elastic`: force and contact radius of depth for the elastic half space; while loading this is Lee & Radok.
    """
    times = np.linspace(0.0, at, FINE)
    depth = path(times)
    top = int(np.argmax(depth))
    end = times[top]
    if top < FINE - 1:

        def balance(start):
            s = np.linspace(start, at, FINE)
            return hereditary(relaxation, s, path(s) - path(start), at)

        if balance(0.0) <= 0.0:
            return 0.0, 0.0
        end = brentq(balance, 0.0, end) if balance(end) < 0.0 else end
    s = np.linspace(0.0, end, FINE)
    force, contact_radius = elastic
    return hereditary(relaxation, s, force(path(s)), at), float(contact_radius(path(end)))


def prony(amplitude, times, weights):
    """g(t) = 1 - amplitude + amplitude sum w exp(-t / time), weights normalized."""
    weights = np.asarray(weights, float) / np.sum(weights)
    return lambda t: 1.0 - amplitude + amplitude * sum(w * np.exp(-t / s) for w, s in zip(weights, times, strict=True))


def master_curve(tau):
    """Share of the fading force left for a sphere (Hu, Zhao, Vlassak & Suo 2010)."""
    return 0.491 * np.exp(-0.908 * np.sqrt(tau)) + 0.509 * np.exp(-1.679 * tau)
