"""Flat punch and cylinder: closed forms on the half space, and the layer's own Fourier form."""

import numpy as np
import pytest

from proof import meshes, pressing
from proof.theory import cylinder_theory


def punch(spacing, seed, depth=0.02, radius=5.0):
    skin = meshes.disc_patch(radius + 4.0 * spacing, spacing, 0.15, seed)
    vertices, triangles = meshes.cylinder(radius, 40.0, 256, 8)
    return pressing.press(skin, (vertices + [0.0, 0.0, 20.0 - depth], triangles)).total_force_n[2]


def test_flat_punch():
    """F = 2 E* a d, in the limit of fine spacing: vertices resolve the sharp rim to a part of a spacing only."""
    spacing = np.array([0.9, 0.7, 0.5, 0.4, 0.3])
    force = [np.mean([punch(h, seed) for seed in (1, 2, 3)]) for h in spacing]
    limit = np.polyfit(spacing, force, 1)[1]
    assert limit == pytest.approx(2.0 * pressing.CONTACT_MODULUS * 5.0 * 0.02, rel=0.01)


def middle_of_a_long_cylinder(thickness, radius, depth, spacing, half_length):
    """Load per length (N/mm) and half width (mm, from the pressure's shape) in the middle of a long contact."""
    reach = np.sqrt(2.0 * radius * depth)
    skin = meshes.flat_patch(1.6 * reach, half_length, spacing, 0.15, 4)
    product = pressing.cylinder_over(-depth, radius, 2.0 * half_length + 10.0, 2048, 1)
    contact = pressing.press(skin, product, [pressing.material(thickness=thickness)])
    y = skin[0][:, 1] / (half_length / 2.0)
    inner = np.abs(y) < 1.0
    window = np.where(inner, np.cos(np.pi * y / 2.0) ** 2, 0.0)  # no row of vertices counts in whole or not at all
    load = (window * contact.force_n).sum() / (half_length / 2.0)
    x, p = skin[0][inner, 0], contact.pressure_mpa[inner]
    slope, constant = np.polyfit(x[p > 0.3 * p.max()] ** 2, p[p > 0.3 * p.max()] ** 2, 1)
    return load, np.sqrt(-constant / slope)


def test_cylinder_on_half_space():
    """b^2 = 4 P' R / (pi E*) between load and width of a Hertzian line contact."""
    load, width = middle_of_a_long_cylinder(np.inf, 10.0, 0.1, 0.12, 8.0)
    assert width == pytest.approx(cylinder_theory.half_width(load, 10.0, pressing.SHEAR_MODULUS, 0.5), rel=0.01)


@pytest.mark.parametrize("thickness", [3.0, 5.0])
def test_cylinder_on_layer(thickness):
    """Load of a long cylinder against the cosine transform of the bonded layer."""
    depth, radius = 0.04 * thickness, 10.0
    edges = np.linspace(0.0, 1.5 * np.sqrt(2.0 * radius * depth), 101)
    expected, width = cylinder_theory.press(
        lambda x: radius - np.sqrt(radius**2 - x * x) - depth, edges, pressing.SHEAR_MODULUS, 0.5, thickness
    )
    load, _ = middle_of_a_long_cylinder(thickness, radius, depth, width / 6.0, 6.0 * thickness)
    assert load == pytest.approx(expected, rel=0.01)
