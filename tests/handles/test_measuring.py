"""The measure sees what it has to: depths of closed forms, faces turned over, holes, sheets, a folded hand."""

import numpy as np
import pytest
from handles import measuring, random_products, shapes


@pytest.fixture
def rng():
    return np.random.default_rng(11)


@pytest.mark.parametrize("kind", ["box", "plate"])
def test_depth_in_a_body_of_flat_faces(kind, rng):
    made = random_products.draw(kind, rng)
    points = rng.uniform(made.vertices.min(axis=0) - 2.0, made.vertices.max(axis=0) + 2.0, (2000, 3))
    wanted = np.maximum(-made.distance(points), 0.0)
    assert measuring.depths(points, made.vertices, made.triangles) == pytest.approx(wanted, abs=1e-9)


def test_a_face_turned_over_and_a_lost_one_change_no_sign(rng):
    vertices, triangles = shapes.door_knob()
    points = rng.uniform(vertices.min(axis=0), vertices.max(axis=0), (1500, 3))
    is_in = measuring.inside(points, vertices, triangles)
    turned = triangles.copy()
    turned[::3] = turned[::3, ::-1]
    assert (measuring.inside(points, vertices, turned) == is_in).all()
    assert is_in.any() and not is_in.all()
    deep = measuring.distances(points, vertices, triangles)[0] > 3.0
    assert (measuring.inside(points, vertices, np.delete(triangles, 400, axis=0)) == is_in)[deep].all()


def test_a_sheet_has_no_inside_and_a_cup_only_its_wall(rng):
    sheet = random_products.draw("sheet", rng)
    assert not measuring.inside(rng.uniform(-40.0, 40.0, (500, 3)), sheet.vertices, sheet.triangles).any()
    vertices, triangles = shapes.tube()
    points = np.array([[0.0, 0.0, 10.0], [15.5, 0.0, 3.0], [0.0, -15.6, 70.0], [20.0, 0.0, 0.0]])
    assert measuring.inside(points, vertices, triangles).tolist() == [False, True, True, False]


def test_parts_that_stand_in_each_other_are_one():
    vertices, triangles = shapes.dumbbell()
    inner = np.array([[1.0, 2.0, -64.0], [3.0, 1.0, 0.0], [3.0, 20.0, 80.0], [3.0, 30.0, 0.0]])
    assert measuring.inside(inner, vertices, triangles).tolist() == [True, True, True, False]


@pytest.mark.parametrize("sunk_mm", [0.04, 0.1, 1.0])
def test_a_planted_penetration_is_measured(sunk_mm):
    low, high = np.array([-10.0, -20.0, -5.0]), np.array([10.0, 20.0, 5.0])
    vertices, triangles = random_products.block(low, high, 3)
    points = np.array([[1.0, 2.0, 5.0 - sunk_mm], [1.0, 2.0, 5.0 + sunk_mm], [-10.0 + sunk_mm, 0.3, 0.7]])
    assert measuring.depths(points, vertices, triangles) == pytest.approx([sunk_mm, 0.0, sunk_mm], abs=1e-9)


def test_what_lies_under_a_skin_that_runs_through_itself(rng):
    ball = random_products.draw("ball", rng)
    radius = ball.sizes["radius"]
    hand, triangles = random_products.joined(
        [(ball.vertices, ball.triangles), (ball.vertices + [radius, 0.0, 0.0], ball.triangles)]
    )
    samples = np.array([[0.5 * radius, 0.0, 0.0], [-0.9 * radius, 0.0, 0.0], [0.0, 1.2 * radius, 0.0]])
    assert measuring.winding(samples, hand, triangles).tolist() == [2, 1, 0]
    skin = hand[:, 0] < 0.3 * radius
    under = measuring.sunk(samples, hand, triangles, skin, within_mm=radius)
    assert under[1] == pytest.approx(0.1 * radius, rel=0.15) and under[2] == 0.0


@pytest.mark.parametrize("name", list(shapes.SHAPES))
def test_handles_are_what_designers_model(name):
    """Every part wound one way and outward; closed but for the stick's bottom, which its base hides."""
    vertices, triangles = shapes.SHAPES[name]()
    label = measuring.parts(vertices, triangles)
    for part in range(label.max() + 1):
        faces = triangles[label == part]
        sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
        assert len(np.unique(sides, axis=0)) == len(sides)
        uses = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)[1]
        assert (uses == 2).all() or name == "joystick"
        a, b, c = (vertices[faces[:, k]] for k in range(3))
        assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() > 0.0
    assert np.linalg.norm(vertices, axis=1).max() < 800.0
