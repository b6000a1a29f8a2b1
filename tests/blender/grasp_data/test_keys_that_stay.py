"""A sequence that is loaded replaces keys within its frames; the user's own outside of them keep all that they have."""

from types import SimpleNamespace

import bpy
import model_files
import numpy as np
import pytest
from thenar_blender.grasp_data import keying, posing
from thenar_blender.scene.checks import Refusal


def kept(point):
    """What a key is, but for its neighbor's handle."""
    return (*point.co, point.interpolation, point.handle_left_type, point.handle_right_type, point.easing)


def test_keys_before_and_after_the_sequence_stay_as_they_are(tmp_path):
    rig = SimpleNamespace(obj=bpy.data.objects.new("rig", None))
    rig.obj.animation_data_create().action = bpy.data.actions.new("own")
    for frame in (-20, -10, 100, 120):
        rig.obj.location[0] = 0.1 * frame
        rig.obj.keyframe_insert("location", index=0, frame=frame)
    (curve,) = keying.curves(rig.obj)
    for point in curve.keyframe_points:
        point.handle_left_type = point.handle_right_type = "FREE"
        point.interpolation, point.easing = "BEZIER", "EASE_IN"
    before = [kept(point) for point in curve.keyframe_points]
    frames = np.arange(1.0, 9.0)
    keying._fill(curve, frames, np.sin(frames))
    after = list(curve.keyframe_points)
    assert [kept(point) for point in after[:2] + after[-2:]] == before
    new = after[2:-2]
    assert [point.co[0] for point in new] == list(frames) and {point.interpolation for point in new} == {"LINEAR"}
    assert all(abs(point.handle_right[0] - point.co[0]) < 1.0 for point in new)


def test_a_bone_that_went_while_the_file_was_read_is_named():
    model_files.make("right")
    rig = bpy.context.scene.thenar.hand.parent
    with pytest.raises(Refusal, match="bone 'tail' was removed while the file was read"):
        posing._check_there(rig, {rig.pose.bones[0].name: None, "tail": None})
