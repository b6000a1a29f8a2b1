"""Recognition from Blender: Detect Bones, the side setting, messages; Rigify itself is the truth."""

import bpy
import pytest
from makers import KINDS
from rig_scenes import into_scene
from thenar_blender.hand_bones import bonemap, posing, reading, roles
from thenar_blender.hand_bones.rig_axes import RigError


@pytest.mark.parametrize("kind", ["makehuman", "daz8", "biped", "openxr", "rigify_deform"])
def test_detect_bones_on_a_whole_body(blender, kind):
    made = KINDS[kind]()
    _, rig = into_scene(made)
    assert bpy.ops.thenar.guess_bones() == {"FINISHED"}
    assert bonemap.get_map(rig) == made.truth["right"]
    rig.thenar_bones.side = "LEFT"
    assert bpy.ops.thenar.guess_bones() == {"FINISHED"}
    assert bonemap.get_map(rig) == made.truth["left"]


def test_a_pose_closes_both_hands_to_the_palm(blender):
    """Arms spread and palms down: closed fingertips lie below the knuckles on either side."""
    made = KINDS["makehuman"]()
    body, rig = into_scene(made)
    for side in ("LEFT", "RIGHT"):
        rig.thenar_bones.side = side
        bonemap.set_map(rig, {})
        posing.guess_bones(bpy.context, body)
        posing.apply_pose(bpy.context, body, "power_48")
        for finger in roles.FINGERS:
            bones = rig.pose.bones
            knuckle, tip = (bones[made.truth[side.lower()][f"{finger}_{part}"]] for part in ("proximal", "distal"))
            assert tip.head.z < knuckle.head.z - 0.01, (side, finger)


def test_a_body_without_hands_says_what_it_has(blender):
    made = KINDS["makehuman"]()
    body, rig = into_scene(made, only={row[0] for row in made.builder.rows if row[0].startswith("toe")})
    with pytest.raises(RigError, match=r"no hand found among the bones of 'Rig': the bones below .* names say foot"):
        reading.read_rig(bpy.context, body)


def test_a_side_that_is_not_there(blender):
    made = KINDS["unity"]()
    body, rig = into_scene(made, only=set(made.truth["left"].values()))
    rig.thenar_bones.side = "RIGHT"
    with pytest.raises(RigError, match="no right hand among the bones of 'Rig', only: left; change Side under Bones"):
        reading.read_rig(bpy.context, body)


def test_what_was_assigned_stays_if_nothing_is_found(blender):
    made = KINDS["makehuman"]()
    body, rig = into_scene(made, only={row[0] for row in made.builder.rows if row[0].startswith("toe")})
    rig.thenar_bones.index_distal = "toe2-3.R"
    with pytest.raises(RuntimeError, match="No hand found"):
        bpy.ops.thenar.guess_bones()
    assert bonemap.get_map(rig) == {"index_distal": "toe2-3.R"}


def test_loose_bones_are_posed_once_they_are_joined(blender):
    """The WebXR profile's file has no hierarchy: a turned knuckle would leave the fingertip behind."""
    made = KINDS["openxr_flat"]()
    body, rig = into_scene(made)
    bpy.ops.thenar.guess_bones()
    assert bonemap.get_map(rig) == made.truth["right"]
    with pytest.raises(RigError, match="does not hang on 'right-index-finger-"):
        posing.apply_pose(bpy.context, body, "power_48")
    places = {bone.name: bone.head_local.copy() for bone in rig.data.bones}
    assert bpy.ops.thenar.join_bones() == {"FINISHED"}
    assert all((rig.data.bones[name].head_local - place).length < 1e-6 for name, place in places.items())
    posing.apply_pose(bpy.context, body, "power_48")
    for finger in roles.FINGERS:
        knuckle, tip = (rig.pose.bones[made.truth["right"][f"{finger}_{part}"]] for part in ("proximal", "distal"))
        assert tip.head.z < knuckle.head.z - 0.01, finger
    assert posing.guess_bones(bpy.context, body)[0] == 20


@pytest.mark.parametrize("is_generated", [False, True])
def test_rigify_itself(blender, is_generated):
    """Blender's own human metarig, and the rig that its generator makes of it."""
    bpy.ops.preferences.addon_enable(module="rigify")
    if not hasattr(bpy.types.Object, "rigify_target_rig") and "rigify" not in bpy.context.preferences.addons:
        pytest.skip("this Blender has no Rigify")
    bpy.ops.object.armature_human_metarig_add()
    rig = bpy.context.object
    if is_generated:
        bpy.ops.pose.rigify_generate()
        rig = next(obj for obj in bpy.data.objects if obj.type == "ARMATURE" and obj is not rig)
    mesh = bpy.data.meshes.new("Body")
    names = [bone.name for bone in rig.data.bones if bone.use_deform]
    mesh.from_pydata([rig.data.bones[name].head_local for name in names], [], [])
    body = bpy.data.objects.new("Body", mesh)
    bpy.context.scene.collection.objects.link(body)
    for k, name in enumerate(names):
        body.vertex_groups.new(name=name).add([k], 1.0, "REPLACE")
    body.modifiers.new("Armature", "ARMATURE").object = rig
    prefix = "DEF-" if is_generated else ""
    for side, mark in (("LEFT", "L"), ("RIGHT", "R")):
        rig.thenar_bones.side = side
        found = reading.find_bones(bpy.context, body).chosen.roles
        assert found["wrist"] == f"{prefix}hand.{mark}" and len(found) == 20
        assert found["thumb_metacarpal"] == f"{prefix}thumb.01.{mark}"
        assert found["little_metacarpal"] == f"{prefix}palm.04.{mark}"
        for finger, word in (("index", "index"), ("middle", "middle"), ("ring", "ring"), ("little", "pinky")):
            assert found[f"{finger}_proximal"] == f"{prefix}f_{word}.01.{mark}"
            assert found[f"{finger}_distal"] == f"{prefix}f_{word}.03.{mark}"
