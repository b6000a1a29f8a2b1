"""A hand of a character: the character stays where it stands, and the product comes into the hand."""

import bpy
import numpy as np
import pytest
import thenar
from characters import box, character, grasp, handle, skin_mm, world_of
from makers import KINDS
from mathutils import Matrix
from rig_scenes import into_scene
from thenar_blender.grasp import fitting
from thenar_blender.grasp_fit import fitter, walls
from thenar_blender.hand import build, pads
from thenar_blender.hand_bones import bodies
from thenar_blender.hand_shape import framing
from thenar_blender.looks import putting
from thenar_blender.panels import main
from thenar_blender.scene.checks import Refusal


@pytest.fixture(scope="module")
def made():
    return thenar.hand()


def between(first, second):
    """Where the second object is as the first one sees it."""
    return np.linalg.inv(world_of(first)) @ world_of(second)


def test_the_product_comes_to_the_hand_of_a_body(blender, made):
    hand, rig = character(made)
    product = handle()
    stood, before = (world_of(hand), world_of(rig)), skin_mm(hand)
    fit, found = grasp(hand)
    assert np.array_equal(world_of(hand), stood[0]) and np.array_equal(world_of(rig), stood[1])
    arm_and_trunk = slice(-16, None)
    assert np.abs(skin_mm(hand)[arm_and_trunk] - before[arm_and_trunk]).max() < 1e-3, "the body did not move"
    assert not bodies.hand_skin(bpy.context, hand, hand.data)[arm_and_trunk].any()
    shape = 1e-3 * skin_mm(product)
    gap = walls.Gauge(thenar.Product(1e3 * shape, fit.product_mm[1]), is_thin=False).gaps(skin_mm(hand))
    for pad in fit.hand.pads:
        assert pads.pad_depth(gap[pad.rows]) == pytest.approx(found.depths_mm[pad.name], abs=0.05)


def test_hand_to_product_and_product_to_hand_are_the_same_grasp(blender, made):
    """Only the motion between the two counts."""
    seen = []
    for moves in ("HAND", "PRODUCT"):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        hand, rig = character(made)
        product = handle()
        grasp(hand, moves)
        seen.append(between(rig, product))
    assert np.abs(seen[0] - seen[1]).max() < 1e-5


def test_a_forearm_is_no_body(blender, made):
    hand, rig = character(made, has_body=False)
    product = handle()
    places = world_of(product), world_of(rig)
    grasp(hand)
    assert np.array_equal(world_of(product), places[0]) and not np.allclose(world_of(rig), places[1], atol=0.01)


def test_what_is_part_of_a_body(blender, made):
    """By the skin of any mesh on its armature, or by a second hand; whatever the unit, the scale and the place."""
    context = bpy.context
    hand, rig = build.add_hand(context, made)
    assert not bodies.is_part_of_body(context, hand)
    far = box("Trunk", (-0.2, -1.2, -0.3), (0.2, -0.8, 0.3))
    far.modifiers.new("Armature", "ARMATURE").object = rig
    assert bodies.is_part_of_body(context, hand)
    assert not bodies.is_part_of_body(context, hand, [far]), "a product on the same armature is no skin"
    near = box("Glove", (-0.1, -0.1, -0.1), (0.1, 0.2, 0.1))
    far.modifiers.clear()
    near.modifiers.new("Armature", "ARMATURE").object = rig
    assert not bodies.is_part_of_body(context, hand)
    rig.scale = (100.0, 100.0, 100.0)
    context.scene.unit_settings.scale_length = 0.01
    context.view_layer.update()
    assert not bodies.is_part_of_body(context, hand)
    far.modifiers.new("Armature", "ARMATURE").object = rig
    far.scale = (100.0, 100.0, 100.0)
    context.view_layer.update()
    assert bodies.is_part_of_body(context, hand)


def test_two_hands_on_one_armature_are_a_body(blender, monkeypatch):
    """Also without arms; but not where the other hand's groups are empty, as a file of one hand keeps them."""
    monkeypatch.setattr(bodies, "REACH", np.inf)
    rig = KINDS["makehuman"]()
    right, left = (set(rig.truth[side].values()) for side in ("right", "left"))
    pair, _ = into_scene(rig, only=right | left)
    assert bodies.is_part_of_body(bpy.context, pair)
    alone, _ = into_scene(rig, only=right)
    assert not bodies.is_part_of_body(bpy.context, alone)
    for name in left:
        alone.vertex_groups.new(name=name)
    assert not bodies.is_part_of_body(bpy.context, alone)


