"""A rigid sphere, R = 10 mm, on flat skin over a half space, against Hertz and Sneddon."""

import numpy as np
import pytest

from proof import pressing
from proof.theory import layer_theory

RADIUS = 10.0
CONTACT_RADIUS = 0.7  # mm: a/R = 0.07, where sphere and parabola, normal and vertical agree to 1e-3


def hertz(ratio, seed):
    """Presses at a contact radius of `ratio` spacings; returns (contact, vertices, depth, force)."""
    depth, force = layer_theory.sneddon_sphere(RADIUS, CONTACT_RADIUS, pressing.SHEAR_MODULUS, 0.5)
    skin, product = pressing.sphere_on_flat(RADIUS, depth, CONTACT_RADIUS / ratio, seed)
    return pressing.press(skin, product), skin[0], force


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("ratio", [3.2, 4.5, 6.3, 12.0])
def test_force(ratio, seed):
    contact, _, force = hertz(ratio, seed)
    assert contact.total_force_n[2] == pytest.approx(force, rel=0.005)
    assert np.hypot(*contact.total_force_n[:2]) < 0.01 * force


LOW = "at 1.3 spacings the point rule is 0.8 % low in the mean (a dense solve by the proof's own matrix is so too)"


@pytest.mark.parametrize(
    ("ratio", "scatter"), [pytest.param(1.3, 0.025, marks=pytest.mark.xfail(reason=LOW)), (2.1, 0.01)]
)
def test_force_on_coarse_meshes(ratio, scatter):
    """Seven to nineteen vertices carry the contact: the mean over meshes is Hertz's, one mesh scatters about it."""
    share = []
    for seed in range(60):
        contact, _, force = hertz(ratio, seed)
        share.append(contact.total_force_n[2] / force - 1.0)
    assert np.mean(share) == pytest.approx(0.0, abs=0.005)
    assert np.std(share) < scatter


@pytest.mark.parametrize("ratio", [3.2, 4.5, 6.3, 12.0])
def test_contact_radius(ratio):
    contact, _, _ = hertz(ratio, 1)
    assert np.sqrt(contact.contact_area_mm2 / np.pi) == pytest.approx(CONTACT_RADIUS, rel=0.03)


def test_pressure_error_falls_with_spacing():
    errors = []
    for ratio in (2.1, 4.5, 12.0):
        square = []
        for seed in (1, 2, 3):
            contact, vertices, force = hertz(ratio, seed)
            r = np.hypot(vertices[:, 0], vertices[:, 1])
            peak = 1.5 * force / (np.pi * CONTACT_RADIUS**2)
            exact = peak * np.sqrt(np.maximum(1.0 - (r / CONTACT_RADIUS) ** 2, 0.0))
            square.append(np.mean(((contact.pressure_mpa - exact)[r < CONTACT_RADIUS] / peak) ** 2))
        errors.append(np.sqrt(np.mean(square)))
    assert errors[0] > errors[1] > errors[2]
    assert errors[-1] < 0.05


def test_patch_peak_is_hertz_over_a_sensel():
    """Mean of Hertz's pressure over the 24 mm2 in its middle, on a contact of 6 mm radius."""
    a, radius, spacing = 6.0, 200.0, 0.7
    skin, product = pressing.sphere_on_flat(radius, a * a / radius, spacing)
    contact = pressing.press(skin, product)
    modulus, sensel = pressing.CONTACT_MODULUS, 24.0 / np.pi
    peak = 2.0 * modulus * a / (np.pi * radius)
    mean = peak * 2.0 / 3.0 * a * a / sensel * (1.0 - (1.0 - sensel / (a * a)) ** 1.5)
    assert contact.patch_peak_mpa == pytest.approx(mean, rel=0.03)
    assert contact.mean_pressure_mpa == pytest.approx(2.0 / 3.0 * peak, rel=0.05)


def test_moduli_and_depth_scale_as_hertz():
    """Force goes with G and with the depth to the power 3/2."""
    skin, product = pressing.sphere_on_flat(100.0, 0.1, 0.3)
    force = pressing.press(skin, product).total_force_n[2]
    stiff = pressing.press(skin, product, [pressing.material(0.05)]).total_force_n[2]
    assert stiff == pytest.approx(force * 2.5, rel=1e-9)
    shallow = pressing.press(skin, (product[0] + [0.0, 0.0, 0.05], product[1])).total_force_n[2]
    assert shallow == pytest.approx(force / 2.0**1.5, rel=0.01)
