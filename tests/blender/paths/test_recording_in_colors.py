"""A recording on its product: colors of its own pressures on the range of the map, the simulated next to it, frames."""

import json
import math
from concurrent.futures import ThreadPoolExecutor

import bpy
import numpy as np
import pytest
import stage
from mathutils import Matrix
from test_recordings import PITCH, SIDE, read_by_hand, write_asf
from thenar_blender import colormap, native
from thenar_blender.recordings import loading

LEFT, RIGHT = "Thenar Mat Recorded", "Thenar Mat Simulated"


def recordings():
    return bpy.context.scene.thenar_recordings


def by_cell(name, attribute="pressure_kpa"):
    """What the cells of a shown mat carry (n,) or (n, k), each from its four corners, which must agree."""
    values = stage.attribute(bpy.data.objects[name], attribute)
    corners = values.reshape(-1, 4, *values.shape[1:])
    assert (corners == corners[:, :1]).all()
    return corners[:, 0]


def words():
    home = next(each for each in bpy.context.scene.collection.children if "thenar_labels" in each)
    return json.loads(home["thenar_labels"])


@pytest.fixture
def pressed(tmp_path):
    """Ball on plate, solved, and a mat of three frames, 0.5, 1 and 1.5 times what it reads. Returns the middle one."""
    hand, product = stage.pad(fineness=5), stage.plate(top=-6.3)
    settings = bpy.context.scene.thenar
    settings.hand, settings.product = hand, product
    bpy.context.view_layer.update()
    stage.solve()
    frame = read_by_hand(hand)
    bpy.ops.thenar.load_recording(filepath=write_asf(tmp_path / "mat.asf", [0.5 * frame, frame, 1.5 * frame]))
    placing = recordings().items[0].placing
    placing.on, placing.axis = "PLANE", "+Z"
    return frame


def test_cells_lie_on_the_product_and_read_their_own_frame(pressed):
    hand, product = bpy.context.scene.thenar.hand, bpy.context.scene.thenar.product
    assert bpy.ops.thenar.show_recording() == {"FINISHED"}
    assert by_cell(LEFT) == pytest.approx(pressed.ravel(), abs=1e-3)
    places = stage.evaluated(bpy.data.objects[LEFT]).reshape(-1, 4, 3).mean(axis=1)
    rows, columns = np.divmod(np.arange(SIDE**2), SIDE)
    assert places[:, 0] == pytest.approx((columns + 0.5 - SIDE / 2) * PITCH, abs=1e-3)
    assert places[:, 1] == pytest.approx((rows + 0.5 - SIDE / 2) * PITCH, abs=1e-3)
    assert (places[:, 2] > -6.3).all() and (places[:, 2] < -5.3).all()
    assert hand.hide_get() and product.hide_get() and RIGHT not in bpy.data.objects
    force = (pressed.sum() * PITCH**2) / 1e3
    assert words()["texts"] == [f"Recorded, frame 2 of 3\n{force:.0f} N, peak {pressed.max():.0f} kPa"]
    assert bpy.ops.thenar.look_back() == {"FINISHED"}
    assert not hand.hide_get() and not product.hide_get() and LEFT not in bpy.data.objects


def test_the_same_pressure_has_the_same_color_on_the_recording_the_simulation_and_the_map(pressed):
    look = bpy.context.scene.thenar
    look.range_kpa = 2.0 * float(pressed.max())
    bpy.ops.thenar.show_recording()
    assert bpy.ops.thenar.compare() == {"FINISHED"}
    for name in (LEFT, RIGHT):
        kpa, color = by_cell(name), by_cell(name, "Thenar Pressure")
        loaded = kpa > 0.0
        assert loaded.sum() > 20
        expected = colormap.to_linear(colormap.srgb(look.palette, kpa[loaded] / look.range_kpa))
        assert color[loaded][:, :3] == pytest.approx(expected, abs=1e-3), name
    before = by_cell(LEFT, "Thenar Pressure").copy()
    look.range_kpa = float(pressed.max())
    kpa = by_cell(LEFT)
    expected = colormap.to_linear(colormap.srgb(look.palette, kpa[kpa > 0] / look.range_kpa))
    assert by_cell(LEFT, "Thenar Pressure")[kpa > 0][:, :3] == pytest.approx(expected, abs=1e-3)
    assert np.abs(by_cell(LEFT, "Thenar Pressure") - before).max() > 0.1


