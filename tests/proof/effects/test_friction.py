"""Friction of pressed skin against Cattaneo and Mindlin, and the shear of a bonded layer against Navier's equations."""

import numpy as np
import pytest
import thenar
from proof import meshes, pressing
from proof.theory import shear_theory

MU, RADIUS, CONTACT_RADIUS = 0.4, 50.0, 1.0


def friction(coefficient=MU):
    return [thenar.Effect("friction", 1.0, coefficient=coefficient)]


def hertz(ratio, seed):
    """A sphere so large that its planes stay level, pressed to a contact of `ratio` spacings."""
    return pressing.sphere_on_flat(RADIUS, CONTACT_RADIUS**2 / RADIUS, CONTACT_RADIUS / ratio, seed)


@pytest.mark.parametrize("share", [0.25, 0.5, 0.75])
def test_travel_stick_and_traction_are_those_of_cattaneo_and_mindlin(share):
    skin, product = hertz(9.0, 2)
    prepared = thenar.Skin(*skin, materials=[pressing.material()], effects=friction())
    load = prepared.press(*product).force_n.sum()
    contact = prepared.press(*product, drag_n=(share * MU * load, 0.0, 0.0))
    assert contact.friction.residual <= 1e-8
    assert contact.friction.total_force_n[0] == pytest.approx(share * MU * load, rel=1e-6)
    whole = 4.5 * MU * load / (16.0 * pressing.SHEAR_MODULUS * CONTACT_RADIUS)
    assert contact.friction.slide_mm[0] == pytest.approx(whole * (1.0 - (1.0 - share) ** (2.0 / 3.0)), rel=0.01)
    r = np.hypot(*skin[0][:, :2].T)
    inner = (1.0 - share) ** (1.0 / 3.0)
    stuck = contact.is_sticking
    # Where skin sticks, margin^2 (a^2 - r^2) = c^2 - r^2.
    found = np.sqrt(np.mean(contact.slip_margin[stuck] ** 2 * (CONTACT_RADIUS**2 - r[stuck] ** 2) + r[stuck] ** 2))
    assert found == pytest.approx(inner, rel=0.03)
    peak = 1.5 * load / (np.pi * CONTACT_RADIUS**2)
    ellipse = np.sqrt(np.maximum(1.0 - r**2, 0.0)) - inner * np.sqrt(np.maximum(1.0 - (r / inner) ** 2, 0.0))
    error = (contact.tangential_traction_mpa - MU * peak * ellipse)[r < 1.0] / (MU * peak)
    assert np.sqrt(np.mean(error**2)) < 0.05


def test_margin_and_sticking_say_the_same():
    skin, product = hertz(7.0, 1)
    prepared = thenar.Skin(*skin, materials=[pressing.material()], effects=friction())
    contact = prepared.press(*product, slide_mm=(0.005, 0.003, 0.0))
    force, limit = np.linalg.norm(contact.tangential_force_n, axis=1), MU * contact.force_n
    touching = contact.in_contact
    assert np.all(force <= limit * (1.0 + 1e-9))
    assert np.array_equal(np.isnan(contact.slip_margin), ~touching)
    assert np.array_equal(contact.is_sticking, touching & (contact.slip_margin > 0.0))
    slipping = touching & ~contact.is_sticking
    assert slipping.any() and contact.is_sticking.any()
    assert force[slipping] == pytest.approx(limit[slipping], rel=1e-8)
    assert np.abs(contact.slip_mm[contact.is_sticking]).max() < 1e-8
    # Slip goes against the force on the skin, everywhere.
    along = np.einsum("ij,ij->i", contact.slip_mm, contact.tangential_force_n)[slipping]
    assert along == pytest.approx(-np.linalg.norm(contact.slip_mm[slipping], axis=1) * force[slipping], rel=1e-6)


def test_the_reference_shears_a_slab_and_a_half_space():
    for nu in (0.3, 0.45):
        along, across = shear_theory.transfer(1e-3, nu)
        assert (along, across) == pytest.approx((1e-3, 1e-3), rel=1e-3)
        along, across = shear_theory.transfer(12.0, nu)
        assert (along, across) == pytest.approx((1.0 - nu, 1.0), rel=1e-6)


@pytest.mark.parametrize("thickness", [1.0, 2.5, 7.0])
def test_stuck_skin_on_bone_is_as_stiff_as_navier_says(thickness):
    nu, travel = 0.45, 1e-3
    material = pressing.material(thickness=thickness).replace(poisson_ratio=nu)
    skin = meshes.disc_patch(2.6, 0.25, 0.15, 3)
    product = meshes.sphere(20.0, (0.0, 0.0, 19.9), 3.0, 0.05)
    prepared = thenar.Skin(*skin, materials=[material], effects=friction(10.0))
    contact = prepared.press(*product, slide_mm=(travel, 0.0, 0.0))
    inside = contact.in_contact
    corners = skin[0][skin[1]]
    triangle = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2.0
    areas = np.bincount(skin[1].ravel(), np.repeat(triangle / 3.0, 3), len(skin[0]))
    expected = shear_theory.stuck_force(
        skin[0][inside, :2], areas[inside], travel, (pressing.SHEAR_MODULUS, nu, thickness)
    )
    assert inside.sum() > 60
    assert contact.friction.total_force_n[0] == pytest.approx(expected, rel=0.01)


def test_slides_of_a_protocol_follow_the_hysteresis_of_mindlin_and_deresiewicz():
    """Out to 0.8 of total slip and back to none: twice the loading curve at half the change (Masing)."""
    skin, product = hertz(8.0, 4)
    prepared = thenar.Skin(*skin, materials=[pressing.material()], effects=friction())
    load = prepared.press(*product).force_n.sum()
    whole = 4.5 * MU * load / (16.0 * pressing.SHEAR_MODULUS * CONTACT_RADIUS)

    def force(travel):
        return 1.0 - (1.0 - travel) ** 1.5

    out = np.linspace(0.0, 0.6, 13)
    travel = np.concatenate([out, out[-2::-1]])
    # The lateral bounds of a flat skin let the sphere slide by its travel: the contact stays the same.
    exact = np.concatenate([force(out), force(0.6) - 2.0 * force((0.6 - out[-2::-1]) / 2.0)])
    protocol = {
        "time_s": np.arange(len(travel)) * 1.0,
        "offset_mm": np.zeros(len(travel)),
        "slide_mm": np.outer(travel * whole, [1.0, 0.0, 0.0]),
    }
    course = prepared.run(protocol, *product, direction=(0.0, 0.0, -1.0))
    shear = course.tangential_force_n[:, 0] / (MU * load)
    assert np.abs(shear - exact).max() < 0.02
    assert course.total_force_n[:, 0] == pytest.approx(-course.tangential_force_n[:, 0], abs=0.01 * MU * load)
    assert np.all(np.diff(course.slip_loss_mj) >= 0.0) and course.slip_loss_mj[-1] > 0.0