def test_parts_keep_their_places_to_each_other(blender, made):
    """A part under a turned and scaled empty, a guard that hangs on it, a part of its own, and a table that stays."""
    hand, _ = character(made)
    product = handle()
    group = bpy.data.objects.new("Group", None)
    table = box("Table", (2.0, 2.0, 0.0), (3.0, 3.0, 0.1))
    guard, cap = box("Guard", (-0.04, -0.04, 0.06), (0.04, 0.04, 0.07)), box("Cap", (0.9, 0.4, 0.3), (0.92, 0.42, 0.32))
    bpy.context.scene.collection.objects.link(group)
    group.matrix_world = Matrix.Translation((1.0, 2.0, 3.0)) @ Matrix.Rotation(1.0, 4, "Y") @ Matrix.Scale(2.0, 4)
    home = bpy.data.collections.new("Product")
    bpy.context.scene.collection.children.link(home)
    for obj in (product, cap):
        home.objects.link(obj)
    bpy.context.scene.thenar.product_collection = home
    bpy.context.view_layer.update()
    for child, parent in ((product, group), (table, group), (guard, product)):
        child.parent, child.matrix_parent_inverse = parent, parent.matrix_world.inverted()
    bpy.context.view_layer.update()
    places = {obj.name: between(product, obj) for obj in (guard, cap)}
    stays = world_of(table), world_of(group), world_of(hand)
    was = world_of(product)
    grasp(hand)
    assert not np.allclose(world_of(product), was, atol=0.1)
    for name, place in places.items():
        assert np.abs(between(product, bpy.data.objects[name]) - place).max() < 1e-5, name
    for obj, place in zip((table, group, hand), stays, strict=True):
        assert np.abs(world_of(obj) - place).max() < 1e-6, obj.name


def test_an_empty_above_the_parts_alone_comes_along(blender, made):
    hand, _ = character(made)
    product = handle()
    group = bpy.data.objects.new("Imported", None)
    bpy.context.scene.collection.objects.link(group)
    product.parent = group
    bpy.context.view_layer.update()
    place = between(group, product)
    grasp(hand)
    assert np.array_equal(between(group, product), place) or np.abs(between(group, product) - place).max() < 1e-6


def test_a_product_that_hangs_on_the_hand(blender, made):
    """A prop on the wrist's bone comes into the hand, and stays on its bone."""
    hand, rig = character(made)
    product = handle()
    product.parent, product.parent_type, product.parent_bone = rig, "BONE", "carpus"
    bpy.context.view_layer.update()
    stood = world_of(rig)
    fit, found = grasp(hand)
    assert product.parent == rig and np.array_equal(world_of(rig), stood)
    gap = walls.Gauge(thenar.Product(skin_mm(product), fit.product_mm[1]), is_thin=False).gaps(skin_mm(hand))
    depths = [pads.pad_depth(gap[pad.rows]) - found.depths_mm[pad.name] for pad in fit.hand.pads]
    assert np.abs(depths).max() < 0.05


def _keyed(product):
    product.keyframe_insert("location", frame=1)


def _constrained(product):
    target = bpy.data.objects.new("Stand", None)
    bpy.context.scene.collection.objects.link(target)
    product.constraints.new("COPY_LOCATION").target = target


def _driven(product):
    product.driver_add("location", 0).driver.expression = "0.5"


@pytest.mark.parametrize(
    ("hold", "words"),
    [(_keyed, "has keyframes of its place"), (_constrained, "held by a constraint"), (_driven, "held by a constraint")],
    ids=["keys", "constraint", "driver"],
)
def test_a_constrained_product_is_refused_with_a_remedy(blender, made, hold, words):
    """By the button before anything is computed; neither the product nor a finger moves."""
    hand, rig = character(made)
    product = handle()
    hold(product)
    bpy.context.view_layer.update()
    place, fingers = world_of(product), [np.array(bone.matrix) for bone in rig.pose.bones]
    with pytest.raises(RuntimeError, match=words + r".* set Moves to Hand"):
        bpy.ops.thenar.fit_grasp()
    bpy.context.view_layer.update()
    assert np.array_equal(world_of(product), place)
    assert all(np.array_equal(bone.matrix, was) for bone, was in zip(rig.pose.bones, fingers, strict=True))


