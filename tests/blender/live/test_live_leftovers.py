"""Live leaves nothing behind: not on former hands, duplicates, in files, nor when the extension is switched off."""

import bpy
import pytest
import stage
import thenar_blender
from test_live import follow, force, switch, told
from thenar_blender import names, status


def traces():
    """What shows that Live is or was there: modifiers by object, offsets by mesh, node groups."""
    modifiers = [obj.name for obj in bpy.data.objects for one in obj.modifiers if "Live" in one.name]
    offsets = [mesh.name for mesh in bpy.data.meshes if "thenar_live_offset" in mesh.attributes]
    return modifiers, offsets, [group.name for group in bpy.data.node_groups if "Live" in group.name]


def duplicated(obj, linked):
    """As Alt D and Shift D do it."""
    twin = obj.copy()
    if not linked:
        twin.data = obj.data.copy()
    bpy.context.scene.collection.objects.link(twin)
    return twin


def live_scene():
    hand, product = stage.scene()
    switch(True)
    assert force() > 0.0
    return hand, product


@pytest.mark.parametrize("first", ["clear", "exchange", "exchange at once"])
def test_a_hand_that_is_no_longer_the_hand_is_left_as_it_was(scene, first):
    hand, product = live_scene()
    other = stage.pad("Other")
    other.location.z = 0.05
    scene.thenar.hand = None if first == "clear" else other
    if first != "exchange at once":
        follow()
        assert hand.name not in traces()[0] and hand.data.name not in traces()[1]
    switch(False)
    assert traces() == ([], [], [])


@pytest.mark.parametrize("linked", [True, False])
def test_a_duplicate_of_the_hand_does_not_carry_the_modifier(scene, linked):
    hand, product = live_scene()
    twin = duplicated(hand, linked)
    twin.modifiers.new("again", "NODES").node_group = bpy.data.node_groups[names.LIVE_MODIFIER]
    follow()
    assert traces()[0] == [hand.name] and len(twin.modifiers) == 0
    assert traces()[1] == [hand.data.name], "the followed hand keeps its offsets"
    if linked:
        assert "shared by several objects" in told().problem
    switch(False)
    assert traces() == ([], [], [])


def test_switching_the_extension_off_leaves_no_modifier(scene):
    hand, product = live_scene()
    twin = duplicated(hand, linked=False)
    twin.hide_viewport = True
    thenar_blender.unregister()
    assert traces() == ([], [], []) and len(hand.modifiers) == 0
    thenar_blender.register()
    assert not status.live


def test_a_file_with_left_modifiers_is_swept_and_a_live_one_goes_on(scene, tmp_path):
    hand, product = live_scene()
    twin = duplicated(hand, linked=False)
    twin.use_fake_user = True
    name, other = hand.name, twin.name
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "live.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "live.blend"))
    assert traces()[0] == [name] and not bpy.data.objects[other].modifiers
    assert follow() and force() > 0.0
    switch(False)
    assert traces() == ([], [], [])


def test_two_scenes_that_follow_one_hand_leave_it_one_after_the_other(scene):
    hand, product = live_scene()
    second = scene.copy()
    assert second.thenar.live
    switch(False)
    assert traces()[0] == [hand.name]
    second.thenar.live = False
    assert traces() == ([], [], [])
