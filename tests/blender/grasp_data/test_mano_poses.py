"""A hand posed by MANO's or SMPL-X's parameters points where the model's published kinematics say."""

import bpy
import model_files
import numpy as np
import pytest
from mathutils import Matrix

SEGMENT_DEG = 1.5
"""Of the direction of a segment: knuckles of made hand and model lie a little differently in the palm."""
FLEXION_DEG = 1.0
"""Of the angle between two segments: the map's zero pose is rounded to a degree."""


def into_hand(side):
    """Rotation (3, 3) from the model's axes to the world: knuckles from the wrist laid on each other (Kabsch 1976)."""
    rig = bpy.context.scene.thenar.hand.parent
    there = np.array([rig.data.bones[f"{digit}_proximal"].head_local for digit in model_files.DIGITS[:4]])
    there = (there - np.array(rig.data.bones["carpus"].head_local)) * 1000.0
    model = model_files.places(side)[[1, 4, 7, 10]] - model_files.places(side)[0]
    u, _, vt = np.linalg.svd(there.T @ model)
    return u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt


def shown_segments():
    """digit -> directions (3, 3) of its bones in the world, as Blender shows them."""
    rig = model_files.armature()
    out = {}
    for digit in model_files.DIGITS:
        own = [rig.pose.bones[name] for name in model_files.bones(digit)]
        out[digit] = np.array([np.array((bone.tail - bone.head).normalized()) for bone in own])
    return out


def angle(a, b):
    """Degrees between two directions."""
    return np.degrees(np.arccos(np.clip(np.dot(a, b) / np.linalg.norm(a) / np.linalg.norm(b), -1.0, 1.0)))


def compare(pose, side):
    """Largest errors, degrees: of the segments' directions, and of the angle at each digit's inner joint."""
    frame, at = into_hand(side), model_files.turned(pose, side)[0]
    seen, apart, bent = shown_segments(), [], []
    for place, digit in enumerate(model_files.DIGITS):
        first = 1 + 3 * place
        model = [np.array(at[first + k + 1] - at[first + k]) for k in range(2)]
        apart += [angle(frame @ model[k], seen[digit][k]) for k in range(2)]
        bent.append(abs(angle(*model) - angle(*seen[digit][:2])))
    return max(apart), max(bent)


@pytest.mark.parametrize("side", ["right", "left"])
def test_segments_and_flexion_agree_with_the_published_kinematics(tmp_path, side):
    model_files.make(side)
    for pose in [np.zeros(45), *model_files.grips()]:
        own = pose if side == "right" else model_files.mirror(pose)
        assert model_files.load(tmp_path, {f"{side}_hand_pose": own}) == {"FINISHED"}
        apart, bent = compare(own, side)
        print(f"{side}: segments within {apart:.1f}, inner joints within {bent:.1f} degrees")
        assert apart < SEGMENT_DEG and bent < FLEXION_DEG


def test_every_bone_turns_as_far_as_the_model_turns_it(tmp_path):
    model_files.make("right")
    model_files.load(tmp_path, {"hand_pose": np.zeros(45)})
    names = [name for digit in model_files.DIGITS for name in model_files.bones(digit)]
    zero = {name: model_files.armature().pose.bones[name].matrix.to_3x3().copy() for name in names}
    for pose in model_files.grips(4, seed=8):
        model_files.load(tmp_path, {"hand_pose": pose})
        rig, turns = model_files.armature(), model_files.turned(pose, "right")[1]
        for joint, name in enumerate(names, start=1):
            turn = rig.pose.bones[name].matrix.to_3x3() @ zero[name].inverted()
            wanted = 2.0 * np.arccos(min(abs(turns[joint].w), 1.0))
            assert turn.to_quaternion().angle == pytest.approx(wanted, abs=2e-3), name


def test_fingers_close_toward_the_palm(tmp_path):
    model_files.make("right")
    pose = np.zeros((15, 3))
    pose[:12, 2] = 0.7
    model_files.load(tmp_path, {"hand_pose": pose.ravel()})
    for digit in model_files.DIGITS[:4]:
        assert shown_segments()[digit][1][2] > 0.7, "a made hand's palm faces up"


@pytest.mark.parametrize(("asked", "held"), [("LEFT", "left"), ("RIGHT", "right")])
def test_a_pose_of_the_other_side_is_mirrored_only_when_it_is_asked_for(tmp_path, asked, held):
    other = "right" if held == "left" else "left"
    model_files.make(other)
    pose = model_files.grips(1)[0]
    own = pose if held == "right" else model_files.mirror(pose)
    with pytest.raises(RuntimeError, match=f"no {other} hand, only: {held}"):
        model_files.load(tmp_path, {f"{held}_hand_pose": own})
    model_files.load(tmp_path, {f"{held}_hand_pose": own}, side=asked)
    assert compare(model_files.mirror(own), other)[0] < SEGMENT_DEG


