"""A bake stays together with its file and objects; takes are kept; numbers are keyed; a crash costs one frame."""

import shutil
import subprocess
import sys
from pathlib import Path

import bpy
import dask_cluster
import numpy as np
import pytest
import stage
import test_panels
from thenar_blender.results import export
from thenar_blender.scene import baked
from thenar_blender.scene.checks import Refusal
from thenar_blender.timeline import baking

FRAMES = (1, 2, 3, 4)


@pytest.fixture
def sinking(tmp_path):
    """Pad and plate that sinks by 0.6 mm over four frames, saved in the folder `one`."""
    (tmp_path / "one").mkdir()
    hand, product = stage.scene(top=-7.5)
    stage.raise_under(hand, product, depth=0.6)
    product.keyframe_insert("location", frame=1)
    product.location.z -= 0.0004
    product.keyframe_insert("location", frame=4)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "one" / "a.blend"))
    return hand, product


def played(hand, product=None):
    """(shape, pressure of hand, pressure of product) in each frame as they are shown."""
    found = []
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        pressure = None if product is None else stage.attribute(product, "pressure_kpa").copy()
        found.append((stage.evaluated(hand).copy(), stage.attribute(hand, "pressure_kpa").copy(), pressure))
    return found


def assert_same(found, expected):
    for one, other in zip(found, expected, strict=True):
        for values, wanted in zip(one, other, strict=True):
            if wanted is not None:
                np.testing.assert_allclose(values, wanted, atol=1e-3 * max(1.0, np.abs(wanted).max()) * 0.01)


def test_saved_elsewhere_shape_and_pressure_stay_together(sinking, tmp_path):
    hand, product = sinking
    bpy.ops.thenar.bake(frame_start=1, frame_end=4)
    expected = played(hand, product)
    peaks = [pressure.max() for _, pressure, _ in expected]
    assert peaks == sorted(peaks, reverse=True) and peaks[0] > 1.2 * peaks[3], "the plate sinks"
    bpy.ops.wm.save_mainfile()
    (tmp_path / "two").mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "two" / "b.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "two" / "b.blend"))
    hand, product = bpy.data.objects["Pad"], bpy.data.objects["Plate"]
    assert_same(played(hand, product), expected)
    assert baked.notes(hand, [product]) == []


def test_renamed_hand_and_product_keep_their_bake(sinking):
    hand, product = sinking
    bpy.ops.thenar.bake(frame_start=1, frame_end=4)
    expected = played(hand, product)
    hand.name, product.name = "Left", "Mug"
    other = bpy.data.objects.new("Plate", product.data.copy())
    bpy.context.scene.collection.objects.link(other)
    assert_same(played(hand, product), expected)
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)
    assert_same(played(bpy.data.objects["Left"], bpy.data.objects["Mug"]), expected)


def test_hands_of_similar_names_have_a_file_each(sinking):
    hand, _ = sinking
    names = ["Hand:1", "Hand?1", "hand:1", "H" * 60, "手"]
    assert len({str(baked.stem_of(_named(hand, name), "Take 1")).casefold() for name in names}) == len(names)
    for name in names:
        stem = baked.stem_of(_named(hand, name), "a/../b")
        assert stem.parent == Path(bpy.data.filepath).parent / "thenar_cache" and len(stem.name.encode()) < 200


def _named(hand, name):
    hand.name = name
    return hand


@pytest.mark.parametrize(("old", "new"), [(100, 200), (200, 100)])
def test_stretched_time_plays_the_pressure_of_the_shape(sinking, old, new):
    hand, product = sinking
    render = bpy.context.scene.render
    render.frame_map_old, render.frame_map_new = old, new
    bpy.ops.thenar.bake(frame_start=1, frame_end=4)
    found = played(hand, product)
    bpy.ops.thenar.clear()
    for frame, (shape, pressure, _) in zip(FRAMES, found, strict=True):
        bpy.context.scene.frame_set(frame)
        if stage.solve().force_n > 0.0:
            assert np.abs(stage.evaluated(hand) - shape).max() < 0.01, frame
            assert np.abs(stage.attribute(hand, "pressure_kpa") - pressure).max() < 1e-3 * pressure.max()
        bpy.ops.thenar.clear()


