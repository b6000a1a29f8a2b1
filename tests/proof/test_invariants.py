"""What must hold for any mesh: complementarity, no penetration, rigid motion, order, mirror, load, determinism."""

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from proof import meshes, pressing
from proof.theory import distances

CASES = {
    "fingertip on plate": (
        pressing.fingertip,
        lambda: pressing.plate_over(5.8),
        lambda p: distances.to_box(p, (-40, -40, 5.8), (40, 40, 35.8)),
        8.0,
    ),
    "fingertip on cylinder": (
        lambda: pressing.fingertip(2500),
        lambda: pressing.cylinder_over(5.8),
        lambda p: distances.to_mesh(p, *pressing.cylinder_over(5.8)),
        7.0,
    ),
    "flat skin under sphere": (
        lambda: meshes.disc_patch(9.0, 0.6),
        lambda: meshes.sphere(10.0, (0, 0, 8.8), 6.0, 0.25),
        lambda p: distances.to_mesh(p, *meshes.sphere(10.0, (0, 0, 8.8), 6.0, 0.25)),
        5.0,
    ),
    "flat skin under box corner": (
        lambda: meshes.disc_patch(12.0, 0.8),
        lambda: meshes.box((-0.3, -0.2, -0.7), (30, 30, 30)),
        lambda p: distances.to_box(p, (-0.3, -0.2, -0.7), (30, 30, 30)),
        6.0,
    ),
    "fingertip on half space": (
        lambda: pressing.fingertip(1200),
        lambda: pressing.plate_over(6.2),
        lambda p: 6.2 - p[:, 2],
        np.inf,
    ),
}


def run(name, skin=None, product=None, model="layer"):
    make_skin, make_product, _, thickness = CASES[name]
    return pressing.press(
        skin or make_skin(), product or make_product(), [pressing.material(thickness=thickness)], model
    )


@pytest.mark.parametrize("model", ["layer", "paper"])
@pytest.mark.parametrize("name", CASES)
def test_certificate_and_no_penetration(name, model):
    """Complementarity to 1e-10; the written skin penetrates by 0.02 mm at most by the proof's own distances."""
    make_skin, _, distance, _ = CASES[name]
    skin = make_skin()
    contact = run(name, skin, model=model)
    assert contact.residual.complementarity <= 1e-10
    assert contact.force_n.min() >= 0.0 and contact.force_n.max() > 0.0
    moved = (contact.force_n > 0.0) | (np.linalg.norm(contact.displacement_mm, axis=1) > 0.0)
    depth = -distance(pressing.written(skin, contact)[moved]).min()
    assert depth <= 0.02
    assert np.abs(distance(pressing.written(skin, contact)[contact.force_n > 0.0])).max() <= 0.02


@pytest.mark.parametrize("name", CASES)
def test_gap_is_the_signed_distance(name):
    make_skin, _, distance, _ = CASES[name]
    skin = make_skin()
    gap, own = run(name, skin).gap_mm, distance(skin[0])
    near = np.isfinite(gap)
    assert near[own < 1.0].all()
    assert np.allclose(gap[near], own[near], atol=2e-6)


@pytest.mark.parametrize("name", ["fingertip on cylinder", "flat skin under sphere"])
@pytest.mark.parametrize("model", ["layer", "paper"])
def test_rigid_motion(name, model):
    skin, product = CASES[name][0](), CASES[name][1]()
    turn, shift = meshes.rotation((1.0, 2.0, -0.5), 1.1), np.array([13.0, -7.0, 4.0])
    still = run(name, skin, product, model)
    moved = run(name, (skin[0] @ turn.T + shift, skin[1]), (product[0] @ turn.T + shift, product[1]), model)
    assert np.allclose(moved.force_n, still.force_n, rtol=0, atol=1e-9 * still.force_n.max())
    size = np.abs(still.displacement_mm).max()
    assert np.allclose(moved.displacement_mm, still.displacement_mm @ turn.T, rtol=0, atol=1e-9 * size)
    assert np.allclose(
        moved.total_force_n, turn @ still.total_force_n, rtol=0, atol=1e-9 * np.linalg.norm(still.total_force_n)
    )


@pytest.mark.parametrize("name", ["fingertip on cylinder", "flat skin under box corner"])
def test_vertex_order(name):
    vertices, triangles, order = meshes.shuffled(*CASES[name][0](), 11)
    product = meshes.shuffled(*CASES[name][1](), 12)[:2]
    still, other = run(name), run(name, (vertices, triangles), product)
    assert np.allclose(other.force_n, still.force_n[order], rtol=0, atol=1e-9 * still.force_n.max())
    assert np.allclose(
        other.displacement_mm, still.displacement_mm[order], rtol=0, atol=1e-9 * np.abs(still.displacement_mm).max()
    )


