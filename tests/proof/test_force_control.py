"""Force control and posture: the force asked for is the force got, and what is kept between presses changes nothing."""

import numpy as np
import pytest
import thenar

from proof import meshes, pressing

LAYER = [pressing.material(thickness=8.0)]


@pytest.mark.parametrize("model", ["layer", "paper"])
@pytest.mark.parametrize("force", [0.05, 0.5, 3.0])
def test_force_is_reached(model, force):
    tip, plate = pressing.fingertip(1500), pressing.plate_over(6.5)
    contact = pressing.press(tip, plate, LAYER, model, force_n=force, direction=(0.0, 0.0, -1.0))
    assert contact.total_force_n @ [0.0, 0.0, 1.0] == pytest.approx(force, rel=1e-3)
    moved = plate[0] + np.array([0.0, 0.0, -1.0]) * contact.offset_mm, plate[1]
    again = pressing.press(tip, moved, LAYER, model)
    assert again.total_force_n[2] == pytest.approx(force, rel=2e-3)


def test_force_on_a_cylinder_from_a_gap():
    """The product may start clear of the skin; a stiffening material is solved too."""
    finger = [thenar.Material(g0_mpa=0.005, g_lim_mpa=0.09, d_lim_mm=4.0, thickness_mm=8.0, swelling=(2.0, 8.0, 2.0))]
    for model in ("layer", "paper"):
        product = pressing.cylinder_over(7.5)
        contact = pressing.press(pressing.fingertip(1500), product, finger, model, force_n=1.0, direction=(0, 0, -2.0))
        assert contact.total_force_n[2] == pytest.approx(1.0, rel=1e-3)
        assert contact.offset_mm > 0.5


def test_posed_press_is_a_press_of_the_posed_skin_for_rigid_poses():
    tip, plate = pressing.fingertip(1200), pressing.plate_over(6.0)
    turn, shift = meshes.rotation((0.3, 1.0, 0.2), 0.7), np.array([5.0, 3.0, -2.0])
    prepared = thenar.Skin(*tip, regions=None, materials=LAYER, model="layer")
    still = prepared.press(*plate)
    posed = prepared.press(plate[0] @ turn.T + shift, plate[1], posed_vertices_mm=tip[0] @ turn.T + shift)
    assert np.allclose(posed.force_n, still.force_n, rtol=0, atol=1e-9 * still.force_n.max())
    assert np.allclose(posed.displacement_mm, still.displacement_mm @ turn.T, atol=1e-8)


@pytest.mark.parametrize("model", ["layer", "paper"])
def test_warm_is_as_good_as_cold(model):
    """A press after others gives the forces of a first press."""
    tip = pressing.fingertip(1500)
    prepared = thenar.Skin(*tip, regions=None, materials=LAYER, model=model)
    for height in (6.4, 5.5, 6.1):
        warm = prepared.press(*pressing.cylinder_over(height), warm_start=True)
    cold = pressing.press(tip, pressing.cylinder_over(6.1), LAYER, model)
    assert np.allclose(warm.force_n, cold.force_n, rtol=0, atol=1e-7 * cold.force_n.max())


def test_halving_the_spacing_moves_force_and_patch_peak_little():
    """A fingertip against itself at half the vertex spacing: force within 3 %, patch peak within 8 %."""
    coarse, fine = (
        pressing.press(pressing.fingertip(count), pressing.cylinder_over(5.5), LAYER) for count in (1500, 6000)
    )
    assert coarse.total_force_n[2] == pytest.approx(fine.total_force_n[2], rel=0.03)
    assert coarse.patch_peak_mpa == pytest.approx(fine.patch_peak_mpa, rel=0.08)


def test_center_of_pressure_and_moment():
    skin, product = pressing.sphere_on_flat(40.0, 0.2, 0.5)
    shift = np.array([7.0, -3.0, 0.0])
    contact = pressing.press((skin[0] + shift, skin[1]), (product[0] + shift, product[1]))
    assert np.allclose(contact.center_of_pressure_mm[:2], shift[:2], atol=0.05)
    expected = np.cross(contact.center_of_pressure_mm, contact.total_force_n)
    size = np.linalg.norm(contact.total_force_n) * np.linalg.norm(shift)
    assert np.allclose(contact.total_moment_nmm, expected, atol=0.02 * size)


def test_cancelled_press_stops():
    tip = pressing.fingertip(3000)
    prepared = thenar.Skin(*tip, regions=None, materials=LAYER, model="layer")
    with pytest.raises(thenar.Cancelled):
        prepared.press(*pressing.cylinder_over(5.0), cancel=lambda: True)
    assert prepared.press(*pressing.cylinder_over(5.0)).force_n.max() > 0.0
