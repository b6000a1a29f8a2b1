"""Where a product is held goes along with it: the same spots however it was turned and moved."""

import numpy as np
import pytest
import thenar
from handles import shapes
from scipy.spatial.transform import Rotation
from thenar_blender.grasp_fit import places

NOISE_MM = 1e-5
"""What single precision leaves of coordinates of a few hundred mm."""


@pytest.mark.parametrize("name", list(shapes.SHAPES))
def test_own_frame_goes_along(name):
    vertices, triangles = arrays(name)
    first, axes = places.own_frame(vertices, triangles)
    for turned, motion in moved(vertices):
        origin, own = places.own_frame(turned, triangles)
        assert motion(first[None])[0] == pytest.approx(origin, abs=1e-3)
        assert (turned - origin) @ own == pytest.approx((vertices - first) @ axes, abs=1e-3)


@pytest.mark.parametrize("name", list(shapes.SHAPES))
def test_spots_of_the_own_frame_are_the_same(name):
    vertices, triangles = arrays(name)
    first = spots(vertices, triangles)
    for turned, _ in moved(vertices):
        again = spots(turned, triangles)
        assert len(again) == len(first)
        for one, other in zip(first, again, strict=True):
            assert one.center == pytest.approx(other.center, abs=1e-2)
            assert one.axis == pytest.approx(other.axis, abs=1e-3)
            assert one.cost == pytest.approx(other.cost, abs=1e-3)


def test_the_bar_of_a_dumbbell_goes_before_its_heads():
    best = spots(*arrays("dumbbell"))[0]
    assert best.radius_mm == pytest.approx(16.0, abs=1.5)
    assert np.linalg.norm(np.cross(best.axis, [1.0, 0.0, 0.0])) < 0.1, "the own frame's first axis is the longest one"


def test_an_open_hollow_counts_as_a_bar():
    vertices, triangles = arrays("joystick")
    best = places.spots(thenar.Product(vertices, triangles), vertices, triangles)[0]
    assert 14.0 < best.radius_mm < 23.0, "the stick is a shell without a bottom"
    assert abs(best.axis[2]) > 0.9 and -60.0 < best.center[2] < 55.0, "the stick stands upright on its base"


def test_an_origin_on_the_product_marks_a_spot():
    vertices, triangles = arrays("steering wheel")
    product = thenar.Product(vertices, triangles)
    far = [spot.center for spot in places.spots(product, vertices, triangles)]
    near = [spot.center for spot in places.spots(product, vertices, triangles, np.zeros(3))]
    assert min(np.linalg.norm(near, axis=1)) < 1e-9
    assert min(np.linalg.norm(far, axis=1)) > 5.0


def arrays(name):
    vertices, triangles = shapes.SHAPES[name]()
    return np.asarray(vertices, float), np.asarray(triangles)


def moved(vertices):
    """The vertices under three rigid motions, with noise as of single precision, and each motion."""
    rng = np.random.default_rng(5)
    for seed in range(3):
        turn, shift = Rotation.random(random_state=seed).as_matrix(), rng.uniform(-300.0, 300.0, 3)

        def motion(points, turn=turn, shift=shift):
            return points @ turn.T + shift

        yield motion(vertices) + rng.uniform(-NOISE_MM, NOISE_MM, vertices.shape), motion


def spots(vertices, triangles):
    """Spots in the product's own frame, as the search asks for them."""
    origin, axes = places.own_frame(vertices, triangles)
    local = (vertices - origin) @ axes
    return places.spots(thenar.Product(local, triangles), local, triangles)