def test_the_simulated_mat_reads_the_contact_and_lies_apart(pressed):
    bpy.ops.thenar.show_recording()
    bpy.ops.thenar.compare()
    simulated = by_cell(RIGHT)
    area = PITCH**2
    assert simulated.sum() * area / 1e3 == pytest.approx(bpy.context.scene.thenar.result.force_n, rel=0.03)
    middle = np.average(np.arange(SIDE**2) // SIDE, weights=simulated)
    assert middle == pytest.approx((SIDE - 1) / 2, abs=0.5)
    boxes = [stage.evaluated(bpy.data.objects[name]) for name in (LEFT, RIGHT)]
    low, high = (np.array([box.min(axis=0), box.max(axis=0)]) for box in boxes)
    assert (low[1] < high[0]).any() or (high[1] < low[0]).any()
    assert words()["texts"][1].startswith("Simulated\n")


def test_a_mat_that_was_moved_after_it_was_compared_has_no_simulation(pressed):
    bpy.ops.thenar.show_recording()
    bpy.ops.thenar.compare()
    before = stage.evaluated(bpy.data.objects[LEFT])
    recordings().items[0].placing.shift_mm[1] = 3.0
    after = stage.evaluated(bpy.data.objects[LEFT])
    assert np.abs(after - before).max(axis=0) == pytest.approx([3.0, 0.0, 0.0], abs=1e-3)
    assert RIGHT not in bpy.data.objects and len(words()["texts"]) == 1
    bpy.ops.thenar.compare()
    assert RIGHT in bpy.data.objects


def test_the_timeline_chooses_the_frame_and_the_frame_moves_the_timeline(pressed):
    scene, item = bpy.context.scene, recordings().items[0]
    scene.frame_start, scene.frame_end = 10, 11
    bpy.ops.thenar.show_recording()
    assert item.frame == 2
    item.follows_timeline = True
    assert (scene.frame_current, scene.frame_end) == (11, 12)
    for frame, number in ((10, 1), (12, 3), (99, 3), (1, 1)):
        scene.frame_set(frame)
        assert item.frame == number
        assert by_cell(LEFT) == pytest.approx(0.5 * number * pressed.ravel(), abs=1e-3)
        assert words()["texts"][0].startswith(f"Recorded, frame {number} of 3\n")
    item.position = 50.0
    assert (item.frame, scene.frame_current) == (2, 11)
    item.follows_timeline = False
    scene.frame_set(12)
    assert item.frame == 2


def test_the_slider_runs_over_the_whole_recording_whatever_rule_was_chosen(pressed):
    item = recordings().items[0]
    assert (item.frame_rule, item.position) == ("MEAN", 50.0)
    item.frame_rule = "LARGEST"
    assert item.position == 100.0
    item.position = 0.0
    assert (item.frame_rule, item.frame) == ("NUMBER", 1)


def test_the_residual_is_one_click_from_the_recording(pressed):
    assert not bpy.ops.thenar.show_residual.poll()
    bpy.ops.thenar.compare()
    bpy.ops.thenar.show_recording()
    assert bpy.context.scene.thenar.maps.shown == "PRESSURE"
    assert bpy.ops.thenar.show_residual() == {"FINISHED"}
    assert bpy.context.scene.thenar.maps.shown == "RESIDUAL"
    assert LEFT not in bpy.data.objects


def test_counts_have_no_legend_and_no_simulation(pressed, tmp_path):
    bpy.ops.thenar.load_recording(filepath=write_asf(tmp_path / "raw.asf", [pressed, 3.0 * pressed], "raw"))
    placing = recordings().items[1].placing
    placing.on, placing.axis = "PLANE", "+Z"
    recordings().items[1].frame_rule = "LARGEST"
    bpy.ops.thenar.compare()
    bpy.ops.thenar.show_recording()
    assert by_cell(LEFT).max() == pytest.approx(bpy.context.scene.thenar.range_kpa, rel=1e-5)
    assert "raw counts" in words()["texts"][0] and not words()["has_legend"] and RIGHT not in bpy.data.objects


def test_the_mat_begins_on_the_long_axis_of_a_product_that_came_later(tmp_path):
    bpy.ops.thenar.load_recording(filepath=write_asf(tmp_path / "mat.asf", np.ones((1, 6, 20))))
    placing = recordings().items[0].placing
    hand = stage.pad()
    bpy.ops.mesh.primitive_cylinder_add(radius=0.0317 / 2, depth=0.12, vertices=64)
    bar = bpy.context.object
    bar.data.transform(Matrix.Rotation(math.pi / 2, 4, "Y"))
    bpy.context.scene.thenar.hand, bpy.context.scene.thenar.product = hand, bar
    bpy.ops.thenar.show_recording()
    assert placing.axis == "+X" and placing.diameter_mm == pytest.approx(31.7, abs=0.1)
    placing.axis, placing.diameter_mm = "+Z", 20.0
    bpy.ops.thenar.show_recording()
    assert (placing.axis, placing.diameter_mm) == ("+Z", 20.0)


def test_a_file_is_read_once_for_all_frames_and_again_when_it_changes(pressed, monkeypatch):
    read, count = native.module.read_recording, []

    class Counting:
        def __getattr__(self, name):
            return getattr(whole, name)

        def read_recording(self, path, *rest):
            count.append(path)
            return read(path, *rest)

    whole = native.module
    monkeypatch.setattr(native, "module", Counting())
    item = recordings().items[0]
    bpy.ops.thenar.show_recording()
    for number in (1, 2, 3):
        item.frame_rule, item.frame = "NUMBER", number
    assert count == []
    with open(item.path, "a", encoding="utf-8") as file:
        file.write("\n")
    item.frame = 1
    assert len(count) == 1


def test_a_recording_that_is_gone_leaves_the_look_and_says_why(pressed, tmp_path):
    bpy.ops.thenar.show_recording()
    (tmp_path / "mat.asf").unlink()
    recordings().items[0].frame_rule = "LARGEST"
    assert LEFT in bpy.data.objects
    with pytest.raises(RuntimeError, match="mat.asf"):
        bpy.ops.thenar.show_recording()


def test_a_file_is_read_in_any_thread_and_listed_in_blenders(tmp_path):
    path = write_asf(tmp_path / "mat.asf", np.ones((2, 3, 4)))
    with ThreadPoolExecutor(1) as worker:
        found = worker.submit(loading.read, path).result()
    assert not recordings().items
    assert loading.add(bpy.context, found) == ["mat.asf"]
    assert bpy.ops.thenar.read_recording(filepath=path) == {"FINISHED"}
    assert [item.frames for item in recordings().items] == [2, 2]
