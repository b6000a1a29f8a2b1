"""A finger rolls on a ball without slipping: at every instant, skin at the contact stands still on the ball."""

from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("bpy")
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
