"""What `thenar.reference_press` refuses although it could give a number, and what it says of skin between vertices."""

import numpy as np
import pytest
import thenar
from test_reference_press import block, slab


def ball(radius, depth, rings=24):
    """A ball whose lowest point lies `depth` mm under the skin."""
    across, around = np.meshgrid(np.linspace(0.0, np.pi, rings + 1)[1:-1], np.arange(2 * rings) * np.pi / rings)
    shape = np.stack([np.sin(across) * np.cos(around), np.sin(across) * np.sin(around), np.cos(across)], axis=-1)
    vertices = np.concatenate([shape.transpose(1, 0, 2).reshape(-1, 3), [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]])
    sides, last = 2 * rings, len(vertices) - 2
    k = np.arange(sides)
    after = (k + 1) % sides
    faces = [np.stack([np.full(sides, last), k, after], axis=1)]
    for ring in range(rings - 2):
        a, b = ring * sides + k, ring * sides + after
        faces += [np.stack([a, a + sides, b + sides], axis=1), np.stack([a, b + sides, b], axis=1)]
    low = (rings - 2) * sides
    faces.append(np.stack([np.full(sides, last + 1), low + after, low + k], axis=1))
    return radius * vertices + [0.0, 0.0, radius - depth], np.concatenate(faces)


def pressed(product, spacing=1.0, half=8.0, **options):
    vertices, triangles, bone, modulus, held = slab(spacing, half)
    given = {"bone_mm": bone, "held": held.tolist()} | options
    return thenar.reference_press(
        vertices, triangles, given.pop("bone_mm"), modulus, product[0], product_triangles=product[1], **given
    )


def test_what_is_left_between_vertices_is_what_the_force_lacks():
    coarse, fine = pressed(ball(4.0, 1.5)), pressed(ball(4.0, 1.5), spacing=0.5)
    lacking = 1.0 - coarse.normal_force_n / fine.normal_force_n
    assert coarse.cut_mm > 0.1 > fine.cut_mm
    assert coarse.cut_share == pytest.approx(lacking, abs=0.03)
    assert pressed(ball(12.0, 0.5)).cut_mm < 0.05, "a wide ball lies on the skin"


@pytest.mark.parametrize("depth", [3.0, 3.5])
def test_a_ball_that_comes_through_the_skin_is_refused(depth):
    assert pressed(ball(4.0, 1.5)).normal_force_n > 0.0
    with pytest.raises(thenar.SolveError, match="between the vertices of the skin the product cuts") as raised:
        pressed(ball(4.0, depth))
    (vertex,) = raised.value.vertices
    assert np.linalg.norm(slab()[0][vertex]) < 5.0, "the place is under the ball"


def test_a_ball_under_the_skin_that_touches_no_vertex_is_refused():
    with pytest.raises(thenar.SolveError, match="between the vertices of the skin the product cuts"):
        pressed(ball(1.0, 2.5))


def test_skin_that_cannot_touch_lets_the_product_through():
    vertices = slab()[0]
    can_touch = vertices[:, 0] > 0.0
    found, whole = pressed(block(), can_touch=can_touch.tolist()), pressed(block())
    assert np.abs(found.force_n[~can_touch]).max() == 0.0
    assert np.abs(found.force_n[can_touch]).max() > 0.0
    assert 0.2 < found.normal_force_n / whole.normal_force_n < 0.7
    with pytest.raises(thenar.MeshError, match="array `can_touch`"):
        pressed(block(), can_touch=[True])


def tube(radius=8.0, sides=48, rings=30):
    """A finger along y: skin facing outward."""
    along, around = np.meshgrid(np.arange(rings + 1.0), np.arange(sides) * 2.0 * np.pi / sides, indexing="ij")
    vertices = np.stack([radius * np.cos(around), along, radius * np.sin(around)], axis=-1).reshape(-1, 3)
    k, row = np.meshgrid(np.arange(sides), np.arange(rings) * sides)
    a, b = (row + k).ravel(), (row + (k + 1) % sides).ravel()
    return vertices, np.concatenate([np.stack([a, a + sides, b + sides], 1), np.stack([a, b + sides, b], 1)])


def plate(top):
    """A plate under the middle of the tube, its upper side at `top`."""
    return np.array([[x, y, z] for x in (-30.0, 30.0) for y in (6.0, 24.0) for z in (-30.0, top)])


def test_a_product_that_reaches_into_the_bone_is_refused_by_place():
    with pytest.raises(thenar.SolveError, match=r"reaches 0\.5 mm into the bone under skin vertex") as raised:
        pressed(ball(12.0, 4.5), half=11.0)
    (vertex,) = raised.value.vertices
    assert np.linalg.norm(slab(half=11.0)[0][vertex]) < 1.0


def test_tissue_thicker_than_the_body_is_refused():
    vertices, triangles = tube()
    held = ((vertices[:, 1] < 0.5) | (vertices[:, 1] > 29.5)).tolist()

    def press(thickness):
        bone = thenar.bone_points(vertices, triangles, np.full(len(vertices), thickness))
        modulus = np.full(len(vertices), 0.01)
        return thenar.reference_press(vertices, triangles, bone, modulus, plate(-7.0), block()[1], held=held)

    assert press(5.0).normal_force_n > 0.0
    with pytest.raises(thenar.SolveError, match=r"where tissue is 9\.\d mm thick; give thinner tissue there") as raised:
        press(9.5)
    (vertex,) = raised.value.vertices
    assert vertices[vertex, 2] < -6.5


def test_a_sheet_is_refused():
    corners = np.array([[-3.0, -3.0, -0.5], [3.0, -3.0, -0.5], [3.0, 3.0, -0.5], [-3.0, 3.0, -0.5]])
    with pytest.raises(thenar.MeshError, match="give the sheet a thickness"):
        pressed((corners, np.array([[0, 2, 1], [0, 3, 2]])))


def test_triangles_turned_inward_are_named():
    vertices, triangles, bone, modulus, held = slab()
    with pytest.raises(thenar.MeshError, match="triangles are turned outward"):
        thenar.reference_press(vertices, triangles[:, ::-1], bone, modulus, *block(), held=held.tolist())


def test_limits_are_named():
    with pytest.raises(thenar.MeshError, match="layers: found -1; give 1 to 8"):
        pressed(block(), layers=-1)
    far = slab()[2]
    far[3, 1] = 2e6
    with pytest.raises(thenar.MeshError, match="array `bone`, vertex 3.*between -1e6 and 1e6 mm"):
        pressed(block(), bone_mm=far)
    vertices, triangles, *_ = slab()
    thickness = np.full(len(vertices), 4.0)
    thickness[7] = -2.0
    with pytest.raises(thenar.MeshError, match="array `thickness_mm`, vertex 7: found -2 mm; give 0 or more"):
        thenar.bone_points(vertices, triangles, thickness)
