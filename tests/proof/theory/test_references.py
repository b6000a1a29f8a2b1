"""The references against closed forms and against each other, before anything is measured with them."""

import numpy as np
import pytest
from proof import meshes
from proof.theory import complementarity, cylinder_theory, distances, finite_elements, layer_theory, paper_model
from scipy.integrate import quad


@pytest.mark.parametrize("nu", [0.5, 0.45, 0.3])
@pytest.mark.parametrize("s", [0.05, 0.3, 1.0, 3.0, 8.0])
def test_layer_transform_solves_the_equations_of_elasticity(nu, s):
    solved = layer_theory.compliance(s, nu)
    assert layer_theory.transform(s, nu) == pytest.approx(solved[0, 0] / (1.0 - nu), rel=1e-9)
    assert solved[0, 1] == pytest.approx(solved[1, 0], rel=1e-9, abs=1e-12), "as work is to be the same either way"


def test_layer_transform_has_its_limits():
    assert layer_theory.transform(1e-3, 0.5) == pytest.approx(
        2.0 / 3.0 * 1e-9, rel=1e-5
    )  # lubrication: u = -h^3 / (3 G) laplacian p
    assert layer_theory.transform(1e-5, 0.3) == pytest.approx(
        1e-5 * (1 - 0.6) / (2 * 0.49), rel=1e-4
    )  # confined column: u = p h / M
    assert layer_theory.transform(30.0, 0.5) == pytest.approx(1.0, abs=1e-12)
    assert layer_theory.transform(0.02 - 1e-9, 0.5) == pytest.approx(layer_theory.transform(0.02 + 1e-9, 0.5), rel=1e-6)


def test_layer_kernel_conserves_volume():
    node, weight = np.polynomial.legendre.leggauss(8)
    start = np.linspace(0.0, 40.0, 161)[:-1, None]
    x, weights = (start + 0.125 * (1.0 + node)).ravel(), np.tile(0.125 * weight, 160)
    profile = 1.0 - x * layer_theory.smooth_kernel(x)  # 2 pi r u(r) of a point force
    assert abs((weights * profile).sum()) < 1e-6 * (weights * np.abs(profile)).sum()
    assert x[np.flatnonzero(profile < 0.0)[0]] == pytest.approx(0.740, abs=0.03)


def test_rings_on_a_half_space_find_sneddons_sphere():
    depth, force = layer_theory.sneddon_sphere(10.0, 1.0, 0.02, 0.5)
    found, _, contact = layer_theory.press(
        lambda r: 10.0 - np.sqrt(100.0 - r * r) - depth, np.linspace(0.0, 1.4, 71), 0.02, 0.5, np.inf
    )
    assert found == pytest.approx(force, rel=2e-4)
    assert contact == pytest.approx(1.0, abs=0.021)


@pytest.mark.parametrize(("thickness", "nu"), [(5.0, 0.5), (8.0, 0.5), (8.0, 0.45)])
def test_hankel_and_finite_elements_agree(thickness, nu):
    depth = 0.15 * thickness
    edges = np.linspace(0.0, 1.6 * np.sqrt(20.0 * depth), 49)
    middle = np.sqrt((edges[1:] ** 2 + edges[:-1] ** 2) / 2.0)
    gap = 10.0 - np.sqrt(100.0 - middle**2) - depth
    by_transform, _ = complementarity.lemke(layer_theory.ring_compliance(edges, 0.02, nu, thickness), gap)
    by_elements, _ = complementarity.lemke(finite_elements.ring_compliance(edges, 0.02, nu, thickness), gap)
    assert by_elements.sum() == pytest.approx(by_transform.sum(), rel=1e-3)


def test_contact_along_normals_tends_to_the_vertical_one():
    """Elements pressed along the sphere's normals agree for shallow presses; at 0.15 h they are 11 % softer."""
    for share, low, high in ((0.005, -0.005, 0.0), (0.149, -0.12, -0.09)):
        depth = share * 8.0
        edges = np.linspace(0.0, 1.4 * np.sqrt(20.0 * depth), 29)
        along_z, _, _ = layer_theory.press(lambda r, d=depth: 10.0 - np.sqrt(100.0 - r * r) - d, edges, 0.02, 0.5, 8.0)
        along_normals, _ = finite_elements.press_by_sphere(10.0, depth, edges, (0.02, 0.5, 8.0))
        assert low < along_normals / along_z - 1.0 < high


def test_strips_on_a_thick_layer_find_the_hertzian_line_contact():
    edges = np.linspace(0.0, 0.8, 81)
    load, width = cylinder_theory.press(lambda x: x * x / 20.0 - 0.02, edges, 0.02, 0.5, 30.0)
    assert width == pytest.approx(cylinder_theory.half_width(load, 10.0, 0.02, 0.5), rel=0.02)


