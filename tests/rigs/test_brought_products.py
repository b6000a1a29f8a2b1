"""Products that come to the hand of a body: what belongs to one comes along, and what cannot is refused."""

import bpy
import numpy as np
import pytest
import thenar
from characters import box, character, grasp, handle, skin_mm, world_of
from makers import KINDS
from mathutils import Matrix
from rig_scenes import into_scene
from thenar_blender.hand_bones import bodies
from thenar_blender.picture_stage import views
from thenar_blender.product_objects import bringing, copies


@pytest.fixture(scope="module")
def made():
    return thenar.hand()


def bring(parts, stays=()):
    """Move a product by a turn and a shift; returns the motion (4, 4)."""
    context, first = bpy.context, parts[0]
    motion = Matrix.Translation((0.3, -0.2, 0.1)) @ Matrix.Rotation(0.7, 4, "Y")
    goals = [(part, motion @ part.matrix_world) for part in parts]
    assert first.matrix_world != goals[0][1]
    with bringing.ExitStack() as undo:
        bringing.bring(context, bringing.carriers(parts, stays), goals, undo)
        undo.pop_all()
    context.view_layer.update()
    return np.array(motion)


def moved(points_mm, motion):
    return points_mm @ motion[:3, :3].T + 1e3 * motion[:3, 3]


def with_rig(product):
    """The product bent by a bone of its own armature."""
    data = bpy.data.armatures.new("Lever")
    rig = bpy.data.objects.new("Lever", data)
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bone = data.edit_bones.new("lever")
    bone.tail = (0.0, 0.0, 0.1)
    bpy.ops.object.mode_set(mode="OBJECT")
    product.parent = rig
    product.vertex_groups.new(name="lever").add(range(len(product.data.vertices)), 1.0, "REPLACE")
    product.modifiers.new("Armature", "ARMATURE").object = rig
    rig.pose.bones["lever"].rotation_mode = "XYZ"
    rig.pose.bones["lever"].rotation_euler = (0.5, 0.0, 0.0)
    bpy.context.view_layer.update()
    return rig


def test_a_product_with_an_armature_of_its_own_keeps_its_shape(blender):
    product = handle()
    rig = with_rig(product)
    before, stood = skin_mm(product), world_of(rig)
    motion = bring([product])
    assert np.abs(skin_mm(product) - moved(before, motion)).max() < 0.01, "mm"
    assert np.allclose(world_of(rig), motion @ stood, atol=1e-5)


def test_a_product_cut_by_an_object_that_stays_is_refused(blender):
    product, cutter = handle(), box("Cutter", (0.98, 0.4, 0.15), (1.1, 0.6, 0.3))
    cut = product.modifiers.new("Cut", "BOOLEAN")
    cut.object, cut.solver = cutter, "EXACT"
    bpy.context.view_layer.update()
    with pytest.raises(bringing.Refusal, match="a modifier of it follows an object that stays"):
        bring([product])


def test_a_product_that_instances_a_collection_comes_far_from_the_origin(blender):
    inner = bpy.data.collections.new("Inner")
    inner.objects.link(box("Block", (0.0, 0.0, 0.0), (0.1, 0.1, 0.1)))
    empty = bpy.data.objects.new("Instance", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", inner
    bpy.context.scene.collection.objects.link(empty)
    empty.matrix_world = Matrix.Translation((57.3, -91.7, 12.9)) @ Matrix.Rotation(1.1, 4, "Z")
    bpy.context.view_layer.update()
    stood = world_of(empty)
    motion = bring([empty])
    assert np.allclose(world_of(empty), motion @ stood, atol=1e-4)


def test_keys_that_the_nla_plays_are_keys(blender):
    product = handle()
    product.keyframe_insert("location", frame=1)
    data = product.animation_data
    action = data.action
    data.nla_tracks.new().strips.new("Held", 1, action)
    data.action = None
    with pytest.raises(bringing.Refusal, match="has keyframes of its place"):
        bring([product])
    data.nla_tracks[0].mute = True
    bring([product])


def test_an_action_without_a_slot_holds_nothing(blender):
    product = handle()
    product.keyframe_insert("location", frame=1)
    if not hasattr(product.animation_data, "action_slot"):
        pytest.skip("this Blender's actions have no slots")
    product.animation_data.action_slot = None
    if hasattr(product.animation_data.action, "fcurves"):
        pytest.skip("this Blender's actions list their curves without a slot")
    bring([product])


def test_the_copy_that_carries_the_map_comes_along(blender, made):
    """A coarse product is hidden behind a finer copy once it is solved."""
    hand, _ = character(made)
    product = box("Handle", (-0.022, -0.022, -0.09), (0.022, 0.022, 0.09))
    product.matrix_world = Matrix.Translation((1.0, 0.5, 0.2))
    bpy.context.scene.thenar.product = product
    bpy.context.view_layer.update()
    grasp(hand)
    assert bpy.ops.thenar.solve() == {"FINISHED"}
    copy = copies.find_copy(product.name)
    assert copy is not None, "this product is coarse"
    apart = np.linalg.inv(world_of(product)) @ world_of(copy)
    rig = next(obj for obj in bpy.data.objects if obj.type == "ARMATURE")
    rig.matrix_world = Matrix.Translation((0.4, 0.2, 0.0)) @ rig.matrix_world
    bpy.context.view_layer.update()
    was = world_of(product)
    grasp(hand)
    assert not np.allclose(world_of(product), was, atol=0.05)
    assert np.abs(np.linalg.inv(world_of(product)) @ world_of(copy) - apart).max() < 1e-5


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize("kind", ["makehuman", "unreal4", "mixamo"])
def test_fingers_of_one_hand_of_a_body_point_from_its_knuckles(blender, kind, side):
    """Two hands on one armature: the mean of all bones says nothing of one hand. Judged by the places of its bones."""
    rig = KINDS[kind]()
    hand, armature = into_scene(rig, only=set(rig.truth[side].values()))
    bones, truth = armature.data.bones, rig.truth[side]
    knuckle, end = (np.array(bones[truth[f"middle_{part}"]].head_local) for part in ("proximal", "distal"))
    wanted = np.array(armature.matrix_world)[:3, :3] @ (end - knuckle)
    nothing = np.zeros((1, 3)), np.zeros(1)
    assert views._towards_tips(bpy.context, *nothing) @ wanted > 0.0, "pictures have the fingers up"
    along = bodies.along_fingers(hand)
    assert along @ wanted > 0.8 * np.linalg.norm(along) * np.linalg.norm(wanted)
