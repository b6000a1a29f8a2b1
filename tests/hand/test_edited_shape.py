"""A made hand of another size or side: the library's own shape, in the same objects, pose and place."""

import edited_hands
import numpy as np
import pytest
from mathutils import Matrix

bpy = pytest.importorskip("bpy")
thenar = pytest.importorskip("thenar")


@pytest.fixture
def hand(blender):
    bpy.ops.thenar.make_hand()
    return bpy.context.scene.thenar.hand


@pytest.fixture
def rig(hand):
    return hand.parent


@pytest.mark.parametrize(
    ("edit", "shape"),
    [
        ({"percentile": 5.0}, {"percentile": 5}),
        ({"sex": "female"}, {"sex": "female"}),
        ({"size": "OWN", "length_mm": 200.0, "breadth_mm": 80.0}, {"length_mm": 200, "breadth_mm": 80}),
        ({"side": "left"}, {"side": "left"}),
    ],
)
def test_the_edited_hand_is_the_one_that_the_library_makes(hand, rig, edit, shape):
    mesh, bones = hand.data, rig.data
    for name, value in edit.items():
        setattr(hand.thenar_hand, name, value)
    truth = thenar.hand(**shape)
    assert (hand.data, hand.parent, rig.data) == (mesh, rig, bones) and not hand.thenar_hand.problem
    assert np.abs(edited_hands.rest_mm(hand) - truth["vertices_mm"]).max() < 1e-3
    assert [list(polygon.vertices) for polygon in mesh.polygons] == truth["triangles"].tolist()
    for bone in truth["bones"]:
        placed = 1000.0 * np.array([rig.data.bones[bone["name"]].head_local, rig.data.bones[bone["name"]].tail_local])
        assert np.abs(placed - [bone["head_mm"], bone["tail_mm"]]).max() < 1e-3, bone["name"]
    columns = {bone["name"]: column for column, bone in enumerate(truth["bones"])}
    for name in ("index_distal", "carpus", "thumb_metacarpal"):
        wrong = edited_hands.weights_of(hand, name) - np.asarray(truth["weights"])[:, columns[name]]
        assert np.abs(wrong).max() < 2e-4, name
    pad = truth["region_names"].index("thenar")
    assert np.array_equal(edited_hands.weights_of(hand, "thenar") > 0.5, np.asarray(truth["regions"]) == pad)
    assert [material.thickness_mm for material in hand.thenar.materials] == pytest.approx(list(truth["thickness_mm"]))


def test_pose_and_place_stay(hand, rig):
    bpy.ops.thenar.apply_pose(name="power_48")
    rig.matrix_world = Matrix.Translation((0.3, -0.1, 0.2)) @ Matrix.Rotation(0.7, 4, (1.0, 2.0, 3.0))
    before, place = edited_hands.bends_deg(rig), rig.matrix_world.copy()
    hand.thenar_hand.percentile = 95.0
    hand.thenar_hand.sex = "female"
    after = edited_hands.bends_deg(rig)
    assert rig.matrix_world == place
    assert max(before.values()) > 60.0
    for joint, bend in before.items():
        if "metacarpal" not in joint[0] and "forearm" not in joint[1]:  # those rest elsewhere in a broader hand
            assert after[joint] == pytest.approx(bend, abs=0.1), joint


def test_the_other_side_is_the_mirror_image_in_pose_too(hand, rig):
    bpy.ops.thenar.apply_pose(name="precision")
    rig.pose.bones["index_proximal"].rotation_euler.z += 0.15
    right = edited_hands.shown_mm(hand)
    hand.thenar_hand.side = "left"
    left = edited_hands.shown_mm(hand)
    assert np.abs(right * [-1.0, 1.0, 1.0] - left).max() < 0.01
    hand.thenar_hand.side = "right"
    assert np.abs(edited_hands.shown_mm(hand) - right).max() < 0.01


def test_joint_limits_are_mirrored_with_the_side(hand, rig):
    limit = rig.pose.bones["index_proximal"].constraints["Joint limits"]
    limit.min_z, limit.max_z = -0.1, 0.3
    hand.thenar_hand.side = "left"
    assert (limit.min_z, limit.max_z) == pytest.approx((-0.3, 0.1))


