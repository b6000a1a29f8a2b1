"""A hand rigged as Auto-Rig Pro does it: recognised, grasped through its controls, and given back to them.

The add-on is commercial and not at hand. Bones, their names, and that hand.r copies from c_hand_ik.r and forearm_ik.r
are from public scripts for its rigs; that the helpers c_index1_rot copy the turn of index_bend_all, and that index1
copies c_index1, is what such scripts imply.
"""

import bpy
import numpy as np
import pytest
import thenar
from characters import grasp, handle, skin_mm
from controls import assert_same, holding, matrices
from makers import auto_rig_pro_bone
from thenar_blender.grasp_fit import walls
from thenar_blender.hand import build, pads
from thenar_blender.hand.skinning import pose_matrices, skin
from thenar_blender.hand_bones import bonemap, posing, reading, roles

FINGERS = {"thumb": ("metacarpal", "proximal", "distal")}
FINGERS |= dict.fromkeys(("index", "middle", "ring", "little"), ("metacarpal", "proximal", "middle", "distal"))


def names_of(mark):
    """Role -> bone of Auto-Rig Pro; in the thumb, bone 1 is the metacarpal."""
    names = {"wrist": f"hand.{mark}"}
    for digit, segments in FINGERS.items():
        first = 1 if digit == "thumb" else 0
        names |= {f"{digit}_{part}": f"{auto_rig_pro_bone(digit, k)}.{mark}" for k, part in enumerate(segments, first)}
    return names


def auto_rigged(side):
    """`(hand, rig, names)`: the made hand with Auto-Rig Pro's bones and constraints, and role -> bone."""
    hand, rig = build.add_hand(bpy.context, thenar.hand(side=side))
    bpy.context.scene.thenar.hand = hand
    names, mark = names_of(side[0]), side[0]
    own = bonemap.get_map(rig)
    bonemap.set_map(rig, {})
    for role, name in own.items():
        rig.data.bones[name].name = names[role]
    rig.data.bones["forearm"].name = f"forearm_stretch.{mark}"
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    copies = [*_arm(rig.data.edit_bones, mark)]
    for digit in FINGERS:
        copies += _finger(rig.data.edit_bones, digit, mark)
    bpy.ops.object.mode_set(mode="OBJECT")
    for bone in rig.pose.bones:
        for each in [*bone.constraints]:
            bone.constraints.remove(each)
    for name, kind, of, options in copies:
        each = rig.pose.bones[name].constraints.new(kind)
        each.target, each.subtarget = rig, of
        for option, value in options.items():
            setattr(each, option, value)
    bpy.context.view_layer.update()
    return hand, rig, names


def _copy(bones, like, name, parent):
    """A bone without skin where `like` lies."""
    bone = bones.new(name)
    bone.head, bone.tail, bone.roll, bone.parent = bones[like].head, bones[like].tail, bones[like].roll, bones[parent]
    bone.use_deform = False


def _arm(bones, mark):
    """The arm is led by c_hand_ik, which the hand copies."""
    hand, forearm = f"hand.{mark}", f"forearm_stretch.{mark}"
    root = bones.new("c_traj")
    root.head, root.tail, root.use_deform = (0.0, -0.5, 0.0), (0.0, -0.4, 0.0), False
    _copy(bones, hand, f"c_hand_ik.{mark}", "c_traj")
    _copy(bones, forearm, f"forearm_ik.{mark}", "c_traj")
    bones[forearm].parent = bones[hand].parent = root
    yield f"forearm_ik.{mark}", "IK", f"c_hand_ik.{mark}", {"chain_count": 1}
    yield forearm, "COPY_TRANSFORMS", f"forearm_ik.{mark}", {}
    yield hand, "COPY_LOCATION", f"forearm_ik.{mark}", {"head_tail": 1.0}
    yield hand, "COPY_ROTATION", f"c_hand_ik.{mark}", {}
    yield hand, "COPY_SCALE", f"c_hand_ik.{mark}", {}


