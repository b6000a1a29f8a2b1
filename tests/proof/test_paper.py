"""The `paper` model against dense numpy, on flat skins under a tilted plate, where nothing needs linearizing."""

import numpy as np
import pytest
import thenar

from proof import meshes, pressing
from proof.theory import complementarity, paper_model

TISSUE = paper_model.Tissue(0.01, 0.06, 4.0, 2.0, 8.0, 2.0)
MATERIAL = thenar.Material(g0_mpa=0.01, g_lim_mpa=0.06, d_lim_mm=4.0, thickness_mm=np.inf, swelling=(2.0, 8.0, 2.0))


def tilted_plate(depth, angle=0.06):
    """A thick plate tilted about y, crossing the skin; returns (mesh, outward normal, a point of its lower face)."""
    vertices, triangles = meshes.box((-60, -60, 0), (60, 60, 60))
    turn = meshes.rotation((0.0, 1.0, 0.0), angle)
    point = np.array([0.0, 0.0, -depth])
    return (vertices @ turn.T + point, triangles), turn @ np.array([0.0, 0.0, -1.0]), point


def compare(tissue, material, depth, spacing=1.5, model="paper"):
    """Presses the plate; returns (contact, vertices, exact gap, product normal)."""
    skin = meshes.disc_patch(16.0, spacing, 0.15, 6)
    plate, normal, point = tilted_plate(depth)
    contact = pressing.press(skin, plate, [material], model)
    return contact, skin[0], (skin[0] - point) @ normal, normal


@pytest.mark.parametrize("depth", [0.2, 1.0])
def test_nodal_forces_are_lemkes_and_gauss_seidels(depth):
    contact, vertices, gap, _ = compare(TISSUE, MATERIAL, depth)
    matrix = paper_model.response(vertices, gap, TISSUE)
    force, _ = complementarity.lemke(matrix, gap)
    assert complementarity.residual(matrix, gap, force) < 1e-12
    assert np.allclose(force, complementarity.projected_gauss_seidel(matrix, gap), rtol=0, atol=1e-8 * force.max())
    assert np.allclose(contact.force_n, force, rtol=0, atol=1e-6 * force.max())
    assert contact.regions[0].g_mpa == pytest.approx(TISSUE.shear_modulus(-gap.min()), rel=1e-12)


def test_displacement_is_response_less_bulge():
    """Pressed vertices move by R p along the product's normal, as Eq. 13 measures their distance.

    Those clear of the product move along their own normal, as the half space of Eq. 1 does, and also rise by Eq. 5 with
    a(dmax) of Eq. 6.
    """
    contact, vertices, gap, normal = compare(TISSUE, MATERIAL, 0.5)
    plain = paper_model.response(vertices, gap, TISSUE) @ contact.force_n
    bulge = paper_model.swelling(vertices, contact.force_n, gap, TISSUE)
    moved, inward = contact.displacement_mm, np.array([0.0, 0.0, -1.0])
    pressed = contact.force_n > 0.0
    assert np.allclose(moved[pressed], plain[pressed, None] * normal, atol=1e-8)
    free = (gap > 0.0) & (gap + plain - bulge > 1e-3)
    assert free.sum() > 20
    assert bulge[free].max() > 0.01
    assert np.allclose(moved[free], (plain - bulge)[free, None] * inward, atol=1e-8)
    assert (gap + moved @ normal >= -1e-9).all()


def test_swelling_ends_at_the_product():
    """A peg with a brim 0.02 mm above the skin that swells: the skin meets the brim, and goes no farther."""
    peg = [(0.0, -1.0), (2.0, -1.0), (2.0, 0.02), (12.0, 0.02), (12.0, 4.0), (0.0, 4.0)]
    skin, rod = meshes.disc_patch(14.0, 0.9), meshes.revolved(np.array(peg[:2] + [(2.0, 4.0), (0.0, 4.0)]), 96)
    under, bare = (
        pressing.press(skin, product, [MATERIAL], "paper") for product in (meshes.revolved(np.array(peg), 96), rod)
    )
    r = np.hypot(skin[0][:, 0], skin[0][:, 1])
    height, wanted = under.displacement_mm[:, 2], bare.displacement_mm[:, 2]
    ring, lifted = (r > 3.0) & (r < 11.5), (r > 3.0) & (r < 11.5) & (wanted > 0.021)
    print(f"{lifted.sum()} of {ring.sum()} vertices would rise beyond the brim, by {wanted.max():.3f} mm at most")
    assert lifted.sum() > 20 and height[ring].max() < 0.02 + 1e-9
    assert np.allclose(height[lifted], 0.02, atol=1e-9)
    assert np.allclose(height[ring & ~lifted & (wanted < 0.02)], wanted[ring & ~lifted & (wanted < 0.02)], atol=1e-9)


