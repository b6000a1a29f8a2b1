"""Curves over time: the numbers of each frame are right, drawn where they belong, and a click shows the frame."""

import json
import math
from pathlib import Path
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
import stage
import test_panels
from test_recordings import write_asf
from thenar_blender.curves import pictures, tables
from thenar_blender.recordings import over_time
from thenar_blender.views import legend

FRAMES = (1, 2, 3, 4)


@pytest.fixture
def baked_scene(tmp_path):
    """A plate that rises into the pad until frame 3 and sinks again, baked; returns hand and product."""
    hand, product = stage.scene(top=-7.5)
    for frame, depth in zip(FRAMES, (0.1, 0.3, 0.6, 0.2), strict=True):
        stage.raise_under(hand, product, depth=depth)
        product.keyframe_insert("location", frame=frame)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    bpy.ops.thenar.bake(frame_start=1, frame_end=4)
    return hand, product


def buttons(panel):
    """(source, frame, pressed) of every button that shows a frame, as the panel draws them."""
    found = []

    class Listening(test_panels.Layout):
        def operator(self, name, text=None, icon="NONE", depress=False, emboss=True):
            properties = super().operator(name, text, icon, depress, emboss)
            if name == "thenar.show_frame":
                found.append((properties, depress, text))
            return properties

    panel.draw(SimpleNamespace(layout=Listening(80, [])), test_panels.Context())
    return [(each.source, each.frame, pressed, text) for each, pressed, text in found]


def test_the_numbers_of_a_bake_are_those_of_its_frames(baked_scene):
    table = tables.of(bpy.context, tables.BAKE)
    bpy.ops.thenar.clear()
    expected = []
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        found = stage.solve()
        expected.append((found.force_n, found.area_mm2 / 100.0, found.peak_kpa))
        bpy.ops.thenar.clear()
    forces = [row[0] for row in expected]
    assert max(forces) == forces[2] > 2 * forces[0], "the plate rises until frame 3"
    assert list(table.frames) == list(FRAMES)
    for column, values in zip(table.columns, zip(*expected, strict=True), strict=True):
        np.testing.assert_allclose(column.values, values, rtol=2e-3)
    assert [(column.title, column.unit) for column in table.columns] == [
        ("Force", "N"), ("Area", "cm²"), ("Peak", "kPa"),
    ]  # fmt: skip


def test_a_click_shows_the_frame_of_the_bake(baked_scene):
    hand, _ = baked_scene
    bpy.context.scene.frame_set(1)
    table = tables.of(bpy.context, tables.BAKE)
    strip = [row for row in buttons(bpy.types.THENAR_PT_bake) if not row[3]]
    assert [frame for _, frame, *_ in strip] == list(FRAMES) and [row[2] for row in strip] == [
        True,
        False,
        False,
        False,
    ]
    assert bpy.ops.thenar.show_frame(source="BAKE", frame=strip[2][1]) == {"FINISHED"}
    assert bpy.context.scene.frame_current == 3
    assert math.isclose(stage.attribute(hand, "pressure_kpa").max(), table.columns[2].values[2], rel_tol=0.05)
    assert [row[2] for row in buttons(bpy.types.THENAR_PT_bake) if not row[3]] == [False, False, True, False]
    largest = [row for row in buttons(bpy.types.THENAR_PT_bake) if row[3]]
    assert [row[1] for row in largest] == [3, 3], "Max. Force and Max. Peak"


def test_a_bake_moved_in_its_modifier_is_shown_where_it_plays(baked_scene):
    hand, _ = baked_scene
    (cache,) = hand.modifiers
    cache.frame_start += 10
    table = tables.of(bpy.context, tables.BAKE)
    assert list(table.frames) == [11, 12, 13, 14]
    bpy.ops.thenar.show_frame(source="BAKE", frame=13)
    shown = stage.attribute(hand, "pressure_kpa").max()
    assert math.isclose(shown, table.columns[2].values[2], rel_tol=0.05)


def test_the_range_fits_the_whole_bake_and_the_legend_says_what_is_above_it(baked_scene):
    look = bpy.context.scene.thenar
    bpy.ops.thenar.show_map(kind="PRESSURE")
    peaks = tables.of(bpy.context, tables.BAKE).columns[2].values
    bpy.context.scene.frame_set(1)
    assert bpy.ops.thenar.reset_range() == {"FINISHED"}
    assert look.maps.shown == "PRESSURE" and peaks.max() <= look.range_kpa < 2 * peaks.max()
    look.range_kpa = (peaks[0] + peaks[2]) / 2.0
    assert peaks[0] < look.range_kpa < peaks[2]
    assert not legend.exceeds(look, look.result)
    bpy.context.scene.frame_set(3)
    assert legend.exceeds(look, look.result)


def known_frames():
    """Pressures (frames, rows, columns), kPa: a patch of 2, 3 and 6 cells that carries 10, 40 and 20 kPa."""
    frames = np.zeros((3, 4, 5))
    for frame, cells, kpa in zip(frames, (2, 3, 6), (10.0, 40.0, 20.0), strict=True):
        frame.flat[:cells] = kpa
    return frames


