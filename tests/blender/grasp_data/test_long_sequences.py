"""A sequence of poses is read and prepared next to the window; the hand changes at the end alone."""

import time
from pathlib import Path

import bpy
import model_files
import numpy as np
import pytest
from thenar_blender.grasp_data import keying, posing


def begun(tmp_path, count):
    """The steps of a sequence, advanced to the work that prepares its keys."""
    model_files.make("right")
    np.savez(tmp_path / "pose.npz", hand_pose=model_files.grips(count))
    steps = posing.steps(bpy.context, Path(tmp_path / "pose.npz"), posing.Wish())
    work = next(steps)
    for _ in range(2):
        work = steps.send(work(None, None))
    return steps, work


def state():
    """What a pose changes: rotations, limits, animation."""
    rig = bpy.context.scene.thenar.hand.parent
    limits = [c.mute for bone in rig.pose.bones for c in bone.constraints]
    return [tuple(map(tuple, bone.matrix_basis)) for bone in rig.pose.bones], limits, rig.animation_data


def test_a_cancelled_sequence_leaves_the_hand_as_it_was(tmp_path):
    steps, work = begun(tmp_path, 5)
    before = state()

    class Set:
        def is_set(self):
            return True

    assert work(Set(), None) == {}
    steps.close()
    assert state() == before and before[2] is None


def test_progress_counts_bones(tmp_path):
    _, work = begun(tmp_path, 3)
    said = []
    rows = work(None, lambda stage, fraction: said.append((stage, fraction)))
    assert [stage for stage, _ in said] == ["keying"] * len(rows) and len(rows) > 10
    np.testing.assert_allclose([fraction for _, fraction in said], np.arange(len(rows)) / len(rows))


def test_keys_are_joined_by_lines(tmp_path):
    steps, work = begun(tmp_path, 4)
    with pytest.raises(StopIteration) as end:
        steps.send(work(None, None))
    assert end.value.value.keyed == 4
    curves = keying.curves(bpy.context.scene.thenar.hand.parent)
    assert curves and {point.interpolation for curve in curves for point in curve.keyframe_points} == {"LINEAR"}
    assert all(len(curve.keyframe_points) == 4 for curve in curves)


def test_the_window_keys_what_a_script_keys(tmp_path):
    model_files.make("right")
    model_files.load(tmp_path, {"hand_pose": model_files.grips(6)})
    first = rows()
    bpy.context.scene.thenar.hand.parent.animation_data_clear()
    assert bpy.ops.thenar.read_hand_pose(filepath=str(tmp_path / "pose.npz")) == {"FINISHED"}
    assert rows() == first and len(first) > 30


def test_a_minute_of_motion_capture_is_keyed_whole(tmp_path):
    """What changes the hand, in the window's thread; its processor time is printed (`pytest -s`), never asserted."""
    steps, work = begun(tmp_path, 1800)
    prepared = work(None, None)
    assert state()[2] is None, "the hand changed before its keys were prepared"
    begin = time.process_time()
    with pytest.raises(StopIteration) as end:
        steps.send(prepared)
    print(f"1800 frames keyed in {time.process_time() - begin:.2f} s of CPU")
    curves = keying.curves(bpy.context.scene.thenar.hand.parent)
    assert end.value.value.keyed == 1800 and len(curves) > 30
    assert all(len(curve.keyframe_points) == 1800 for curve in curves)


def rows():
    """Every key, rounded."""
    return [
        (curve.data_path, curve.array_index, [tuple(round(v, 5) for v in point.co) for point in curve.keyframe_points])
        for curve in keying.curves(bpy.context.scene.thenar.hand.parent)
    ]