def _finger(bones, digit, mark):
    """index_bend_all turns the helpers of all phalanges; the first phalanx copies its control."""
    word = {"little": "pinky"}.get(digit, digit)
    base = f"c_{word}1_base.{mark}"
    first = f"{word}1.{mark}"
    above = base if base in bones else f"hand.{mark}"
    _copy(bones, first, f"{word}_bend_all.{mark}", above)
    for k in (1, 2, 3):
        own = first if k == 1 else f"c_{word}{k}.{mark}"
        helper = f"c_{word}{k}_rot.{mark}"
        _copy(bones, own, helper, {1: above, 2: first, 3: f"c_{word}2.{mark}"}[k])
        yield helper, "COPY_ROTATION", f"{word}_bend_all.{mark}", {"owner_space": "LOCAL", "target_space": "LOCAL"}
        if k > 1:
            bones[own].parent = bones[helper]
    _copy(bones, first, f"c_{word}1.{mark}", f"c_{word}1_rot.{mark}")
    yield first, "COPY_TRANSFORMS", f"c_{word}1.{mark}", {}


def posed_by_user(rig, mark):
    """The hand raised, all of the index finger bent at once, the middle finger by single controls."""
    rig.pose.bones[f"c_hand_ik.{mark}"].location = (0.0, 0.02, 0.05)
    turns = {f"index_bend_all.{mark}": 0.25, f"c_middle1.{mark}": 0.3, f"c_middle2.{mark}": 0.4}
    for name, angle in turns.items():
        rig.pose.bones[name].rotation_mode = "XYZ"
        rig.pose.bones[name].rotation_euler = (angle, 0.0, 0.0)
    bpy.context.view_layer.update()


@pytest.mark.parametrize("side", ["right", "left"])
def test_each_bone_of_the_hand_is_found(blender, side):
    _, rig, names = auto_rigged(side)
    assert bpy.ops.thenar.guess_bones() == {"FINISHED"}
    assert bonemap.get_map(rig) == names


def test_the_skin_is_where_the_controls_put_it(blender):
    """The hand's own kinematics against Blender's skin, with helpers turned and controls posed."""
    hand, rig, _ = auto_rigged("right")
    bpy.ops.thenar.guess_bones()
    before = skin_mm(hand)
    posed_by_user(rig, "r")
    arrays, stored = reading.read_free_rig(bpy.context, hand)
    joints = roles.resolve(arrays, stored, reading.own_limits(rig, arrays))
    angles = reading.read_angles(rig, arrays, joints)
    shown = skin_mm(hand)
    assert np.abs(shown - before).max() > 20.0
    assert np.abs(skin(arrays, pose_matrices(arrays, angles)) - shown).max() < 0.05


@pytest.mark.parametrize("side", ["right", "left"])
def test_it_is_grasped_and_given_back_to_its_controls(blender, side):
    """Depths of the pads in the scene are those of the fit; afterwards each bone and constraint is as it was."""
    hand, rig, _ = auto_rigged(side)
    bpy.ops.thenar.guess_bones()
    posed_by_user(rig, side[0])
    product = handle()
    before, acting = matrices(rig), holding(rig)
    fit, found = grasp(hand)
    gap = walls.Gauge(thenar.Product(skin_mm(product), fit.product_mm[1]), is_thin=False).gaps(skin_mm(hand))
    for pad in fit.hand.pads:
        assert pads.pad_depth(gap[pad.rows]) == pytest.approx(found.depths_mm[pad.name], abs=0.05)
    assert bpy.ops.thenar.back_to_controls() == {"FINISHED"}
    bpy.context.view_layer.update()
    assert holding(rig) == acting
    assert_same(matrices(rig), before)


def test_in_a_pose_the_hand_still_follows_its_control(blender):
    hand, rig, names = auto_rigged("right")
    bpy.ops.thenar.guess_bones()
    posing.apply_pose(bpy.context, hand, "power_48")
    wrist = rig.pose.bones[names["wrist"]]
    tips = {role: rig.pose.bones[name] for role, name in names.items() if role.endswith("distal")}
    grip = {role: np.array(wrist.matrix.inverted() @ bone.matrix) for role, bone in tips.items()}
    stood = np.array(wrist.matrix)
    rig.pose.bones["c_hand_ik.r"].location = (0.0, 0.02, 0.05)
    bpy.context.view_layer.update()
    assert np.abs(np.array(wrist.matrix) - stood).max() > 0.01
    for role, bone in tips.items():
        assert np.abs(np.array(wrist.matrix.inverted() @ bone.matrix) - grip[role]).max() < 1e-5, role