def test_lemke_and_gauss_seidel_agree():
    rng = np.random.default_rng(7)
    for size in (1, 5, 40):
        factor = rng.normal(size=(size, size))
        matrix, gap = factor @ factor.T + 0.1 * np.eye(size), rng.normal(size=size)
        force, _ = complementarity.lemke(matrix, gap)
        assert complementarity.residual(matrix, gap, force) < 1e-9 if (gap < 0).any() else (force == 0).all()
        assert np.allclose(force, complementarity.projected_gauss_seidel(matrix, gap), rtol=1e-7, atol=1e-9)


def test_lemke_says_when_there_is_no_solution():
    with pytest.raises(complementarity.SecondaryRay):
        complementarity.lemke(-np.eye(2), np.array([-1.0, -2.0]))


@pytest.mark.parametrize(("g0", "is_solvable"), [(0.005, True), (0.0275, False), (0.05, False)])
def test_swelling_inside_the_complementarity_problem_ends_on_rays(g0, is_solvable):
    """Within the paper's own palm range (5 to 50 kPa), Eq. 12 as rows of the problem has no solution Lemke finds."""
    vertices, _ = meshes.disc_patch(38.0, 3.0, 0.15, 2)
    gap = (vertices[:, 0] ** 2 + vertices[:, 1] ** 2) / 200.0 - 2.0
    tissue = paper_model.Tissue(g0, 0.06, 7.0, 3.0, 15.0, 2.5)
    inside = paper_model.swelling_inside(vertices, gap, tissue)
    rng = np.random.default_rng(5)
    for trial in range(3):
        scale = np.exp(0.5 * rng.normal(size=len(vertices)) * (trial > 0))
        if is_solvable:
            complementarity.lemke(scale[:, None] * inside, scale * gap)
        else:
            with pytest.raises(complementarity.SecondaryRay):
                complementarity.lemke(scale[:, None] * inside, scale * gap)
    plain = paper_model.response(vertices, gap, tissue)
    assert complementarity.residual(plain, gap, complementarity.lemke(plain, gap)[0]) < 1e-12
    assert np.linalg.eigvalsh((inside + inside.T) / 2.0)[0] < 0.0 or is_solvable


def test_clamped_response_is_indefinite_on_fine_meshes():
    """1 / max(r, r0) has negative eigenvalues below a spacing of 0.8 mm."""
    for spacing, is_definite in ((1.0, True), (0.6, False)):
        vertices, _ = meshes.flat_patch(10 * spacing, 10 * spacing, spacing, 0.0)
        assert (np.linalg.eigvalsh(paper_model.boussinesq(vertices))[0] > 0.0) == is_definite


def test_distances_to_meshes_equal_the_closed_forms():
    rng = np.random.default_rng(3)
    points = rng.normal(size=(200, 3)) * 2.0 + 1.0
    low, high = (0.0, 0.0, 0.0), (1.0, 2.0, 3.0)
    assert np.allclose(
        distances.to_mesh(points, *meshes.box(low, high)), distances.to_box(points, low, high), atol=1e-12
    )
    around = rng.normal(size=(100, 3)) * 8.0
    faceted = distances.to_mesh(around, *meshes.sphere(10.0, (0.0, 0.0, 0.0), 3.0, 0.5)) - distances.to_sphere(
        around, (0, 0, 0), 10.0
    )
    assert faceted.min() > -1e-9 and faceted.max() < 0.04
    column = rng.normal(size=(100, 3)) * 20.0
    error = distances.to_mesh(column, *meshes.cylinder(24.0, 60.0, 128, 3)) - distances.to_cylinder(column, 24.0, 60.0)
    assert error.min() > -1e-9 and error.max() < 24.0 * (1.0 - np.cos(np.pi / 128)) + 1e-9


def test_winding_tells_inside_from_outside_of_a_thin_cup():
    cup = meshes.thin_cup(30.0, 60.0, 2.0)
    points = np.array([[0.0, 0.0, 30.0], [29.0, 0.0, 30.0], [0.0, 0.0, 1.0], [40.0, 0.0, 30.0]])
    assert np.allclose(distances.winding(points, *cup), [0.0, 1.0, 1.0, 0.0], atol=1e-9)


def test_sneddon_tends_to_hertz():
    depth, force = layer_theory.sneddon_sphere(10.0, 0.05, 0.02, 0.5)
    assert force == pytest.approx(4.0 / 3.0 * 0.08 * np.sqrt(10.0) * depth**1.5, rel=1e-4)


def test_smooth_kernel_is_the_transform():
    for x in (0.0, 0.7, 3.0):
        value = quad(
            lambda s, x=x: (1.0 - layer_theory.transform(s, 0.5)) * layer_theory.j0(s * x), 0.0, 25.0, limit=400
        )[0]
        assert layer_theory.smooth_kernel(x)[0] == pytest.approx(value, abs=1e-8)
