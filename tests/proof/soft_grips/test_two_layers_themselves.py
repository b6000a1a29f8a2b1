"""The finite elements of two layers against what is known of them: Hertz, thin layers, the layer's transform."""

import numpy as np
import pytest
import scipy.integrate
import scipy.special
from proof.soft_grips import two_layers
from proof.soft_grips.two_layers import Layer


@pytest.mark.parametrize("nu", [0.3, 0.4999])
def test_a_half_space_under_a_rigid_sphere_is_of_hertz(nu):
    skin = Layer(None, 0.1, nu)
    found = two_layers.press(skin, None, 10.0, 0.1, elements=40)
    force = two_layers.hertz_force_n([skin], 10.0, 0.1)
    off = found.force_n / force - 1.0, found.peak_mpa / (1.5 * force / np.pi) - 1.0  # contact radius 1 mm
    print(f"nu {nu}: force {off[0]:+.2%}, peak {off[1]:+.2%}, contact radius {found.contact_radius_mm:.4f} mm")
    assert off == pytest.approx((0.0, 0.0), abs=0.01)
    assert found.contact_radius_mm == pytest.approx(1.0, abs=1.5 * found.edge_mm)
    assert found.skin_mm == pytest.approx(0.1, rel=1e-3)


def test_two_half_spaces_are_of_hertz():
    skin, grip = Layer.of_shear(None, 0.03, 0.49), Layer(None, 0.3, 0.3)
    found = two_layers.press(skin, grip, 10.0, 0.1, elements=40)
    off = found.force_n / two_layers.hertz_force_n([skin, grip], 10.0, 0.1) - 1.0
    compliances = [(1.0 - layer.poisson_ratio**2) / layer.youngs_mpa for layer in (skin, grip)]
    shares = found.skin_mm / found.grip_mm, compliances[0] / compliances[1]
    print(f"two half spaces: force {off:+.2%}, skin over grip {shares[0]:.4f}, of Hertz {shares[1]:.4f}")
    assert off == pytest.approx(0.0, abs=0.01)
    assert shares[0] == pytest.approx(shares[1], rel=0.01)


@pytest.mark.parametrize("skin_mm", [15.0, None])
def test_a_thin_compressible_grip_is_an_elastic_foundation(skin_mm):
    grip = Layer(1.0, 0.1, 0.3)
    radius, approach = 2250.0, 0.05  # contact radius 15 mm
    found = two_layers.press(Layer(skin_mm, 1e4 * grip.youngs_mpa, 0.3), grip, radius, approach)
    off = found.force_n / two_layers.winkler_force_n(grip, radius, approach) - 1.0
    print(f"thin compressible grip, skin {skin_mm} mm: force {off:+.2%}, radius {found.contact_radius_mm:.2f} of 15 mm")
    assert off == pytest.approx(0.0, abs=0.03)
    assert found.contact_radius_mm == pytest.approx(15.0, rel=0.03)
    assert found.grip_mm == pytest.approx(approach, rel=0.01)


@pytest.mark.parametrize("wide", [10.0, 20.0])
def test_a_thin_incompressible_layer_does_not_lock(wide):
    """Twice and four times as few elements carry the same force: locked ones would be stiffer by far."""
    skin = Layer(1.0, 0.1, 0.4999)
    forces = [two_layers.press(skin, None, wide**2 / 0.2, 0.05, elements).force_n for elements in (30, 60, 120)]
    off = np.array(forces) / forces[-1] - 1.0
    print(f"contact {wide:.0f} thicknesses wide: force {off[0]:+.2%}, {off[1]:+.2%} over that of the finest")
    assert np.abs(off[:2]).max() < 0.005


