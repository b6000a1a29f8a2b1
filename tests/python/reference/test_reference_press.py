"""`thenar.reference_press` and `thenar.bone_points`: what they return, refuse, and how they stop."""

import threading

import numpy as np
import pytest
import thenar


def slab(spacing=1.0, half=8.0):
    """A square of skin facing +z, with 4 mm of tissue, held at its rim."""
    line = np.arange(-half, half + 0.5 * spacing, spacing)
    x, y = np.meshgrid(line, line, indexing="ij")
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    index = np.arange(x.size).reshape(x.shape)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    triangles = np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
    held = np.abs(vertices[:, :2]).max(axis=1) > half - 0.5 * spacing
    return vertices, triangles, vertices - [0.0, 0.0, 4.0], np.full(len(vertices), 0.01), held


def block(z=-0.3, half=3.0):
    """A block over the skin, its lower face at `z`."""
    corners = np.array([[x, y, h] for x in (-half, half) for y in (-half, half) for h in (z, z + 10.0)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    return corners, faces


def pressed(z=-0.3, **options):
    vertices, triangles, bone, modulus, held = slab()
    return thenar.reference_press(vertices, triangles, bone, modulus, *block(z), held=held.tolist(), **options)


def test_forces_balance_and_the_skin_lies_at_the_product():
    vertices, *_, held = slab()
    found = pressed()
    assert found.total_force_n[2] > 0.0, "the skin pushes the block up"
    assert np.allclose(found.total_force_n, -found.force_n.sum(axis=0), rtol=1e-9)
    assert found.normal_force_n == pytest.approx(np.linalg.norm(found.force_n, axis=1).sum(), rel=0.02)
    assert found.unbalanced < 2e-4 and found.penetration_mm < 0.011
    assert np.abs(found.displacement_mm[held]).max() == 0.0
    under = np.abs(vertices[:, :2]).max(axis=1) < 2.5
    assert found.displacement_mm[under, 2] == pytest.approx(-0.3, abs=0.011)
    around = (np.abs(vertices[:, :2]).max(axis=1) > 3.5) & ~held
    assert found.displacement_mm[around, 2].max() > 0.03, "tissue keeps its volume: it swells around the block"
    assert found.pressure_mpa[~under & (np.abs(vertices[:, :2]).max(axis=1) > 4.0)].max() == 0.0
    assert len(found.folded) == 0


def test_force_along_the_skin_is_said():
    assert pressed().sideways_share < 0.01
    vertices, triangles, bone, modulus, held = slab(spacing=0.25, half=3.0)
    found = thenar.reference_press(vertices, triangles, bone, modulus, *block(-0.45, half=1.6), held=held.tolist())
    assert found.sideways_share > 0.2, "skin lies at the sides of the block"


def test_no_contact_is_no_force():
    found = pressed(z=0.2)
    assert found.normal_force_n == 0.0 and np.abs(found.displacement_mm).max() == 0.0


def test_the_same_input_gives_the_same_bits():
    first, second = pressed(stiffening=np.ones(289)), pressed(stiffening=np.ones(289))
    assert np.array_equal(first.displacement_mm, second.displacement_mm)
    assert first.normal_force_n > pressed().normal_force_n, "stiffening tissue bears more"


def test_a_modulus_twice_as_large_gives_twice_the_force():
    vertices, triangles, bone, modulus, held = slab()
    twice = thenar.reference_press(vertices, triangles, bone, 2.0 * modulus, *block(), held=held.tolist())
    assert twice.normal_force_n == pytest.approx(2.0 * pressed().normal_force_n, rel=1e-3)


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        ({"bone_mm": np.zeros((3, 3))}, thenar.MeshError, "array `bone`"),
        ({"shear_modulus_mpa": np.zeros(289)}, thenar.MeshError, "shear modulus at vertex 0"),
        ({"held": [True] * 289}, thenar.MeshError, "no skin vertex that can move"),
        ({"held": [True]}, thenar.MeshError, "array `is_held`"),
        ({"stiffening": -np.ones(289)}, thenar.MeshError, "stiffening"),
        ({"layers": 0}, thenar.MeshError, "layers: found 0; give 1 to 8"),
        ({"bulk_ratio": 1e12}, thenar.MeshError, "bulk_ratio"),
        ({"bulk_ratio": float("nan")}, thenar.MeshError, "bulk_ratio"),
    ],
)
def test_input_that_cannot_be_computed_is_refused_by_name(change, error, words):
    vertices, triangles, bone, modulus, held = slab()
    given = {"bone_mm": bone, "shear_modulus_mpa": modulus, "held": held.tolist()} | change
    with pytest.raises(error, match=words):
        thenar.reference_press(
            vertices,
            triangles,
            product_vertices_mm=block()[0],
            product_triangles=block()[1],
            **given,
        )


def test_it_stops_when_asked():
    stop = threading.Event()
    stop.set()
    with pytest.raises(thenar.Cancelled):
        pressed(cancel=stop)


def test_progress_never_goes_back():
    seen = []
    pressed(progress=lambda stage, share: seen.append(share))
    assert seen == sorted(seen) and seen[0] >= 0.0 and 0.8 < seen[-1] <= 1.0


def test_bone_lies_under_the_skin_at_its_thickness():
    vertices, triangles, bone, *_ = slab()
    assert thenar.bone_points(vertices, triangles, np.full(len(vertices), 4.0)) == pytest.approx(bone)
    with pytest.raises(thenar.MeshError, match="heads_mm, tails_mm, palmar and is_last"):
        thenar.bone_points(vertices, triangles, np.full(len(vertices), 4.0), heads_mm=[[0.0, 0.0, 0.0]])