def test_a_length_makes_the_size_measured_and_a_percentile_takes_it_back(hand):
    shape = hand.thenar_hand
    assert (shape.size, shape.length_mm, shape.breadth_mm) == ("PERCENTILE", pytest.approx(189.0), pytest.approx(87.0))
    shape.length_mm = 180.0
    assert (shape.size, shape.breadth_mm) == ("OWN", pytest.approx(87.0))
    shape.percentile = 50.0
    assert (shape.size, shape.length_mm) == ("PERCENTILE", pytest.approx(189.0))


def test_a_size_that_nobody_has_is_refused_in_a_sentence_and_the_number_goes_back(hand):
    shape, before = hand.thenar_hand, edited_hands.rest_mm(hand)
    shape.length_mm = 300.0
    assert "300" in shape.problem and shape.length_mm == pytest.approx(189.0) and shape.size == "OWN"
    assert np.array_equal(edited_hands.rest_mm(hand), before)
    shape.length_mm = 195.0
    assert shape.problem == "" and shape.length_mm == pytest.approx(195.0)


def test_a_hand_saved_and_opened_again_is_still_editable(hand, tmp_path):
    bpy.ops.thenar.apply_pose(name="pinch")
    hand.thenar_hand.percentile = 80.0
    bends = edited_hands.bends_deg(hand.parent)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "hand.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "hand.blend"))
    hand = bpy.context.scene.thenar.hand
    assert hand.thenar_hand.percentile == 80.0
    hand.thenar_hand.percentile = 20.0
    assert np.abs(edited_hands.rest_mm(hand) - thenar.hand(percentile=20)["vertices_mm"]).max() < 1e-3
    after = edited_hands.bends_deg(hand.parent)
    key = ("index_middle", "index_proximal")
    assert after[key] == pytest.approx(bends[key], abs=0.1)


def test_undo_brings_the_earlier_hand_back(hand):
    bpy.ops.thenar.apply_pose(name="power_60")
    bpy.ops.ed.undo_push(message="before")
    before = edited_hands.shown_mm(hand)
    hand.thenar_hand.percentile = 5.0
    hand.thenar_hand.tone = 5.0
    bpy.ops.ed.undo_push(message="edit")
    bpy.ops.ed.undo()
    hand = bpy.context.scene.thenar.hand
    assert hand.thenar_hand.percentile == 50.0 and hand.thenar_hand.tone == 2.0
    assert np.array_equal(edited_hands.shown_mm(hand), before)
    bpy.ops.ed.redo()
    hand = bpy.context.scene.thenar.hand
    assert len(hand.data.vertices) == len(thenar.hand(percentile=5)["vertices_mm"])


def test_editing_works_while_the_bones_are_posed(hand, rig):
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="POSE")
    rig.pose.bones["index_middle"].rotation_euler.x = 0.5
    hand.thenar_hand.percentile = 10.0
    assert (rig.mode, bpy.context.view_layer.objects.active) == ("POSE", rig)
    assert rig.pose.bones["index_middle"].rotation_euler.x == pytest.approx(0.5)
    bpy.ops.object.mode_set(mode="OBJECT")


@pytest.mark.parametrize("edit", [{}, {"percentile": 3.0}, {"side": "left"}])
def test_bones_are_not_drawn_through_the_skin_and_have_rings_outside_of_it(hand, rig, edit):
    for name, value in edit.items():
        setattr(hand.thenar_hand, name, value)
    assert not rig.show_in_front
    for name in ("index_proximal", "little_distal", "thumb_distal", "carpus"):
        bone, rest = rig.pose.bones[name], np.array(rig.data.bones[name].matrix_local)
        radius = 1000.0 * bone.custom_shape_scale_xyz.x * max(v.co.length for v in bone.custom_shape.data.vertices)
        middle = 1000.0 * (rest[:3, 3] + rest[:3, :3] @ np.array(bone.custom_shape_translation))
        skin = edited_hands.weights_of(hand, name) > 0.5 if name != "carpus" else slice(None)
        off = (edited_hands.rest_mm(hand)[skin] - middle) @ rest[:3, :3]
        away = np.hypot(*off[np.abs(off[:, 1]) < 2.5][:, [0, 2]].T)
        assert away.max() < radius < 1.5 * away.max(), name


def test_an_older_hand_without_a_record_has_no_shape_to_edit(blender):
    from thenar_blender.hand import build

    hand, _ = build.add_hand(bpy.context, thenar.hand())
    hand.thenar_hand.percentile = 5.0
    assert not hand.thenar_hand.is_made and len(hand.data.vertices) == len(thenar.hand()["vertices_mm"])
