"""A finger rolls on a ball without slipping: at every instant, skin at the contact stands still on the ball."""

from types import SimpleNamespace

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")
from mathutils import Matrix, Vector  # noqa: E402
from thenar_blender.moving_samples import rolling  # noqa: E402

RADIUS, FINGER = 20.0, 7.0


@pytest.fixture
def finger():
    """A finger along (1, 0, 0), round with `FINGER`, on a ball of `RADIUS` about (3, -2, 5); and its start."""
    middle = Vector((3.0, -2.0, 5.0))
    pose = Matrix.Translation(Vector((9.0, -2.0, 5.0 + RADIUS + FINGER))) @ Matrix.Rotation(-np.pi / 2.0, 4, "Z")
    rig = SimpleNamespace(pose=SimpleNamespace(bones={"index_distal": SimpleNamespace(matrix=pose)}))
    ball = SimpleNamespace(matrix_world=Matrix.Translation(middle), dimensions=(2 * RADIUS,) * 3)
    return rig, (ball, "index_distal"), np.eye(4)


@pytest.mark.parametrize("angle", [-0.5, -0.1, 0.0, 0.3, 0.6])
def test_touching_skin_does_not_move(finger, angle):
    rig, where, start = finger
    around = angle * FINGER / (RADIUS + FINGER)
    touching = np.array([9.0, -2.0 - RADIUS * np.sin(around), 5.0 + RADIUS * np.cos(around), 1.0])
    step = 1e-4
    before, after = (rolling.motion(rig, start, where, angle + sign * step) for sign in (-1, 1))
    now = rolling.motion(rig, start, where, angle)
    moved = (after - before) @ np.linalg.inv(now) @ touching / (2 * step)
    assert np.abs(moved[:3]).max() < 1e-3 * RADIUS
    turned = np.arccos(np.clip((np.trace(now[:3, :3]) - 1.0) / 2.0, -1.0, 1.0))
    assert turned == pytest.approx(abs(angle), abs=1e-4), "the finger turns by the angle in all"


def test_axis_keeps_its_distance_from_the_ball(finger):
    rig, where, start = finger
    for angle in (-0.6, 0.2, 0.6):
        axis = (rolling.motion(rig, start, where, angle) @ [9.0, -2.0, 5.0 + RADIUS + FINGER, 1.0])[:3]
        assert np.hypot(*(axis[1:] - [-2.0, 5.0])) == pytest.approx(RADIUS + FINGER, abs=1e-4)


def test_keyed_roll_follows_the_motion_at_and_between_frames():
    """An armature tilted and turned over, as in the sample; half a step is at most 1.5 times the sine's largest."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    data = bpy.data.armatures.new("Rig")
    rig = bpy.data.objects.new("Rig", data)
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bone = data.edit_bones.new("tip")
    bone.head, bone.tail = (0.0, 0.0, 0.0), (0.0, 0.02, 0.0)
    bpy.ops.object.mode_set(mode="OBJECT")
    rig.matrix_world = (
        Matrix.Translation((0.002, 0.0, 0.027)) @ Matrix.Rotation(0.2, 4, "X") @ Matrix.Rotation(np.pi, 4, "Y")
    )
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.02)
    ball = bpy.context.object
    bpy.context.view_layer.update()
    rolling.roll(bpy.context, rig, ball, "tip")
    scene, seen = bpy.context.scene, []
    for half in range(2 * rolling.FRAMES):
        scene.frame_set(1 + half // 2, subframe=0.5 * (half % 2))
        seen.append(np.array(rig.matrix_world))
    steps = [np.linalg.inv(before) @ after for before, after in zip(seen[:-1], seen[1:], strict=True)]
    turned = [np.degrees(np.arccos(np.clip((np.trace(step[:3, :3]) - 1.0) / 2.0, -1.0, 1.0))) for step in steps]
    assert max(turned) < 1.5 * rolling.ROLL_DEG * np.pi / rolling.FRAMES
    distance = [np.hypot(*(matrix @ [0.0, 0.01, 0.0, 1.0])[[0, 2]]) for matrix in seen]
    assert max(distance) - min(distance) < 3e-4, "the finger stays on the ball"
    assert scene.frame_start == 1 and scene.frame_end == rolling.FRAMES