def test_a_bake_that_is_moved_or_slowed_in_its_modifier_moves_with_its_pressure(sinking):
    hand, product = sinking
    bpy.ops.thenar.bake(frame_start=1, frame_end=4)
    expected = played(hand, product)
    (cache,) = hand.modifiers
    cache.frame_start += 10
    for frame, (shape, pressure, of_product) in zip((11, 12, 13, 14), expected, strict=True):
        bpy.context.scene.frame_set(frame)
        np.testing.assert_allclose(stage.evaluated(hand), shape, atol=1e-5)
        np.testing.assert_allclose(stage.attribute(hand, "pressure_kpa"), pressure, rtol=1e-5)
        np.testing.assert_allclose(stage.attribute(product, "pressure_kpa"), of_product, rtol=1e-5)
    cache.frame_start, cache.frame_scale = 0.5, 0.5
    bpy.context.scene.frame_set(2)  # half way between the first frame and the second
    np.testing.assert_allclose(stage.evaluated(hand), (expected[0][0] + expected[1][0]) / 2, atol=1e-4)
    middle = (expected[0][1] + expected[1][1]) / 2
    np.testing.assert_allclose(stage.attribute(hand, "pressure_kpa"), middle, atol=1e-4 * middle.max())


def test_takes_are_kept_named_and_chosen(sinking, tmp_path):
    hand, product = sinking
    bpy.ops.thenar.bake(frame_start=1, frame_end=4)
    first = played(hand, product)
    product.delta_location.z += 0.0002
    bpy.ops.thenar.bake(frame_start=1, frame_end=4, take="higher")
    second = played(hand, product)
    assert baked.take_names(hand) == ["Take 1", "higher"] and baked.is_playing(hand, "higher")
    assert second[0][1].max() > 1.1 * first[0][1].max()
    stored = hand.thenar.bake.peak_kpa
    assert bpy.ops.thenar.play_take(take="Take 1") == {"FINISHED"}
    assert_same(played(hand, product), first)
    assert hand.thenar.bake.peak_kpa < stored
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)
    hand, product = bpy.data.objects["Pad"], bpy.data.objects["Plate"]
    assert_same(played(hand, product), first)
    bpy.ops.thenar.play_take(take="higher")
    assert_same(played(hand, product), second)
    with pytest.raises(RuntimeError, match="has no take 'lower'; it has"):
        bpy.ops.thenar.play_take(take="lower")
    bpy.ops.thenar.bake(frame_start=1, frame_end=2, take="higher")
    assert sorted(baked.take_names(hand)) == ["Take 1", "higher"], "a take of the same name is replaced"
    with pytest.raises(RuntimeError, match="too long for a modifier"):
        bpy.ops.thenar.bake(frame_start=1, frame_end=1, take="x" * 60)
    bpy.ops.thenar.clear()
    assert not hand.modifiers and baked.take_names(hand) == []


def test_force_area_and_peak_are_keyed_in_every_frame(sinking, tmp_path):
    hand, _ = sinking
    bpy.ops.thenar.bake(frame_start=1, frame_end=4)
    export.write_bake(bpy.context, str(tmp_path / "frames.csv"))
    rows = np.genfromtxt(tmp_path / "frames.csv", delimiter=",", names=True)
    for row, frame in enumerate(FRAMES):
        bpy.context.scene.frame_set(frame)
        stored = hand.thenar.bake
        for name, column in (("force_n", "force_n"), ("area_mm2", "area_mm2"), ("frame_peak_kpa", "peak_kpa")):
            assert getattr(stored, name) == pytest.approx(rows[column][row], rel=1e-5), (name, frame)
    assert rows["force_n"][0] > rows["force_n"][3] > 0.0
    bpy.ops.thenar.clear()
    assert hand.animation_data is None and not [each for each in bpy.data.actions if each.users == 0]