@pytest.mark.parametrize("name", ["fingertip on cylinder", "flat skin under sphere"])
def test_mirrored(name):
    skin, product = CASES[name][0](), CASES[name][1]()
    flip = np.array([-1.0, 1.0, 1.0])
    still = run(name, skin, product)
    other = run(name, (skin[0] * flip, skin[1][:, ::-1].copy()), (product[0] * flip, product[1][:, ::-1].copy()))
    assert np.allclose(other.force_n, still.force_n, rtol=0, atol=1e-9 * still.force_n.max())
    assert np.allclose(
        other.displacement_mm, still.displacement_mm * flip, rtol=0, atol=1e-9 * np.abs(still.displacement_mm).max()
    )


def test_through_meters_and_back():
    """A scene in meters, converted once, gives the same answer."""
    name = "fingertip on cylinder"
    skin, product = CASES[name][0](), CASES[name][1]()
    still = run(name, skin, product)
    other = run(name, (skin[0] / 1000.0 * 1000.0, skin[1]), (product[0] / 1000.0 * 1000.0, product[1]))
    assert np.allclose(other.force_n, still.force_n, rtol=0, atol=1e-9 * still.force_n.max())


def test_scales_by_dimension():
    """Everything twice as long at the same modulus: four times the force, twice the displacement."""
    skin, plate = pressing.fingertip(1200), pressing.plate_over(6.2)
    small = pressing.press(skin, plate, [pressing.material(thickness=4.0)])
    large = pressing.press((2.0 * skin[0], skin[1]), (2.0 * plate[0], plate[1]), [pressing.material(thickness=8.0)])
    assert np.allclose(large.force_n, 4.0 * small.force_n, rtol=0, atol=1e-9 * large.force_n.max())


@pytest.mark.parametrize("name", CASES)
def test_loads_balance(name):
    skin, product = CASES[name][0](), CASES[name][1]()
    contact = run(name, skin, product)
    size = contact.force_n.sum()
    assert np.linalg.norm(contact.total_force_n) <= size * (1.0 + 1e-12)
    assert contact.total_force_n[2] > 0.7 * size
    assert contact.residual.load_balance <= 1e-9
    assert sum(region.force_n for region in contact.regions) == pytest.approx(size, rel=1e-9)
    area = np.zeros(len(product[0]))
    a, b, c = (product[0][product[1][:, k]] for k in range(3))
    np.add.at(area, product[1], np.linalg.norm(np.cross(b - a, c - a), axis=1)[:, None] / 6.0)
    assert (contact.product_pressure_mpa * area).sum() == pytest.approx(size, rel=1e-9)
    assert contact.mean_pressure_mpa <= contact.peak_pressure_mpa
    assert contact.patch_peak_mpa <= contact.peak_pressure_mpa * (1.0 + 1e-12)


@pytest.mark.parametrize("model", ["layer", "paper"])
def test_more_depth_is_never_less_force(model):
    skin, last = pressing.fingertip(1200), 0.0
    for depth in np.linspace(0.1, 2.4, 9):
        force = pressing.press(
            skin, pressing.plate_over(7.0 - depth), [pressing.material(thickness=8.0)], model
        ).total_force_n[2]
        assert force > last
        last = force


def test_reciprocity_between_two_materials():
    """Displacement at B under a force at A equals that at A under it at B, across a change of material."""
    vertices, triangles = meshes.disc_patch(8.0, 1.0, 0.15, 5)
    regions = (vertices[:, 0] > 0.0).astype(np.int32)
    materials = [pressing.material(0.01, 5.0), pressing.material(0.06, 9.0)]
    a, b = (int(np.argmin(np.hypot(vertices[:, 0] - x, vertices[:, 1]))) for x in (-1.8, 1.6))

    def compliance(at, of):
        x, y, _ = vertices[at]
        contact = pressing.press(
            (vertices, triangles), meshes.sphere(0.3, (x, y, 0.29), 0.2, 0.03), materials, regions=regions
        )
        assert np.flatnonzero(contact.force_n).tolist() == [at]
        return contact.displacement_mm[of, 2] / contact.force_n[at]

    assert compliance(a, b) == pytest.approx(compliance(b, a), rel=1e-9)


def digest():
    """Hash of every number of one press of each model."""
    text = hashlib.sha256()
    for model in ("layer", "paper"):
        contact = run("fingertip on cylinder", model=model)
        for field in (
            contact.displacement_mm,
            contact.force_n,
            contact.pressure_mpa,
            contact.gap_mm,
            contact.product_pressure_mpa,
            contact.total_force_n,
        ):
            text.update(np.ascontiguousarray(field).tobytes())
    return text.hexdigest()


def test_same_bits_twice_and_with_any_number_of_threads():
    here = digest()
    assert digest() == here
    program = "from proof.test_invariants import digest; print(digest())"
    for threads in ("1", "3"):
        place = {**os.environ, "RAYON_NUM_THREADS": threads, "PYTHONPATH": str(Path(__file__).parents[1])}
        assert (
            subprocess.run(
                [sys.executable, "-c", program], env=place, check=True, capture_output=True, text=True
            ).stdout.strip()
            == here
        )
