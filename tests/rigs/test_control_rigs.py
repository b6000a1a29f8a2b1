"""Hands whose fingers a control rig holds: posed with its constraints muted, and given back; also Rigify's own."""

import json

import bpy
import numpy as np
import pytest
import thenar
from characters import grasp, handle, skin_mm, world_of
from controls import assert_same, holding, matrices
from mathutils import Matrix
from thenar_blender.grasp_fit import walls
from thenar_blender.hand import build, pads
from thenar_blender.hand.skinning import pose_matrices, skin
from thenar_blender.hand_bones import constrained, posing, reading, roles
from thenar_blender.hand_bones.rig_axes import RigError
from thenar_blender.rigging import joining


@pytest.fixture(scope="module")
def made():
    return thenar.hand()


def controlled(made):
    """The made hand as a generator builds rigs: `(hand, rig)`. Each deforming bone copies a bone of a chain of
    controls, and hangs on none of its own digit; the arm follows a target by inverse kinematics."""
    hand, rig = build.add_hand(bpy.context, made)
    bpy.context.scene.thenar.hand = hand
    names = [bone.name for bone in rig.data.bones if bone.name not in {"forearm", "carpus"}]
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bones = rig.data.edit_bones
    for name in names:
        control = bones.new(f"C-{name}")
        control.head, control.tail, control.roll = bones[name].head, bones[name].tail, bones[name].roll
        control.use_deform = False
    for name in names:
        above = bones[name].parent.name
        bones[f"C-{name}"].parent = bones.get(f"C-{above}") or bones[above]
        bones[name].use_connect = False
        bones[name].parent = bones["carpus"]
    target = bones.new("C-target")
    target.head = bones["forearm"].tail
    target.tail = target.head + bones["forearm"].vector.normalized() * 0.05
    target.use_deform = False
    bpy.ops.object.mode_set(mode="OBJECT")
    for name in names:
        copy = rig.pose.bones[name].constraints.new("COPY_TRANSFORMS")
        copy.target, copy.subtarget = rig, f"C-{name}"
    arm = rig.pose.bones["forearm"].constraints.new("IK")
    arm.target, arm.subtarget, arm.chain_count = rig, "C-target", 1
    bpy.context.view_layer.update()
    return hand, rig


def posed_by_user(rig):
    """The arm raised by its target, and the index finger bent a little by its controls."""
    rig.pose.bones["C-target"].location = (0.0, 0.0, 0.1)
    for name in ("C-index_proximal", "C-index_middle"):
        rig.pose.bones[name].rotation_mode = "XYZ"
        rig.pose.bones[name].rotation_euler = (0.3, 0.0, 0.0)
    bpy.context.view_layer.update()


def test_a_control_rig_is_read_in_its_current_pose(blender, made):
    """The hand's own kinematics against Blender's skin: an arm led by a target, a finger bent by its controls."""
    hand, rig = controlled(made)
    posed_by_user(rig)
    arrays, names = reading.read_free_rig(bpy.context, hand)
    joints = roles.resolve(arrays, names, reading.own_limits(rig, arrays))
    angles = reading.read_angles(rig, arrays, joints)
    shown = skin_mm(hand)
    assert np.abs(skin(arrays, pose_matrices(arrays, angles)) - shown).max() < 0.05
    assert np.ptp(shown - 1e3 * np.array([hand.matrix_world @ v.co for v in hand.data.vertices]), axis=0).max() > 5.0


def test_a_grasp_reaches_its_pose_and_is_given_back(blender, made):
    """Depths of the pads in the scene are those of the fit; afterwards each bone and constraint is as it was."""
    hand, rig = controlled(made)
    posed_by_user(rig)
    rig.pose.bones["ring_distal"].constraints[0].mute = True
    product = handle()
    before, acting = matrices(rig), holding(rig)
    fit, found = grasp(hand)
    gap = walls.Gauge(thenar.Product(skin_mm(product), fit.product_mm[1]), is_thin=False).gaps(skin_mm(hand))
    for pad in fit.hand.pads:
        assert pads.pad_depth(gap[pad.rows]) == pytest.approx(found.depths_mm[pad.name], abs=0.05)
    assert constrained.is_muted(rig) and not constrained.holders(
        rig, [name for name in before if name.startswith("index")]
    )
    fit, found = grasp(hand)
    assert bpy.ops.thenar.back_to_controls() == {"FINISHED"}
    assert not constrained.is_muted(rig) and holding(rig) == acting, "what the user had muted stays so"
    assert_same(matrices(rig), before)
    with pytest.raises(RuntimeError, match="(?i)no constraint of the hand's bones was muted"):
        bpy.ops.thenar.back_to_controls()