def test_a_product_that_was_constrained_meanwhile_leaves_the_hand_as_it_was(blender, made):
    hand, rig = character(made)
    product = handle()
    fit = fitting.prepare(bpy.context, hand, [product], fitter.Wish(pads.LIGHT_MM))
    found = fitting.compute(fit)
    fingers = [np.array(bone.matrix_basis) for bone in rig.pose.bones]
    _constrained(product)
    with pytest.raises(Refusal, match="held by a constraint"):
        fitting.finish(bpy.context, fit, found, "AUTO")
    assert all(np.array_equal(bone.matrix_basis, was) for bone, was in zip(rig.pose.bones, fingers, strict=True))


def test_views_show_the_hand_and_not_the_body(blender, made):
    """Each look frames what is as large as a hand with its product, and of the character shows the hand alone."""
    hand, _ = character(made)
    handle()
    grasp(hand)
    assert bpy.ops.thenar.solve() == {"FINISHED"}
    for kind in (putting.OPENED, putting.PALM, putting.PRODUCT, putting.APART):
        view = putting.put(bpy.context, kind)
        assert np.ptp(view.points, axis=0).max() < 0.6, kind
        assert hand.hide_get(), kind
        shown = [obj for obj in putting.home_of(bpy.context).objects if obj.thenar.copy_of == hand.name]
        assert len(shown) == (kind != putting.PRODUCT), kind
        for obj in shown:
            assert np.ptp(skin_mm(obj), axis=0).max() < 300.0, kind
    fingers_up = putting.put(bpy.context, putting.OPENED).turn[1]
    along = np.array(hand.matrix_world)[:3, :3] @ [0.0, 1.0, 0.0]
    assert fingers_up @ along > 0.8, "the long axis is the hand's, not the body's"
    assert putting.take_back(bpy.context) and not hand.hide_get()


def test_a_view_that_shows_the_grasp_well_is_kept():
    """Normalized device coordinates: all within the square and not a speck."""
    corners = np.array([[x, y, z] for x in (-0.3, 0.3) for y in (-0.3, 0.3) for z in (-0.3, 0.3)])
    assert framing.is_seen(np.eye(4), corners)
    assert not framing.is_seen(np.eye(4), corners + [0.9, 0.0, 0.0]), "cut by the edge"
    assert not framing.is_seen(np.eye(4), 0.1 * corners), "a speck"
    behind = np.eye(4)
    behind[3] = [0.0, 0.0, 1.0, 0.0]
    assert not framing.is_seen(behind, corners), "behind the eye"


def test_one_undo_takes_the_grasp_of_a_body_back(blender, made):
    hand, _ = character(made)
    handle()
    bpy.context.preferences.edit.use_global_undo = True
    bpy.ops.ed.undo_push(message="before")
    place = world_of(bpy.data.objects["Handle"])
    name = hand.name
    grasp(hand)
    bpy.ops.ed.undo_push(message="Fit Grasp")
    assert not np.allclose(world_of(bpy.data.objects["Handle"]), place, atol=0.1)
    bpy.ops.ed.undo()
    bpy.context.view_layer.update()
    assert np.allclose(world_of(bpy.data.objects["Handle"]), place, atol=1e-6)
    rig = next(obj for obj in bpy.data.objects if obj.type == "ARMATURE")
    assert all(bone.matrix_basis == Matrix.Identity(4) for bone in rig.pose.bones) and name in bpy.data.objects


def test_grasp_is_offered_to_a_character_whose_arm_is_posed(blender, made):
    """What counts is whether the fingers rest: animators pose the arm first."""
    hand, rig = character(made)
    rig.pose.bones["upper_arm"].rotation_mode = "XYZ"
    rig.pose.bones["upper_arm"].rotation_euler = (0.4, 0.0, 0.0)
    bpy.context.view_layer.update()
    assert not main._is_posed(hand)
    rig.pose.bones["ring_middle"].rotation_mode = "XYZ"
    rig.pose.bones["ring_middle"].rotation_euler = (0.4, 0.0, 0.0)
    assert main._is_posed(hand)
