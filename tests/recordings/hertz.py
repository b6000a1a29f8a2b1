"""Hertz's sphere on a half space, fitted to a curve whose contact point is not known.

F = 4/3 E_eff sqrt(R) d^(3/2), d = travel - contact (Johnson 1985, Eq. 4.23, sphere on a plane); F carries an offset.
For a given contact point the modulus and the offset are linear, so only the contact point is searched.
"""

import numpy as np


def fit(travel, force, radius):
    """Effective modulus, contact point, force offset and rms misfit, in the units given (N, mm: MPa)."""
    low, high = travel.min(), travel.max()
    for _ in range(12):
        contacts = np.linspace(low, high, 41)
        misfits = [_linear(travel, force, radius, contact)[2] for contact in contacts]
        best = int(np.argmin(misfits))
        low, high = contacts[max(best - 1, 0)], contacts[min(best + 1, 40)]
    contact = 0.5 * (low + high)
    modulus, offset, rms = _linear(travel, force, radius, contact)
    return modulus, contact, offset, rms


def _linear(travel, force, radius, contact):
    depth = np.clip(travel - contact, 0.0, None)
    shape = 4.0 / 3.0 * np.sqrt(radius) * depth**1.5
    scale = shape.max() or 1.0
    matrix = np.column_stack([shape / scale, np.ones_like(shape)])
    (slope, offset), *_ = np.linalg.lstsq(matrix, force, rcond=None)
    rms = float(np.sqrt(np.mean((force - matrix @ [slope, offset]) ** 2)))
    return slope / scale, offset, rms
