"""Hands of older files: the thumb gets today's range when they are opened, and nothing else changes."""

import math

import bpy
import numpy as np
import pytest
from thenar_blender.hand_shape import thumb_range

OLD, NEW = (-20.0, 30.0), (-40.0, 16.0)


@pytest.fixture
def hand(blender):
    """A made hand: `(mesh object, armature object)`."""
    bpy.ops.thenar.make_hand(percentile=50)
    return bpy.context.scene.thenar.hand, bpy.data.objects["Hand Rig"]


def as_older(rig, ends):
    limit = rig.pose.bones["thumb_metacarpal"].constraints["Joint limits"]
    limit.min_y, limit.max_y = (math.radians(end) for end in ends)


def ends_of(rig):
    limit = rig.pose.bones["thumb_metacarpal"].constraints["Joint limits"]
    return [math.degrees(limit.min_y), math.degrees(limit.max_y)]


def turned(rig, twist_deg):
    rig.pose.bones["thumb_metacarpal"].rotation_euler.y = math.radians(twist_deg)


def shown(rig):
    bpy.context.view_layer.update()
    return np.array(rig.pose.bones["thumb_distal"].matrix)


def reopened(tmp_path):
    """The armature after saving and opening the file again."""
    path = str(tmp_path / "older.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    return bpy.data.objects["Hand Rig"]


def test_an_older_hand_gets_todays_range_and_keeps_its_pose(hand, tmp_path):
    rig = hand[1]
    as_older(rig, OLD)
    turned(rig, 12.0)
    before = shown(rig)
    rig = reopened(tmp_path)
    assert ends_of(rig) == pytest.approx(NEW, abs=1e-3)
    assert shown(rig) == pytest.approx(before, abs=1e-6)
    assert thumb_range.is_widened(rig)
    assert not thumb_range.is_widened(reopened(tmp_path))


def test_a_left_hand_is_widened_to_its_own_side(blender, tmp_path):
    bpy.ops.thenar.make_hand(side="left")
    rig = bpy.data.objects["Hand Rig"]
    assert ends_of(rig) == pytest.approx([-NEW[1], -NEW[0]], abs=1e-3)
    as_older(rig, (-OLD[1], -OLD[0]))
    assert ends_of(reopened(tmp_path)) == pytest.approx([-NEW[1], -NEW[0]], abs=1e-3)


@pytest.mark.parametrize("is_animated", [True, False])
def test_a_thumb_beyond_todays_range_or_animated_does_not_move(hand, tmp_path, is_animated):
    rig = hand[1]
    as_older(rig, OLD)
    turned(rig, 5.0 if is_animated else 25.0)
    if is_animated:
        rig.pose.bones["thumb_metacarpal"].keyframe_insert("rotation_euler", frame=1)
    before = shown(rig)
    rig = reopened(tmp_path)
    assert ends_of(rig) == pytest.approx([NEW[0], OLD[1]], abs=1e-3)
    assert shown(rig) == pytest.approx(before, abs=1e-6)


def test_limits_of_the_users_own_stay(hand, tmp_path):
    as_older(hand[1], (-20.0, 25.0))
    rig = reopened(tmp_path)
    assert ends_of(rig) == pytest.approx([-20.0, 25.0], abs=1e-3)
    assert not thumb_range.is_widened(rig)