def test_the_numbers_of_a_recording_are_those_of_its_cells(tmp_path):
    stage.scene()
    path = write_asf(tmp_path / "mat.asf", known_frames())
    head = dict(line.split(maxsplit=1) for line in Path(path).read_text("utf-8").splitlines() if "SPACING" in line)
    pitch, across = (float(head[name].split()[0]) for name in ("ROW_SPACING", "COL_SPACING"))
    bpy.ops.thenar.load_recording(filepath=str(path))
    table = tables.of(bpy.context, tables.RECORDING)
    cell = pitch * across
    np.testing.assert_allclose(
        table.columns[0].values, [2 * 10 * cell / 1e3, 3 * 40 * cell / 1e3, 6 * 20 * cell / 1e3], rtol=1e-3
    )
    np.testing.assert_allclose(table.columns[1].values, [2 * cell / 100, 3 * cell / 100, 6 * cell / 100], rtol=1e-3)
    np.testing.assert_allclose(table.columns[2].values, [10, 40, 20], rtol=1e-3)
    assert [column.unit for column in table.columns] == ["N", "cm²", "kPa"]


def test_a_click_shows_the_frame_of_the_recording_and_the_timeline_follows(tmp_path):
    stage.scene()
    bpy.ops.thenar.load_recording(filepath=str(write_asf(tmp_path / "mat.asf", known_frames())))
    item, scene = bpy.context.scene.thenar_recordings.items[0], bpy.context.scene
    strip = [row for row in buttons(bpy.types.THENAR_PT_recordings) if not row[3]]
    assert [(source, frame) for source, frame, *_ in strip] == [("RECORDING", number) for number in (1, 2, 3)]
    bpy.ops.thenar.show_frame(source="RECORDING", frame=3)
    assert (item.frame_rule, item.frame) == ("NUMBER", 3)
    item.follows_timeline = True
    bpy.ops.thenar.show_frame(source="RECORDING", frame=2)
    assert scene.frame_current == scene.frame_start + 1
    assert not test_panels.too_long(test_panels.draw())


def test_raw_counts_have_no_unit(tmp_path):
    stage.scene()
    bpy.ops.thenar.load_recording(filepath=str(write_asf(tmp_path / "raw.asf", known_frames(), units="Raw")))
    table = tables.of(bpy.context, tables.RECORDING)
    assert [(column.title, column.unit) for column in table.columns] == [("Sum", ""), ("Cells", ""), ("Peak", "")]
    np.testing.assert_allclose(table.columns[0].values, [20, 120, 120])
    np.testing.assert_allclose(table.columns[1].values, [2, 3, 6])


def test_a_long_recording_keeps_its_largest_frame():
    values = np.ones((5000, 3))
    values[3333], values[1234, 0] = 7.0, 19.0
    kept = json.loads(over_time.kept(values, np.ones(3), True))
    assert len(kept["frame"]) < 600 and kept["frame"][0] == 1 and kept["frame"][-1] == 5000
    assert max(kept["force"]) == 0.021 and kept["frame"][kept["force"].index(0.021)] in (1235, 3334)
    assert max(kept["peak"]) == 19.0 and kept["frame"][kept["peak"].index(19.0)] == 1235


def test_nothing_over_time_is_refused():
    stage.scene()
    with pytest.raises(RuntimeError, match="there are no frames to show|There are no frames to show"):
        bpy.ops.thenar.show_frame(source="BAKE", frame=1)


def drawn(values, side=160):
    """The picture of three columns of which the first holds `values`, rows from above."""
    values = np.asarray(values, float)
    columns = tuple(tables.Column(name, "", values if name == "a" else np.ones(len(values))) for name in "abc")
    return pictures.curves(tables.Table(tables.BAKE, np.arange(len(values)), columns, 0), side)[::-1], side


def test_a_straight_rise_is_drawn_from_corner_to_corner():
    image, side = drawn(np.arange(11.0))
    band = side // 3
    blue = image[:band, :, 2]
    for share in (0.1, 0.5, 0.9):
        column = round(pictures.INSET + share * (side - 1 - 2 * pictures.INSET))
        row = blue[:, column].argmax()
        assert abs(row - (band - 1 - 5 - share * (band - 11))) <= 1.5, share
        assert blue[row, column] > 0.8 and blue[max(row - 6, 0), column] < 0.2, "above the curve is paper"


def test_a_peak_of_one_frame_in_many_is_seen():
    values = np.zeros(4001)
    values[1000] = 5.0
    image, side = drawn(values)
    column = round(pictures.INSET + 0.25 * (side - 1 - 2 * pictures.INSET))
    assert image[3:9, column - 1 : column + 2, 2].max() > 0.8


def test_the_line_is_at_the_shown_frame():
    image, side = drawn(np.arange(5.0))
    for share in (0.0, 0.5, 1.0):
        line = pictures.marked(image, share)
        (changed,) = np.nonzero((line != image).any(axis=(0, 2)))
        assert len(changed) == 1 and changed[0] == round(pictures.INSET + share * (side - 1 - 2 * pictures.INSET))


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [(0.043, "N", "0.043 N"), (0.27, "cm²", "0.27 cm²"), (61.84, "cm²", "61.8 cm²"), (1234.5, "kPa", "1234 kPa")],
)
def test_small_numbers_keep_their_digits(value, unit, text):
    assert tables.Column("", unit, np.array([value])).said(0) == text


def test_a_damaged_bake_draws_no_curve_and_raises_nothing(baked_scene):
    from thenar_blender.scene import baked

    hand, _ = baked_scene
    place = Path(baked._path(hand))
    place.write_bytes(place.read_bytes()[:200])
    baked._loaded.clear()
    assert tables.of(bpy.context, tables.BAKE) is None
    assert baked.notes(hand, [])[0].startswith("its file is missing or damaged")


@pytest.mark.parametrize("text", ["", "{", "[1]", '{"unit": "kPa"}'])
def test_text_that_is_no_curve_draws_none(text):
    assert tables._read(text) is None
