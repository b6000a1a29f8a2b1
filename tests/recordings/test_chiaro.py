"""The instrument's own effective modulus comes out of its raw columns, with the contact point found by us."""

import numpy as np
import pytest
import thenar
from hertz import fit


def approach(curve):
    """Travel and force up to the greatest load, from the first sample at which the piezo moves on."""
    travel, force = curve.channels.travel_mm, curve.channels.force_n
    end = int(np.argmax(force)) + 1
    start = int(np.argmin(curve.channels.piezo_mm[:end]))
    return travel[start:end], force[start:end]


def test_fit_recovers_a_planted_modulus_and_contact():
    """A made-up curve with noise: nothing of it is the instrument's."""
    random = np.random.default_rng(4)
    travel = np.linspace(-0.004, 0.016, 4000)
    force = 4 / 3 * 2e-4 * np.sqrt(0.03) * np.clip(travel - 0.001, 0, None) ** 1.5 - 3e-10
    modulus, contact, offset, _ = fit(travel, force + 1e-10 * random.standard_normal(4000), 0.03)
    assert modulus == pytest.approx(2e-4, rel=0.002)
    assert contact == pytest.approx(0.001, abs=2e-5)
    assert offset == pytest.approx(-3e-10, abs=2e-11)


def test_effective_modulus_agrees_with_the_instrument(shared):
    curve = thenar.read_recording(shared / "afm_gel_and_soft_matrix" / "chiaro_sphere_indentation.txt").curves[0]
    travel, force = approach(curve)
    modulus, contact, _, rms = fit(travel, force, curve.facts.tip_radius_mm)
    stated = curve.facts.instrument_effective_modulus_mpa
    print(f"E_eff {modulus * 1e6:.3f} Pa, the instrument's {stated * 1e6:.3f} Pa")
    print(f"contact at {contact * 1e3:.3f} um, rms {rms * 1e9:.3f} nN of {force.max() * 1e9:.1f} nN")
    assert stated == pytest.approx(156.009e-6)
    assert modulus == pytest.approx(stated, rel=0.01)
    assert rms < 0.02 * force.max()
    # The instrument's value for a Poisson ratio of 0.5 is that times 1 - 0.25.
    assert curve.facts.instrument_modulus_mpa == pytest.approx(0.75 * stated, rel=1e-4)


def test_force_is_deflection_times_stiffness(shared):
    """The columns belong together: load = cantilever x k."""
    curve = thenar.read_recording(shared / "afm_gel_and_soft_matrix" / "chiaro_sphere_indentation.txt").curves[0]
    expected = curve.channels.cantilever_mm * curve.facts.spring_constant_n_per_mm
    assert np.allclose(curve.channels.force_n, expected, atol=1e-12)