def test_swelling_changes_no_force():
    with_bulge = compare(TISSUE, MATERIAL, 0.5)[0].force_n
    flat = thenar.Material(g0_mpa=0.01, g_lim_mpa=0.06, d_lim_mm=4.0, thickness_mm=np.inf, swelling=(0.0, 8.0, 2.0))
    assert np.array_equal(compare(TISSUE, flat, 0.5)[0].force_n, with_bulge)


@pytest.mark.parametrize("g0", [0.005, 0.0275, 0.05])
def test_palm_with_the_papers_own_moduli_is_well_posed(g0):
    """Where Eq. 12 inside the problem ends on rays (test_references.py), swelling after the solve is certified."""
    skin = meshes.disc_patch(38.0, 3.0, 0.15, 2)
    palm = thenar.Material(g0_mpa=g0, g_lim_mpa=0.06, d_lim_mm=7.0, thickness_mm=np.inf, swelling=(3.0, 15.0, 2.5))
    contact = pressing.press(skin, meshes.sphere(100.0, (0.0, 0.0, 98.0), 30.0, 1.0), [palm], "paper")
    assert contact.residual.complementarity <= 1e-10
    gap = (skin[0][:, 0] ** 2 + skin[0][:, 1] ** 2) / 200.0 - 2.0
    matrix = paper_model.response(skin[0], gap, paper_model.Tissue(g0, 0.06, 7.0, 0.0, 15.0, 2.5))
    assert contact.total_force_n[2] == pytest.approx(complementarity.lemke(matrix, gap)[0].sum(), rel=0.02)


def test_modulus_is_held_beyond_d_lim_and_said_so():
    soft = thenar.Material(g0_mpa=0.01, g_lim_mpa=0.06, d_lim_mm=1.0, thickness_mm=np.inf, swelling=(0.0, 8.0, 2.0))
    contact = compare(TISSUE, soft, 1.5)[0]
    assert contact.regions[0].g_mpa == pytest.approx(0.06, rel=1e-12)
    assert any("held at Glim" in text for text in contact.warnings)
    assert not any("Glim" in text for text in compare(TISSUE, MATERIAL, 0.2)[0].warnings)


def test_fine_meshes_are_warned_of():
    """Below 0.8 mm of spacing r0 = 0.5 mm makes the matrix indefinite: said in words, in `paper` only."""
    assert any("0.8" in text or "r0" in text for text in compare(TISSUE, MATERIAL, 0.2, 0.6)[0].warnings)
    assert not any("r0" in text for text in compare(TISSUE, MATERIAL, 0.2, 1.5)[0].warnings)
    assert not any("r0" in text for text in compare(TISSUE, MATERIAL, 0.2, 0.6, "layer")[0].warnings)


def test_regions_are_independent():
    """Two regions pressed together give the forces of each alone: the paper couples nothing across a border."""
    vertices, triangles = meshes.disc_patch(11.0, 1.5, 0.15, 6)
    plate, normal, point = tilted_plate(0.5)
    regions = (vertices[:, 1] > 0.0).astype(np.int32)
    contact = pressing.press((vertices, triangles), plate, [MATERIAL, MATERIAL], "paper", regions=regions)
    for side in (0, 1):
        mine = regions == side
        gap = (vertices[mine] - point) @ normal
        force, _ = complementarity.lemke(paper_model.response(vertices[mine], gap, TISSUE), gap)
        assert np.allclose(contact.force_n[mine], force, rtol=0, atol=1e-6 * force.max())


def test_vertices_without_skin_carry_nothing():
    vertices, triangles = meshes.disc_patch(11.0, 1.5, 0.15, 6)
    regions = np.where(vertices[:, 1] > 3.0, -1, 0).astype(np.int32)
    for model in ("paper", "layer"):
        contact = pressing.press((vertices, triangles), tilted_plate(0.5)[0], [MATERIAL], model, regions=regions)
        assert (contact.force_n[regions < 0] == 0.0).all()
        still = (regions < 0) & ((vertices[:, 1] > 9.0) | (model == "paper"))  # a layer fades out beside its border
        assert (contact.displacement_mm[still] == 0.0).all()