def test_joint_limits_are_kept_when_asked_and_else_switched_off(tmp_path):
    model_files.make("right")
    rig = bpy.context.scene.thenar.hand.parent
    limits = [c for bone in rig.pose.bones for c in bone.constraints if c.type == "LIMIT_ROTATION" and not c.mute]
    pose = model_files.grips(1)[0]
    model_files.load(tmp_path, {"hand_pose": pose}, keep_limits=True)
    assert not any(limit.mute for limit in limits)
    for name in ("index_middle", "ring_distal"):
        flexion, twist, aside = rig.pose.bones[name].matrix_basis.to_euler("ZYX")
        assert abs(twist) < 1e-4 and abs(aside) < 1e-4, f"{name} bends about one axis"
    model_files.load(tmp_path, {"hand_pose": pose})
    assert all(limit.mute for limit in limits if limit.id_data.pose.bones)


def test_frames_become_keys_at_the_rate_of_the_file(tmp_path):
    model_files.make("right")
    scene = bpy.context.scene
    scene.render.fps, scene.frame_start, scene.frame_end = 24, 5, 6
    poses = model_files.grips(7)
    model_files.load(tmp_path, {"hand_pose": poses, "mocap_framerate": np.array(12.0)})
    assert scene.frame_end == 5 + 6 * 2
    for frame, pose in enumerate(poses):
        scene.frame_set(5 + 2 * frame)
        assert compare(pose, "right")[0] < SEGMENT_DEG, frame


def test_keys_outside_the_sequence_stay(tmp_path):
    model_files.make("right")
    bone = bpy.context.scene.thenar.hand.parent.pose.bones["index_middle"]
    bone.rotation_euler = (0.5, 0, 0)
    for frame in (-10, 2, 300):
        bone.keyframe_insert("rotation_euler", frame=frame)
    model_files.load(tmp_path, {"hand_pose": model_files.grips(4)})
    from thenar_blender.grasp_data import keying

    curve = next(c for c in keying.curves(bone.id_data) if "index_middle" in c.data_path and c.array_index == 0)
    assert [point.co.x for point in curve.keyframe_points] == [-10, 1, 2, 3, 4, 300]
    assert curve.evaluate(-10) == pytest.approx(0.5) and curve.evaluate(2) != pytest.approx(0.5)


def test_every_nth_frame(tmp_path):
    model_files.make("right")
    model_files.load(tmp_path, {"hand_pose": model_files.grips(9)}, step=4)
    from thenar_blender.grasp_data import keying

    curve = keying.curves(bpy.context.scene.thenar.hand.parent)[0]
    assert [point.co.x for point in curve.keyframe_points] == [1, 5, 9]


def test_a_quaternion_rig_without_leaps(tmp_path):
    model_files.make("right")
    rig = bpy.context.scene.thenar.hand.parent
    for bone in rig.pose.bones:
        bone.rotation_mode = "QUATERNION"
    turn = np.zeros((40, 15, 3))
    turn[:, :, 2] = np.linspace(0.0, 1.4, 40)[:, None]
    model_files.load(tmp_path, {"hand_pose": turn.reshape(40, 45)})
    for frame in (1, 20, 40):
        bpy.context.scene.frame_set(frame)
        assert compare(turn[frame - 1].ravel(), "right")[0] < SEGMENT_DEG
    steps = []
    for frame in range(1, 41):
        bpy.context.scene.frame_set(frame)
        steps.append(np.array(rig.pose.bones["index_distal"].rotation_quaternion))
    assert np.abs(np.diff(steps, axis=0)).max() < 0.1


def test_the_hand_stays_where_it_is(tmp_path):
    model_files.make("right")
    rig = bpy.context.scene.thenar.hand.parent
    rig.matrix_world = Matrix.Translation((0.3, 0.1, 0.0)) @ Matrix.Rotation(1.0, 4, "Y")
    bpy.context.view_layer.update()
    before = rig.matrix_world.copy()
    pose = np.concatenate([[0.1, 2.0, 0.3], model_files.grips(1)[0]])
    model_files.load(tmp_path, {"pose": pose})
    assert rig.matrix_world == before


def test_a_hand_that_was_refused_is_as_before(tmp_path):
    model_files.make("right")
    rig = bpy.context.scene.thenar.hand.parent
    before = [bone.matrix_basis.copy() for bone in rig.pose.bones]
    with pytest.raises(RuntimeError, match="no angle in radians"):
        model_files.load(tmp_path, {"hand_pose": np.full(45, 40.0)})
    assert [bone.matrix_basis for bone in rig.pose.bones] == before and rig.animation_data is None


@pytest.mark.parametrize(("pose", "is_refused"), [(40.0, True), (0.2, False)])
def test_a_rigger_stays_in_pose_mode_whether_the_file_is_refused_or_not(tmp_path, pose, is_refused):
    model_files.make("right")
    rig = bpy.context.scene.thenar.hand.parent
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="POSE")
    values = {"hand_pose": np.full(45, pose)}
    if is_refused:
        with pytest.raises(RuntimeError, match="no angle in radians"):
            model_files.load(tmp_path, values)
    else:
        model_files.load(tmp_path, values)
    assert (bpy.context.object, bpy.context.mode) == (rig, "POSE")
