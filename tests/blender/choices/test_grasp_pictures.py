"""Pictures of grasps and the words on why one ranks lower."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from thenar_blender.grasp_choices import panel, picture, reasons

VIEW = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0))


def sheet(z, size):
    """Points and normals of a square facing z."""
    x, y = np.meshgrid(np.linspace(-size, size, 200), np.linspace(-size, size, 200))
    points = np.stack([x.ravel(), y.ravel(), np.full(x.size, z)], axis=1)
    return points, np.tile([0.0, 0.0, 1.0], (len(points), 1))


def test_nearer_surface_hides_the_other():
    wide, small = sheet(0.0, 50.0), sheet(10.0, 20.0)
    in_front = picture.shaded(small, wide, VIEW)
    middle, edge = in_front[picture.SIZE // 2, picture.SIZE // 2], in_front[picture.SIZE // 2, 12]
    assert picture.HAND <= middle < picture.PRODUCT <= edge
    behind = picture.shaded((small[0] - [0.0, 0.0, 20.0], small[1]), wide, VIEW)
    assert behind[picture.SIZE // 2, picture.SIZE // 2] >= picture.PRODUCT


def test_surface_that_faces_away_is_not_drawn():
    points, normals = sheet(0.0, 50.0)
    assert not picture.shaded((points, -normals), (points, -normals), VIEW).any()


def test_picture_survives_its_text():
    codes = np.random.default_rng(4).integers(0, 128, (picture.SIZE, picture.SIZE), np.uint8)
    assert (picture.unpacked(picture.packed(codes)) == codes).all()
    with pytest.raises(ValueError, match="no picture"):
        picture.unpacked("AAAA")


def test_nothing_is_clear_and_the_rest_is_not():
    codes = picture.shaded(sheet(10.0, 20.0), sheet(0.0, 50.0), VIEW)
    codes[:3] = 0
    assert ((picture.colored(codes)[..., 3] > 0.0) == (codes > 0)).all()


def test_row_without_a_picture_has_no_icon():
    assert panel.icon("") == 0


def row(kind="POWER", score=1.0, clear=4, **counted):
    causes = dict.fromkeys(("touch", "balance", "sum", "peak", "deep", "slips", "thumb", "place"), 0.0) | counted
    said = {"asked_n": 200.0, "net_share": 0.3, "peak_kpa": 700.0, "clear": clear, "pads": 19, "end": 1}
    facts = json.dumps({"counted": causes, **said})
    return SimpleNamespace(kind=kind, score=score, facts=facts, total_n=120.0, net_n=36.0, friction=0.9)


@pytest.mark.parametrize(
    ("cause", "words"),
    [
        ("touch", "4 of 19 pads hang clear"),
        ("balance", "Leaves 30% of its forces over"),
        ("sum", "Carries 120 of 200 N"),
        ("peak", "Presses up to 700 kPa"),
        ("slips", "needs a friction of 0.90 where 0.38 is there"),
        ("thumb", "The thumb's pad faces away"),
        ("place", "suits the hand less"),
        ("deep", "too deep"),
        ("settled", "Not balanced to the end"),
        ("refused", "not to be used"),
        ("bare", "Leaves thumb and palm out"),
    ],
)
def test_the_largest_cause_is_named(cause, words):
    own = row(score=3.0, **{cause: 2.0, "place": 0.1 + 2.0 * (cause == "place")})
    assert words in reasons.why(own, row(clear=1), 0.38)


def test_as_many_clear_pads_are_no_reason():
    assert "less deep" in reasons.why(row(score=3.0, touch=2.0), row(), 0.38)


def test_grasps_that_nothing_sets_apart_are_about_as_good():
    assert reasons.why(row(score=1.0), row(), 0.38) == "About as good"


def test_better_score_of_another_kind_is_explained():
    assert "Power goes first" in reasons.why(row("PINCH", 0.5), row(score=2.0), 0.38)


def test_rows_of_older_files_have_no_reason():
    old = row()
    old.facts = ""
    assert reasons.why(old, row(), 0.38) == ""
