"""`thenar.hand` gives arrays that fit together, and refuses hands that nobody has."""

import numpy as np
import pytest
import thenar


@pytest.fixture(scope="module")
def hand():
    return thenar.hand(spacing_mm=5)


def test_arrays_fit_together(hand):
    count = len(hand.vertices_mm)
    assert hand.vertices_mm.shape == (count, 3) and hand.vertices_mm.dtype == np.float64
    assert hand.triangles.dtype == np.int32 and hand.triangles.min() == 0 and hand.triangles.max() == count - 1
    assert hand.regions.shape == (count,) and hand.regions.dtype == np.int32
    assert set(np.unique(hand.regions)) == set(range(-1, 19))
    assert len(hand.region_names) == len(hand.kind) == len(hand.thickness_mm) == 19
    assert len(set(hand.region_names)) == 19 and set(hand.kind) == {"finger", "palm"}
    assert hand.nails.dtype == bool and (hand.regions[hand.nails] == -1).all()


def test_bones_form_a_tree_and_weights_share_every_vertex(hand):
    names = [bone.name for bone in hand.bones]
    assert len(set(names)) == len(names)
    for place, bone in enumerate(hand.bones):
        assert bone.parent is None or names.index(bone.parent) < place
        assert len(bone.head_mm) == len(bone.tail_mm) == 3 and bone.head_mm != bone.tail_mm
        assert np.linalg.norm(bone.flexion_axis) == pytest.approx(1)
        assert bone.limits_deg.flexion[0] <= bone.limits_deg["flexion"][1]
        assert -180 <= bone.limits_deg.abduction[0] <= bone.limits_deg.abduction[1] <= 180
    assert hand.weights.shape == (len(hand.vertices_mm), len(names)) and hand.weights.dtype == np.float32
    assert (hand.weights >= 0).all() and np.allclose(hand.weights.sum(axis=1), 1, atol=1e-5)


def test_a_left_hand_is_the_mirror_of_a_right_one(hand):
    left = thenar.hand(side="left", spacing_mm=5)
    assert np.allclose(left.vertices_mm * (-1, 1, 1), hand.vertices_mm)
    assert np.array_equal(left.regions, hand.regions)


def test_the_hand_can_be_pressed(hand):
    skin = thenar.Skin(hand.vertices_mm, hand.triangles, hand.regions, region_names=hand.region_names)
    square = 150.0 * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    above = hand.vertices_mm.mean(axis=0) * (1, 1, 0) + (0, 0, hand.vertices_mm[:, 2].max() + 1)
    plate = above + np.concatenate([square, square + (0, 0, 6)])
    sides = [t for k in range(4) for t in ([k, (k + 1) % 4, k + 4], [(k + 1) % 4, (k + 1) % 4 + 4, k + 4])]
    contact = skin.press(plate, [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], *sides], force_n=1.0, direction=(0, 0, -1))
    assert abs(contact.total_force_n[2]) == pytest.approx(1, rel=1e-3)
    assert sum(row.force_n for row in contact.regions) == pytest.approx(contact.force_n.sum())


@pytest.mark.parametrize(
    ("keywords", "sentence"),
    [
        ({"length_mm": 20}, "hand length is 20"),
        ({"percentile": 100}, "percentile is 100"),
        ({"spacing_mm": 0}, "spacing"),
        ({"length_mm": "long"}, "^length_mm: expected a number, got str"),
        ({"breadth_mm": float("nan")}, "^breadth_mm: NaN"),
        ({"sex": "x"}, '^sex: there is no "x"; choose "male" or "female"'),
        ({"side": "up"}, '^side: there is no "up"; choose "right" or "left"'),
    ],
)
def test_hands_that_nobody_has_are_refused(keywords, sentence):
    with pytest.raises(thenar.MeshError, match=sentence):
        thenar.hand(**keywords)


def test_making_a_hand_can_be_cancelled():
    with pytest.raises(thenar.Cancelled):
        thenar.hand(cancel=lambda: True)
