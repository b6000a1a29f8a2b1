"""A rigged hand of one's own, from a file or from the scene: its bones and regions are found as it is taken."""

import bpy
import numpy as np
import pytest
import stage
from thenar_blender.hand.panel import armature_of
from thenar_blender.panels import main
from thenar_blender.rigging import overlay

FINGERS = ("index", "middle", "ring", "little")


class Lines:
    """A layout that only notes which operators a panel draws."""

    active = alert = scale_y = None

    def __init__(self, drawn):
        self.drawn = drawn

    def operator(self, name, **_):
        self.drawn.append(name)
        return self

    def label(self, **_):
        pass

    def column(self, **_):
        return self

    row = column


def shown_steps():
    """Operators that the main panel puts before a grasp, and whether the grasp waits."""
    drawn = []

    class Context:
        scene = bpy.context.scene

        class region:
            width = 300

        class preferences:
            class system:
                ui_scale = 1.0

    waits = any([draw(Lines(drawn), Context) for draw in main.before_grasp])
    return drawn, waits


@pytest.fixture
def tracked():
    """A made hand as a tracker's export: bones named otherwise and on no other, no group but theirs. Returns it."""
    bpy.ops.thenar.make_hand(spacing_mm=6.0)
    hand = bpy.context.scene.thenar.hand
    rig = armature_of(bpy.context)
    for bone in rig.data.bones:
        bone.name = f"{bone.name.replace('_', '-')}-joint"
    for group in [group for group in hand.vertex_groups if group.name not in rig.data.bones]:
        hand.vertex_groups.remove(group)
    hand.thenar.materials.clear()
    for role in [*rig.thenar_bones.bl_rna.properties.keys()]:
        if role.partition("_")[0] in {*FINGERS, "thumb", "wrist"}:
            setattr(rig.thenar_bones, role, "")
    rig.thenar_bones.axis = "AUTO"
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for bone in rig.data.edit_bones:
        bone.parent = None
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.scene.thenar.hand = None
    return hand


def written(tracked, path):
    """That hand in a file, and the scene empty."""
    for obj in bpy.data.objects:
        obj.select_set(obj in (tracked, tracked.parent))
    if path.suffix == ".glb":
        bpy.ops.export_scene.gltf(filepath=str(path), use_selection=True, export_animations=False)
    else:
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    return str(path)


def heads_mm(armature):
    """Role -> head of its bone in the world, mm."""
    names = {key: getattr(armature.thenar_bones, key) for key in (f"{digit}_distal" for digit in (*FINGERS, "thumb"))}
    return {key: 1e3 * np.array(armature.matrix_world @ armature.pose.bones[name].head) for key, name in names.items()}


@pytest.mark.parametrize("suffix", [".glb", ".blend"])
def test_a_file_gives_a_hand_with_bones_and_regions_that_can_hold_after_joining(tracked, tmp_path, suffix):
    armature = tracked.parent
    expected = {}
    for digit in (*FINGERS, "thumb"):
        head = armature.pose.bones[f"{digit}-distal-joint"].head
        expected[f"{digit}_distal"] = 1e3 * np.array(armature.matrix_world @ head)
    path = written(tracked, tmp_path / f"hand{suffix}")
    assert bpy.ops.thenar.add_hand(filepath=path) == {"FINISHED"}
    hand = bpy.context.scene.thenar.hand
    assert len(hand.thenar.materials) == 19
    armature = armature_of(bpy.context)
    for role, place in heads_mm(armature).items():
        assert place == pytest.approx(expected[role], abs=0.1), role
    assert shown_steps() == (["thenar.join_bones"], True)
    with pytest.raises(RuntimeError, match="Join Loose Bones"):
        bpy.ops.thenar.apply_pose(name="relaxed")
    assert bpy.ops.thenar.join_bones() == {"FINISHED"}
    assert shown_steps() == ([], False)
    assert bpy.ops.thenar.apply_pose(name="relaxed") == {"FINISHED"}


def test_a_hand_of_the_scene_gets_the_same_by_picking_it(tracked):
    bpy.context.view_layer.objects.active = tracked
    assert bpy.ops.thenar.pick_hand() == {"FINISHED"}
    assert len(tracked.thenar.materials) == 19 and len(heads_mm(armature_of(bpy.context))) == 5


def test_a_hand_that_was_only_chosen_is_asked_about(tracked):
    bpy.context.scene.thenar.hand = tracked
    assert shown_steps() == (["thenar.guess_bones"], False)


def test_bones_and_regions_of_ones_own_are_left_alone():
    bpy.ops.thenar.make_hand(spacing_mm=6.0)
    hand = bpy.context.scene.thenar.hand
    hand.thenar.materials.remove(0)
    armature_of(bpy.context).thenar_bones.thumb_distal = "carpus"
    bpy.context.view_layer.objects.active = hand
    bpy.ops.thenar.pick_hand()
    assert len(hand.thenar.materials) == 18
    assert armature_of(bpy.context).thenar_bones.thumb_distal == "carpus"


def test_of_several_meshes_of_a_rig_the_one_with_fingers_is_the_hand(tracked):
    hair = stage.pad("Hair", fineness=6)
    hair.modifiers.new("Armature", "ARMATURE").object = tracked.parent
    hair.vertex_groups.new(name="forearm-joint").add(range(len(hair.data.vertices)), 1.0, "REPLACE")
    assert len(hair.data.vertices) > len(tracked.data.vertices)
    bpy.context.view_layer.objects.active = tracked.parent
    bpy.ops.thenar.pick_hand()
    assert bpy.context.scene.thenar.hand == tracked


def test_what_is_no_hand_is_taken_with_a_warning_and_nothing_else_is_changed(capfd):
    hand, _ = stage.scene()
    stage.bend(hand)
    bpy.context.view_layer.objects.active = hand
    assert bpy.ops.thenar.pick_hand() == {"FINISHED"}
    assert bpy.context.scene.thenar.hand == hand and not hand.thenar.materials
    assert "o hand found among the bones" in "".join(capfd.readouterr())


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("hand.step", b"x", "cannot be read as a hand"),
        ("hand.glb", b"no glTF at all", "no complete GLB"),
        ("hand.blend", b"no blend at all", "could not be read"),
        ("gone.blend", None, "there is no file|There is no file"),
    ],
)
def test_a_file_that_is_no_hand_changes_nothing(tmp_path, name, content, message):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    kept = stage.pad()
    before = len(bpy.data.objects), len(bpy.data.meshes), len(bpy.data.armatures)
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.thenar.add_hand(filepath=str(path))
    assert (len(bpy.data.objects), len(bpy.data.meshes), len(bpy.data.armatures)) == before
    assert bpy.context.scene.thenar.hand is None and bpy.context.object == kept


def test_the_digits_lines_do_not_cover_a_map(tracked):
    bpy.context.view_layer.objects.active = tracked
    bpy.ops.thenar.pick_hand()
    assert set(overlay.shown()) == {*FINGERS, "thumb"}
    tracked.thenar.shows_pressure = True
    assert overlay.shown() == {}
