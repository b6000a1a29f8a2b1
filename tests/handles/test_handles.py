"""Grasps through the add-on's buttons that once threw skin away or were refused: now sound; and the verdict itself.

`tests/bench/handles.py` does all twelve handles with five hands and six starts.
"""

import numpy as np
import pytest

pytest.importorskip("bpy")

from handles import everyday, grasping, random_products, shapes  # noqa: E402

BULB = (
    (8, 14, 17, 18.5, 18.5, 16.5, 18, 19, 17, 13, 11, 14, 14, 5),
    (-62, -60, -56, -48, -20, 0, 20, 38, 46, 50, 55, 60, 62, 63),
)
THIN = (2, 9, 10, 10, 2), (-75, -74, -60, 70, 71)


def turned(profile, flat):
    """A profile of radii and heights about z, its y scaled, both ends capped."""
    across, along = ([0.0, *profile[0], 0.0], [profile[1][0], *profile[1], profile[1][-1]])
    vertices, triangles = random_products.revolved(np.array(across), np.array(along, float), 40)
    return vertices * [1.0, flat, 1.0], triangles


CASES = {
    "bulb, 50, made": (lambda: turned(BULB, 0.82), 50.0, "made"),
    "thin, 5, made": (lambda: turned(THIN, 1.0), 5.0, "made"),
    "tube, 50, made": (shapes.tube, 50.0, "made"),
    "door knob, 50, made": (shapes.door_knob, 50.0, "made"),
    "steering wheel, 95, made": (shapes.steering_wheel, 95.0, "made"),
    "pistol grip, 50, made": (shapes.pistol_grip, 50.0, "made"),
    "toothbrush, 50, made": (shapes.toothbrush, 50.0, "made"),
    "phone, 50, tilted": (everyday.SHAPES["phone"], 50.0, "tilted"),
    "marble, 50, tilted": (everyday.SHAPES["marble"], 50.0, "tilted"),
}


@pytest.fixture(scope="module", autouse=True)
def addon():
    import thenar_blender

    thenar_blender.register()
    yield
    thenar_blender.unregister()


@pytest.fixture(scope="module")
def rows():
    return {}


@pytest.mark.parametrize("name", CASES)
def test_grasp_is_sound_or_refused(name, rows):
    shape, percentile, start = CASES[name]
    rows[name] = grasping.grasp(shape(), percentile, start)
    assert grasping.faults(rows[name]) == [], rows[name]


NOT_MET = pytest.mark.xfail(reason="25.03 degrees since fingers share the grip: not met", strict=True)


@pytest.mark.parametrize(
    "name", ["bulb, 50, made", "tube, 50, made", pytest.param("steering wheel, 95, made", marks=NOT_MET)]
)
def test_the_thumb_opposes_the_index_finger(name, rows):
    """In a power grip the thumb's pad faces the index finger's within 25 degrees; no last joint is bent back."""
    assert rows[name]["force_n"] > 45.0, rows[name]
    assert rows[name]["thumb_off_deg"] <= 25.0 and rows[name]["dip_back_deg"] <= 10.0, rows[name]


def test_few_are_refused(rows):
    assert rows and sum(map(grasping.is_refused, rows.values())) <= 1, rows


def ball_on_block():
    """A ball of 20 mm that lies 2 mm deep in a block, and the same pressed flat where it lay inside."""
    turn, count = np.linspace(0.0, np.pi, 31), 60
    before, triangles = random_products.revolved(20.0 * np.sin(turn), -20.0 * np.cos(turn), count)
    before[:, 2] += 18.0
    after = before.copy()
    after[:, 2] = np.maximum(after[:, 2], 0.0)
    return before, after, triangles, random_products.block([-30.0, -30.0, -10.0], [30.0, 30.0, 0.0], 4)


@pytest.mark.parametrize(
    ("lift_mm", "sink_mm", "wanted"),
    [(0.0, 0.0, []), (4.0, 0.0, []), (9.0, 0.0, ["spike"]), (0.0, 0.04, []), (0.0, 0.1, ["inside"])],
)
def test_planted_faults_are_seen(lift_mm, sink_mm, wanted):
    before, after, triangles, (vertices, faces) = ball_on_block()
    lowest, raised = before[:, 2].argmin(), np.abs(before[:, 2] - 6.0).argmin()
    after[raised] += [0.0, 0.0, lift_mm]
    after[lowest] -= [0.0, 0.0, sink_mm]
    skin = np.ones(len(before), bool)
    row = grasping.compared(grasping.Shown(before, after, triangles, skin), vertices, faces)
    assert row["deepest_mm"] == pytest.approx(2.0)
    assert row["left_mm"] == pytest.approx(sink_mm, abs=1e-9)
    assert grasping.faults(row | {"peak_kpa": 100.0}) == wanted


def test_a_second_patch_may_not_hide_behind_a_deep_one():
    """A patch that lay 0.5 mm deep and moved 4 mm is a spike, however deep another one lay."""
    before, after, triangles, (vertices, faces) = ball_on_block()
    shallow = before + [0.0, 0.0, 1.5]
    flat = shallow.copy()
    flat[:, 2] = np.maximum(flat[:, 2], 0.0)
    flat[shallow[:, 2].argmin()] += [0.0, 0.0, 3.6]
    away, count = np.array([45.0, 0.0, 0.0]), len(before)
    deep = before + away - [0.0, 0.0, 1.0]
    pressed = deep.copy()
    pressed[:, 2] = np.maximum(pressed[:, 2], 0.0)
    shown = grasping.Shown(
        np.concatenate([shallow, deep]),
        np.concatenate([flat, pressed]),
        np.concatenate([triangles, triangles + count]),
        np.ones(2 * count, bool),
    )
    row = grasping.compared(shown, vertices * [4.0, 1.0, 1.0], faces)
    assert row["moved_mm"] <= row["deepest_mm"] + grasping.SPARE_MM
    assert row["patches"] == 2 and "patch" in grasping.faults(row | {"peak_kpa": 100.0})