def test_a_bake_that_crashed_goes_on_where_it_was(sinking, tmp_path):
    """A process that is killed in its third frame, and the same bake again: only the other frames are solved."""
    hand, product = sinking
    bpy.ops.thenar.bake(frame_start=1, frame_end=4, take="whole")
    whole = played(hand, product)
    bpy.ops.thenar.clear()
    path = bpy.data.filepath
    bpy.ops.wm.save_mainfile()
    script = (
        "import os, bpy, thenar_blender\n"
        "from thenar_blender import workflow\n"
        "from thenar_blender.timeline import baking\n"
        "thenar_blender.register()\n"
        f"bpy.ops.wm.open_mainfile(filepath={path!r})\n"
        "compute, calls = workflow.compute, []\n"
        "def once_more(*given):\n"
        "    calls.append(1)\n"
        "    if len(calls) == 3: os._exit(9)\n"
        "    return compute(*given)\n"
        "workflow.compute = once_more\n"
        "bpy.ops.thenar.bake(frame_start=1, frame_end=4, take='whole')\n"
    )
    ended = subprocess.run(
        [sys.executable, "-c", script], env=dask_cluster.environment(), capture_output=True, timeout=120
    )
    assert ended.returncode == 9, ended.stderr.decode()
    folder = tmp_path / "one" / "thenar_cache"
    kept = list(folder.rglob("*.frames/*.npz"))
    assert len(kept) == 2
    kept[0].write_bytes(kept[0].read_bytes()[:500])  # the power went while it was written
    bpy.ops.wm.open_mainfile(filepath=path)
    hand, product = bpy.data.objects["Pad"], bpy.data.objects["Plate"]
    steps = baking.steps(bpy.context, 1, 4, "whole")
    solved = _run(steps)
    assert solved == 3, "one frame is taken over, one was damaged, two were not solved"
    assert_same(played(hand, product), whole)
    assert not list(folder.rglob("*.frames")), "what is published is not kept twice"
    bpy.ops.thenar.clear()
    product.location.z += 0.0001
    assert _run(baking.steps(bpy.context, 1, 2, "whole")) == 2


def _run(steps):
    """Run the steps of a computation. Returns how many there were."""
    count, answer = 0, None
    try:
        work = next(steps)
        while True:
            count += 1
            answer = work(None, None)
            work = steps.send(answer)
    except StopIteration:
        return count


def test_the_panel_lists_takes_numbers_and_what_is_stale(sinking, tmp_path):
    hand, _ = sinking
    for take in ("", "higher"):
        bpy.ops.thenar.bake(frame_start=1, frame_end=2, take=take)
    drawn = test_panels.draw()
    said = [words for words, _ in drawn["THENAR_PT_bake"]]
    assert [words for words in said if words in ("Take 1", "higher")] == ["Take 1", "higher"]
    stored = hand.thenar.bake
    assert f"{stored.force_n:.1f} N" in said and f"{stored.frame_peak_kpa:.0f} kPa" in said
    assert not [row for row in test_panels.too_long(drawn) if row[0] == "THENAR_PT_bake"]
    shutil.rmtree(tmp_path / "one" / "thenar_cache")
    baked.forget()
    assert any(words.startswith("Its file is missing") for words, _ in test_panels.draw()["THENAR_PT_bake"])


def test_curves_of_the_user_stay(sinking):
    hand, _ = sinking
    hand.keyframe_insert("location", frame=1)
    hand.keyframe_insert("location", frame=9)
    action = hand.animation_data.action
    bpy.ops.thenar.bake(frame_start=1, frame_end=2)
    bpy.ops.thenar.clear()
    assert hand.animation_data.action == action
    before = tuple(hand.location)
    hand.location.x = 5.0
    bpy.context.scene.frame_set(9)
    assert tuple(hand.location) == pytest.approx(before)


def test_what_is_stale_is_noted(sinking, tmp_path):
    hand, product = sinking
    bpy.ops.thenar.bake(frame_start=1, frame_end=2)
    assert baked.notes(hand, [product]) == []
    other = bpy.data.objects.new("Lid", product.data.copy())
    assert baked.notes(hand, [product, other]) == ["'Lid' is not in this bake and shows no pressure of it"]
    product.data = product.data.copy()
    product.data.vertices.add(1)
    assert any("'Plate' had" in note for note in baked.notes(hand, [product]))
    hand.modifiers[0].show_viewport = False
    assert baked.notes(hand, [product])[0].startswith("no take is shown")
    hand.modifiers[0].show_viewport = True
    shutil.rmtree(tmp_path / "one" / "thenar_cache")
    baked.forget()
    assert baked.notes(hand, [product])[0].startswith("its file is missing")
    with pytest.raises(Refusal, match="is missing"):
        baked.choose(hand, "Take 1")
