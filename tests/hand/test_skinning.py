"""Forward kinematics and skinning against Blender's own, and their derivative against differences."""

import numpy as np
import pytest
from hand_scenes import evaluated_mm
from thenar_blender.hand import skinning
from thenar_blender.hand.poses import POSES
from thenar_blender.hand_bones import posing, reading, roles


def read(context, hand, rig):
    arrays, names = reading.read_rig(context, hand)
    return arrays, roles.resolve(arrays, names, reading.own_limits(rig, arrays))


def random_angles(arrays, joints, seed):
    """Every free angle anywhere between its limits."""
    rng = np.random.default_rng(seed)
    out = np.zeros((len(arrays.names), 3))
    for role, bone in joints.bones.items():
        for angle in roles.limits_of(role):
            out[bone, roles.COLUMNS[angle]] = rng.uniform(*roles.angle_bounds(joints, role, angle))
    return out


@pytest.mark.parametrize("seed", range(3))
def test_skin_is_blenders(blender, hand, seed):
    mesh, rig = hand
    arrays, joints = read(blender.context, mesh, rig)
    angles = random_angles(arrays, joints, seed)
    reading.write_angles(rig, arrays, joints, angles)
    mine = skinning.skin(arrays, skinning.pose_matrices(arrays, angles))
    error = np.abs(mine - evaluated_mm(mesh)).max()
    assert error < 1e-5 * np.ptp(mine, axis=0).max()


def test_skin_is_blenders_on_a_moved_scaled_rig(blender, hand):
    mesh, rig = hand
    rig.location, rig.rotation_euler, rig.scale = (0.3, -0.2, 0.9), (0.4, 1.1, -0.6), (1.2, 1.2, 1.2)
    arrays, joints = read(blender.context, mesh, rig)
    angles = random_angles(arrays, joints, 7)
    reading.write_angles(rig, arrays, joints, angles)
    mine = skinning.skin(arrays, skinning.pose_matrices(arrays, angles))
    assert np.abs(mine - evaluated_mm(mesh)).max() < 1e-5 * 1500.0


def test_jacobian_is_the_difference_quotient(arrays):
    rig, joints = arrays.rig, arrays.joints
    angles = random_angles(rig, joints, 3)
    part = rig.subset(np.arange(0, len(rig.vertices), 97))
    turned = ("thumb_metacarpal", "ring_metacarpal", "index_middle")
    dofs = [(joints.bones[role], column) for role in turned for column in range(3)]
    posed = skinning.pose_matrices(part, angles)
    slope = skinning.vertex_jacobian(part, posed, skinning.joint_axes(part, posed, angles), dofs)
    step = 1e-6
    for k, (bone, column) in enumerate(dofs):
        ends = []
        for sign in (1.0, -1.0):
            moved = angles.copy()
            moved[bone, column] += sign * step
            ends.append(skinning.skin(part, skinning.pose_matrices(part, moved)))
        quotient = (ends[0] - ends[1]) / (2.0 * step)
        assert np.abs(slope[:, k] - quotient).max() < 1e-5 * max(1.0, np.abs(quotient).max())


@pytest.mark.parametrize("name", POSES)
def test_poses_respect_limits_and_survive_blender(blender, hand, name):
    mesh, rig = hand
    posing.apply_pose(blender.context, mesh, name)
    blender.context.view_layer.update()
    for bone in rig.pose.bones:
        held = rig.matrix_world @ bone.matrix
        free = bone.matrix_basis
        for limit in bone.constraints:
            if limit.mute:
                continue
            turn = free.to_euler("ZYX")
            for axis in "xyz":
                low, high = getattr(limit, f"min_{axis}"), getattr(limit, f"max_{axis}")
                assert low - 1e-5 <= getattr(turn, axis) <= high + 1e-5, (bone.name, axis)
        assert np.isfinite(np.array(held)).all()


def test_flat_is_straight_and_a_fist_is_not(blender, hand):
    mesh, rig = hand
    tip = rig.pose.bones["middle_distal"]
    posing.apply_pose(blender.context, mesh, "flat")
    blender.context.view_layer.update()
    first = np.array(rig.pose.bones["middle_proximal"].matrix)[:3, 1]
    assert first @ np.array(tip.matrix)[:3, 1] > np.cos(np.radians(2.0))
    posing.apply_pose(blender.context, mesh, "power_48")
    blender.context.view_layer.update()
    metacarpal = np.array(rig.pose.bones["middle_metacarpal"].matrix)[:3, 1]
    assert metacarpal @ np.array(tip.matrix)[:3, 1] < np.cos(np.radians(120.0))
