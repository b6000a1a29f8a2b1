"""Which vertex of the hand is which of a study's skin: moved, mirrored, cut out, made anew, or another skin."""

import numpy as np
import pytest
from thenar_blender.scene import matching

EDGES = 40


def sheet(cells=EDGES, span=20.0):
    """A bent, lopsided sheet: vertices (n, 3), mm, and edges along its rows."""
    side = np.linspace(-span / 2, span / 2, cells + 1)
    x, y = (each.ravel() for each in np.meshgrid(side, side))
    points = np.column_stack([x, y, 0.05 * x**2 + 0.1 * y + 0.3 * np.sin(x)])
    first = np.arange(len(points)).reshape(cells + 1, cells + 1)
    edges = np.column_stack([first[:, :-1].ravel(), first[:, 1:].ravel()])
    return points, edges


def turn(axis, angle):
    """Rotation matrix by Rodrigues' formula."""
    axis = np.asarray(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def test_the_same_mesh_is_found_however_it_was_moved():
    hand, edges = sheet()
    rotation, shift = turn((1, 2, -1), 2.1), np.array([50.0, -7.0, 3.0])
    found = matching.match((hand - shift) @ rotation, hand, edges)
    assert np.allclose(found.rotation, rotation, atol=1e-9) and np.allclose(found.shift_mm, shift, atol=1e-6)
    assert np.allclose(found.point_mm((hand[17] - shift) @ rotation), hand[17], atol=1e-6)
    assert np.allclose(found.direction(rotation.T @ (0.0, 0.0, 1.0)), (0.0, 0.0, 1.0), atol=1e-9)
    assert list(found.on_hand([3, 1, 3])) == [1, 3]


def test_a_mirrored_skin_is_another_skin():
    hand, edges = sheet()
    assert matching.match(hand * (1.0, -1.0, 1.0) + (0.0, 0.0, 40.0), hand, edges) is None


def test_a_part_of_the_hand_is_found_in_its_place():
    hand, edges = sheet()
    inside = np.flatnonzero(np.abs(hand[:, :2]).max(axis=1) < 5.0)
    strays = np.array([[0.0, 0.0, 30.0]])
    found = matching.match(np.concatenate([hand[inside], strays]), hand, edges)
    assert np.array_equal(found.hand_of_other, [*inside, -1]), "the one that lies nowhere on it has no vertex"
    assert list(found.on_hand([0, len(inside)])) == [inside[0]]
    carried = found.carried([*np.arange(len(inside), dtype=float), 99.0])
    assert np.array_equal(np.flatnonzero(~np.isnan(carried) & (np.abs(hand[:, :2]).max(axis=1) < 5.0)), inside)
    assert np.isnan(carried[np.abs(hand[:, :2]).max(axis=1) > 6.0]).all()
    assert np.array_equal(carried[inside], np.arange(len(inside)))


@pytest.mark.parametrize("cells", [33, 47])
def test_the_same_surface_with_other_vertices_is_found(cells):
    hand, edges = sheet()
    other, _ = sheet(cells)
    found = matching.match(other, hand, edges)
    assert found is not None and (found.hand_of_other >= 0).mean() > 0.95
    apart = np.linalg.norm(
        hand[found.hand_of_other[found.hand_of_other >= 0]] - other[found.hand_of_other >= 0], axis=1
    )
    assert apart.max() < 0.75 * 0.6, "mm; the hand's spacing is half a millimetre and more where it is steep"


@pytest.mark.parametrize(
    "other",
    [sheet()[0] + (0.0, 0.0, 3.0), sheet(span=24.0)[0], np.zeros((0, 3))],
    ids=["away", "larger", "empty"],
)
def test_another_skin_is_not_taken_for_the_hand(other):
    hand, edges = sheet()
    keep = other[: len(other) - 1]
    assert matching.match(keep, hand, edges) is None