def test_a_thin_incompressible_layer_is_squeezed_out_as_a_film():
    """The film lacks what the edge adds, which shrinks with thickness over contact radius."""
    off = []
    for wide in (10.0, 20.0, 40.0):
        skin = Layer(1.0, 0.1, 0.4999999)
        found = two_layers.press(skin, None, wide**2 / 0.2, 0.05)
        off.append(found.force_n / two_layers.thin_incompressible_force_n(skin, wide**2 / 0.2, 0.05) - 1.0)
    print("contact 10, 20, 40 thicknesses wide: force " + ", ".join(f"{o:+.1%}" for o in off))
    assert off[2] == pytest.approx(0.0, abs=0.02)
    assert off[0] > 3.0 * off[1] > 9.0 * off[2] > 0.0


@pytest.mark.parametrize("nu", [0.3, 0.49, 0.4999])
@pytest.mark.parametrize(("thickness_mm", "grip_mm"), [(0.3, 2.0), (1.0, 1.0), (4.0, 0.2)])
def test_displacements_are_those_of_the_layers_under_the_pressure(nu, thickness_mm, grip_mm):
    """By the Hankel transform of a bonded layer (Meijers, Applied Scientific Research 18, 1968), at the centre."""
    skin, grip = Layer(thickness_mm, 0.1, nu), Layer(grip_mm, 0.2, nu)
    found = two_layers.press(skin, grip, 10.0, 0.1)
    edge = found.contact_radius_mm + found.edge_mm
    r = np.linspace(0.0, edge, 1001)
    pressure = np.interp(r, found.r_mm, found.pressure_mpa)
    k = np.linspace(1e-6, 300.0 / edge, 3001)
    waves = scipy.integrate.simpson(pressure * r * scipy.special.j0(np.outer(k, r)), x=r)
    for layer, centre in ((skin, found.skin_mm), (grip, found.grip_mm)):
        x, kappa = k * layer.thickness_mm, 3.0 - 4.0 * nu
        decay = np.exp(-2.0 * x)
        sinh, cosh = (1.0 - decay**2) / 2.0, (1.0 + decay**2) / 2.0  # of 2 x, times exp(-2 x)
        give = (2.0 * kappa * sinh - 4.0 * x * decay) / (2.0 * kappa * cosh + (4.0 * x**2 + 1.0 + kappa**2) * decay)
        wanted = scipy.integrate.simpson(waves * 2.0 * (1.0 - nu**2) / layer.youngs_mpa * give, x=k)
        print(f"nu {nu}, {layer.thickness_mm} mm: centre {centre:.5f} mm, {centre / wanted - 1.0:+.2%}")
        assert centre == pytest.approx(wanted, rel=0.003)


def test_no_force_pulls_and_no_surfaces_overlap():
    radius, approach = 15.0, 0.4
    found = two_layers.press(Layer.of_shear(5.0, 0.02, 0.49), Layer(1.5, 0.15, 0.45), radius, approach)
    gap = found.r_mm**2 / (2.0 * radius) - approach + found.skin_displacement_mm + found.grip_displacement_mm
    assert found.pressure_mpa.min() >= 0.0
    assert gap.min() > -0.002 * approach
    inside = found.r_mm < found.contact_radius_mm - found.edge_mm
    assert np.abs(gap[inside]).max() < 0.002 * approach
    swapped = two_layers.press(Layer(1.5, 0.15, 0.45), Layer.of_shear(5.0, 0.02, 0.49), radius, approach)
    assert swapped.force_n == pytest.approx(found.force_n, rel=1e-6)
    assert (swapped.skin_mm, swapped.grip_mm) == pytest.approx((found.grip_mm, found.skin_mm), rel=1e-6)


def test_what_cannot_be_solved_is_refused():
    with pytest.raises(ValueError, match="poisson_ratio"):
        Layer(1.0, 0.1, 0.5)
    with pytest.raises(ValueError, match="positive"):
        Layer(0.0, 0.1, 0.4)
    with pytest.raises(ValueError, match="approach_mm"):
        two_layers.press(Layer(1.0, 0.1, 0.4), None, 10.0, 0.0)
