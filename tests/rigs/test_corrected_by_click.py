"""A rig that nothing recognises is assigned in at most five clicks; what is assigned is drawn where the bones are."""

import bpy
import numpy as np
import pytest
from bodies import DIGITS
from makers import KINDS
from mathutils import Vector
from rig_scenes import into_scene
from thenar_blender.hand_bones import bonemap, reading
from thenar_blender.hand_bones.rig_axes import RigError
from thenar_blender.rigging import assigning, overlay


def scrambled(blender, kind):
    """A body on which only one hand carries skin, its map cleared, its bones without meaning in their names."""
    made = KINDS[kind]()
    names = {row[0]: f"Bone.{k:03}" for k, row in enumerate(made.builder.rows)}
    made.builder.rows = [(names[n], p and names[p], at, skin) for n, p, at, skin in made.builder.rows]
    truth = {role: names[name] for role, name in made.truth["left"].items()}
    body, rig = into_scene(made, only=set(truth.values()))
    return body, rig, truth


@pytest.mark.parametrize("kind", ["makehuman", "mixamo", "openxr_with_tip_weights", "rigify_metarig", "daz8"])
@pytest.mark.parametrize("segment", ["proximal", "distal"])
def test_five_clicks_assign_every_digit(blender, kind, segment):
    """One bone of each digit, whichever of its chain."""
    body, rig, truth = scrambled(blender, kind)
    for digit in DIGITS:
        for bone in rig.pose.bones:
            _select(bone, bone.name == truth[f"{digit}_{segment}"])
        assert bpy.ops.thenar.assign_digit(digit=digit) == {"FINISHED"}
    found = bonemap.get_map(rig)
    palms = {role for role in truth if role.endswith("metacarpal") and not role.startswith("thumb")}
    assert {role: name for role, name in truth.items() if role not in palms | {"wrist"}}.items() <= found.items()
    assert all(found.get(role, truth[role]) == truth[role] for role in palms)


def test_all_bones_of_loose_digits(blender):
    """Bones without hierarchy or names: the digit's bones are selected together."""
    body, rig, truth = scrambled(blender, "openxr_flat")
    for digit in DIGITS:
        own = {name for role, name in truth.items() if role.startswith(digit)}
        for bone in rig.pose.bones:
            _select(bone, bone.name in own)
        assert bpy.ops.thenar.assign_digit(digit=digit) == {"FINISHED"}
    found = bonemap.get_map(rig)
    assert {role: name for role, name in found.items() if role != "wrist"} == {
        role: name for role, name in truth.items() if role != "wrist"
    }


def test_a_wrong_digit_is_put_right_by_one_click(blender):
    """Index and middle exchanged by hand: assigning one takes its bones from the other."""
    body, rig, truth = scrambled(blender, "unity")
    assigning.assign(bpy.context, body, "middle", [truth["index_middle"]])
    assert bonemap.get_map(rig)["middle_distal"] == truth["index_distal"]
    assigning.assign(bpy.context, body, "index", [truth["index_middle"]])
    assert not any(role.startswith("middle") for role in bonemap.get_map(rig))
    assert bonemap.get_map(rig)["index_distal"] == truth["index_distal"]


def test_bones_that_carry_nothing_are_refused(blender):
    body, rig, truth = scrambled(blender, "unity")
    with pytest.raises(RigError, match="0 of the chosen bones move skin of 'Body', a digit needs two or three"):
        assigning.assign(bpy.context, body, "index", [])


def test_the_lines_follow_the_posed_joints(blender):
    body, rig, truth = scrambled(blender, "makehuman")
    assert overlay.shown() == {}
    bpy.ops.thenar.guess_bones()
    rig.location = (0.3, -0.2, 0.1)
    rig.pose.bones[truth["index_proximal"]].rotation_mode = "XYZ"
    rig.pose.bones[truth["index_proximal"]].rotation_euler.x = 0.7
    bpy.context.view_layer.update()
    drawn = overlay.shown()
    assert list(drawn) == list(DIGITS)
    joints = [truth[f"index_{segment}"] for segment in ("metacarpal", "proximal", "middle", "distal")]
    want = [rig.matrix_world @ rig.pose.bones[name].matrix.translation for name in joints]
    assert np.allclose([tuple(p) for p in drawn["index"][:4]], [tuple(p) for p in want], atol=1e-6)
    rig.thenar_bones.show_digits = False
    assert overlay.shown() == {}


def test_a_line_ends_in_the_fingertip_that_bends(blender):
    """The end keeps its place on the last bone, as skin does; a bent joint turns it."""
    body, rig, truth = scrambled(blender, "makehuman")
    bpy.ops.thenar.guess_bones()
    bone = rig.pose.bones[truth["index_distal"]]
    seen = []
    for bend in (0.0, 1.2):
        bone.rotation_mode = "XYZ"
        bone.rotation_euler.x = bend
        bpy.context.view_layer.update()
        seen.append(bone.matrix.inverted() @ (rig.matrix_world.inverted() @ overlay.shown()["index"][-1]))
    assert (seen[1] - seen[0]).length < 1e-6 and seen[0].length > 0.01


def test_lines_of_a_rig_without_metacarpals_and_with_one_digit(blender):
    body, rig, truth = scrambled(blender, "mixamo")
    rig.thenar_bones.show_digits = True
    assert overlay.shown() == {}
    assigning.assign(bpy.context, body, "ring", [truth["ring_middle"]])
    assert {digit: len(points) for digit, points in overlay.shown().items()} == {"ring": 4}


def test_the_bone_under_the_mouse(blender):
    """Seen from above, one unit is 1000 pixels: a click near a phalanx takes it, a click far off takes none."""
    body, rig, truth = scrambled(blender, "mixamo")
    seen = assigning.screen_bones(rig, set(truth.values()), lambda point: Vector((1000 * point.x, 1000 * point.y)))
    one, two = (rig.pose.bones[truth[f"ring_{part}"]].head for part in ("proximal", "middle"))
    place = 500 * Vector((one.x + two.x, one.y + two.y)) + Vector((0.0, 3.0))
    assert assigning.nearest(seen, place, 20.0) == truth["ring_proximal"]
    assert assigning.nearest(seen, place + Vector((0.0, 500.0)), 20.0) is None


def test_the_panel_and_its_buttons_are_there(blender):
    body, _, _ = scrambled(blender, "mixamo")
    assert bpy.types.THENAR_PT_bones.poll(bpy.context)
    assert reading.find_bones(bpy.context, body).chosen.side is not None


def _select(bone, is_selected):
    if hasattr(bone, "select"):
        bone.select = is_selected
    else:
        bone.bone.select = is_selected