def test_the_way_back_outlives_saving_and_undo(blender, made, tmp_path):
    hand, rig = controlled(made)
    posed_by_user(rig)
    before, acting = matrices(rig), holding(rig)
    bpy.context.preferences.edit.use_global_undo = True
    bpy.ops.ed.undo_push(message="before")
    posing.apply_pose(bpy.context, hand, "power_48")
    grasped = matrices(rig)
    bpy.ops.ed.undo_push(message="Apply Pose")
    bpy.ops.ed.undo()
    rig = bpy.context.scene.thenar.hand.modifiers[0].object
    bpy.context.view_layer.update()
    assert not constrained.is_muted(rig) and holding(rig) == acting
    assert_same(matrices(rig), before)
    bpy.ops.ed.redo()
    path = str(tmp_path / "grasped.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    rig = bpy.context.scene.thenar.hand.modifiers[0].object
    bpy.context.view_layer.update()
    assert_same(matrices(rig), grasped)
    assert bpy.ops.thenar.back_to_controls() == {"FINISHED"}
    bpy.context.view_layer.update()
    assert holding(rig) == acting
    assert_same(matrices(rig), before)


def test_a_constraint_that_went_is_no_obstacle_to_the_way_back(blender, made):
    hand, rig = controlled(made)
    posing.apply_pose(bpy.context, hand, "power_48")
    bone = rig.pose.bones["index_distal"]
    bone.constraints.remove(bone.constraints["Copy Transforms"])
    rig.data.bones["ring_distal"].name = "renamed"
    assert bpy.ops.thenar.back_to_controls() == {"FINISHED"}
    assert "Copy Transforms" in rig.pose.bones["middle_distal"].constraints
    assert not rig.pose.bones["middle_distal"].constraints["Copy Transforms"].mute


def test_a_driven_finger_is_refused_with_all_as_it_was(blender, made):
    hand, rig = controlled(made)
    curve = rig.pose.bones["middle_middle"].driver_add("rotation_quaternion", 1)
    rig.pose.bones["middle_middle"].driver_add("rotation_euler", 0)
    for each in (curve, *rig.animation_data.drivers):
        each.driver.expression = "0.4"
    bpy.context.view_layer.update()
    before, acting = matrices(rig), holding(rig)
    with pytest.raises(RigError, match="'middle_middle' did not take the pose"):
        posing.apply_pose(bpy.context, hand, "power_48")
    bpy.context.view_layer.update()
    assert holding(rig) == acting and not constrained.is_muted(rig)
    assert_same(matrices(rig), before)


def test_linked_and_overridden_control_rigs_are_refused(blender, made, tmp_path):
    hand, rig = controlled(made)
    path = str(tmp_path / "library.blend")
    bpy.data.libraries.write(path, {rig})
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(path, link=True) as (inside, wanted):
        wanted.objects = inside.objects
    rig = next(obj for obj in bpy.data.objects if obj.type == "ARMATURE")
    hand, own = build.add_hand(bpy.context, made)
    bpy.context.scene.collection.objects.link(rig)
    hand.parent, hand.modifiers[0].object = None, rig
    bpy.data.objects.remove(own)
    bpy.context.scene.thenar.hand = hand
    bpy.context.view_layer.update()
    with pytest.raises(RigError, match=r"linked from another file.* Make Local"):
        posing.apply_pose(bpy.context, hand, "power_48")
    over = rig.override_create(remap_local_usages=True)
    bpy.context.view_layer.update()
    assert hand.modifiers[0].object == over and over.override_library is not None
    with pytest.raises(RigError, match=r"linked from another file.* Make Local"):
        posing.apply_pose(bpy.context, hand, "power_48")


def test_constrained_fingers_need_no_joining(blender, made):
    hand, rig = controlled(made)
    assert joining.loose(rig, reading.bonemap.get_map(rig)) == []
    with pytest.raises(RuntimeError, match="need no joining"):
        bpy.ops.thenar.join_bones()
    posing.apply_pose(bpy.context, hand, "power_48")
    assert joining.loose(rig, reading.bonemap.get_map(rig)) == [], "muted for a grasp, they still need none"


def test_pose_files_want_fingers_without_constraints(blender, made, tmp_path):
    """Keys on a bone that a constraint holds would not be seen, nor would they fit where it is muted for a grasp."""
    hand, rig = controlled(made)
    path = tmp_path / "pose.json"
    path.write_text(json.dumps({"hand_pose": [0.2] * 45}))
    before, acting = matrices(rig), holding(rig)
    with pytest.raises(RuntimeError, match=r"(?i)bone '.*' is held by its constraint 'Copy Transforms'; mute it"):
        bpy.ops.thenar.load_hand_pose(filepath=str(path))
    assert holding(rig) == acting
    assert_same(matrices(rig), before)
    posing.apply_pose(bpy.context, hand, "power_48")
    grasped = matrices(rig)
    with pytest.raises(RuntimeError, match="(?i)muted for a grasp only; press Back to the Controls"):
        bpy.ops.thenar.load_hand_pose(filepath=str(path))
    assert_same(matrices(rig), grasped)


def test_a_generated_rigify_rig_is_posed_and_given_back(blender):
    """Rigify itself: deforming bones reach the pose, follow the arm's control rigidly, and return to their controls."""
    bpy.ops.preferences.addon_enable(module="rigify")
    if "rigify" not in bpy.context.preferences.addons:
        pytest.skip("this Blender has no Rigify")
    bpy.ops.object.armature_human_metarig_add()
    metarig = bpy.context.object
    bpy.ops.pose.rigify_generate()
    rig = next(obj for obj in bpy.data.objects if obj.type == "ARMATURE" and obj is not metarig)
    names = [bone.name for bone in rig.data.bones if bone.use_deform]
    mesh = bpy.data.meshes.new("Body")
    places = np.array([rig.data.bones[name].head_local for name in names])
    ends = np.array([rig.data.bones[name].tail_local for name in names])
    corners = np.concatenate([places, ends, 0.5 * (places + ends) + [0.0, 0.004, 0.004]])
    count = len(names)
    mesh.from_pydata(corners.tolist(), [], [(k, k + count, k + 2 * count) for k in range(count)])
    body = bpy.data.objects.new("Body", mesh)
    bpy.context.scene.collection.objects.link(body)
    for k, name in enumerate(names):
        body.vertex_groups.new(name=name).add([k, k + count, k + 2 * count], 1.0, "REPLACE")
    body.modifiers.new("Armature", "ARMATURE").object = rig
    bpy.context.scene.thenar.hand = body
    rig.thenar_bones.side = "LEFT"
    assert bpy.ops.thenar.guess_bones(with_regions=False) == {"FINISHED"}
    before, acting, stood = matrices(rig), holding(rig), world_of(rig)
    posing.apply_pose(bpy.context, body, "power_48")
    arrays, stored = reading.read_free_rig(bpy.context, body)
    joints = roles.resolve(arrays, stored)
    angles = reading.read_angles(rig, arrays, joints)
    shown = skin_mm(body)
    assert np.abs(skin(arrays, pose_matrices(arrays, angles)) - shown).max() < 0.2
    bends = [np.degrees(angles[joints.bones[f"{finger}_middle"], 0]) for finger in roles.FINGERS]
    assert min(bends) > 30.0, "a power grip bends the middle joints"
    assert np.array_equal(world_of(rig), stood)
    grip = {name: np.linalg.inv(rig.pose.bones["DEF-hand.L"].matrix) @ rig.pose.bones[name].matrix for name in names
            if name.startswith(("DEF-f_", "DEF-thumb")) and name.endswith(".L")}  # fmt: skip
    hand_was = np.array(rig.pose.bones["DEF-hand.L"].matrix)
    control = rig.pose.bones["hand_ik.L"]
    control.matrix = Matrix.Translation((0.0, -0.1, 0.15)) @ control.matrix
    bpy.context.view_layer.update()
    assert np.abs(np.array(rig.pose.bones["DEF-hand.L"].matrix) - hand_was).max() > 0.05, "the arm follows its control"
    for name, place in grip.items():
        now = np.linalg.inv(rig.pose.bones["DEF-hand.L"].matrix) @ rig.pose.bones[name].matrix
        assert np.abs(now - np.array(place)).max() < 2e-3, name
    control.matrix_basis = Matrix.Identity(4)
    assert bpy.ops.thenar.back_to_controls() == {"FINISHED"}
    bpy.context.view_layer.update()
    assert holding(rig) == acting
    assert_same(matrices(rig), before, 1e-4)
    rig.pose.bones["f_index.01_master.L"].scale.y = 0.7
    bpy.context.view_layer.update()
    assert np.abs(matrices(rig)["DEF-f_index.03.L"] - before["DEF-f_index.03.L"]).max() > 1e-3, "controls act again"
