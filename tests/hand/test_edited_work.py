"""What the user added to a made hand survives an edit of its shape, or the edit is refused."""

import bmesh
import edited_hands
import numpy as np
import pytest

bpy = pytest.importorskip("bpy")
thenar = pytest.importorskip("thenar")


@pytest.fixture
def hand(blender):
    bpy.ops.thenar.make_hand()
    return bpy.context.scene.thenar.hand


@pytest.fixture
def rig(hand):
    return hand.parent


def mark_tip(hand, rig, bone):
    """A vertex group, a float attribute and a shape key on the tip of one finger; the vertices that have them."""
    tip = edited_hands.fingertip(hand, rig, bone)
    rows = np.flatnonzero(tip).tolist()
    hand.vertex_groups.new(name="Mine").add(rows, 0.75, "REPLACE")
    hand.data.attributes.new("mine", "FLOAT", "POINT").data.foreach_set("value", tip.astype(np.float32))
    hand.shape_key_add(name="Basis")
    key = hand.shape_key_add(name="Swollen")
    for row in rows:
        key.data[row].co.z += 0.002
    key.value = 0.4
    return tip


@pytest.mark.parametrize("edit", [{"percentile": 3.0}, {"percentile": 97.0}, {"side": "left"}, {"length_mm": 205.0}])
def test_groups_attributes_and_shape_keys_go_along_to_the_same_place(hand, rig, edit):
    mark_tip(hand, rig, "middle_distal")
    for name, value in edit.items():
        setattr(hand.thenar_hand, name, value)
    assert hand.thenar_hand.problem == ""
    near = edited_hands.fingertip(hand, rig, "middle_distal")
    key = hand.data.shape_keys.key_blocks["Swollen"]
    lifted = 1000.0 * np.array([point.co.z for point in key.data]) - edited_hands.rest_mm(hand)[:, 2]
    assert key.value == pytest.approx(0.4)
    for values in (edited_hands.weights_of(hand, "Mine") / 0.75, edited_hands.values_of(hand, "mine"), lifted / 2.0):
        assert values.max() == pytest.approx(1.0, abs=0.25) and values.min() > -1e-3
        marked = values > 0.5 * values.max()
        assert (marked & near).sum() > 0.8 * max(marked.sum(), near.sum())


def test_on_the_other_side_a_value_lies_at_the_mirrored_place(hand):
    """A value that is the place across the hand."""
    across = edited_hands.rest_mm(hand)[:, 0].astype(np.float32)
    hand.data.attributes.new("across", "FLOAT", "POINT").data.foreach_set("value", across)
    hand.thenar_hand.side = "left"
    assert np.abs(edited_hands.values_of(hand, "across") + edited_hands.rest_mm(hand)[:, 0]).max() < 0.01


def test_back_and_forth_in_many_steps_loses_nothing(hand, rig):
    mark_tip(hand, rig, "ring_distal")
    hand.vertex_groups["index_distal"].add([0, 1, 2], 0.33, "REPLACE")
    before = [edited_hands.weights_of(hand, "Mine"), edited_hands.values_of(hand, "mine")]
    before += [edited_hands.weights_of(hand, "index_distal")]
    for percentile in (40.0, 20.0, 60.0, 90.0, 50.0):
        hand.thenar_hand.percentile = percentile
    after = [edited_hands.weights_of(hand, "Mine"), edited_hands.values_of(hand, "mine")]
    after += [edited_hands.weights_of(hand, "index_distal")]
    for one, other in zip(before, after, strict=True):
        assert np.array_equal(one, other)


def test_painted_bone_weights_are_kept(hand, rig):
    tip = edited_hands.fingertip(hand, rig, "little_distal")
    hand.vertex_groups["little_distal"].add(np.flatnonzero(tip).tolist(), 0.2, "REPLACE")
    hand.thenar_hand.percentile = 10.0
    near = edited_hands.fingertip(hand, rig, "little_distal")
    assert np.median(edited_hands.weights_of(hand, "little_distal")[near]) == pytest.approx(0.2, abs=0.02)


def test_sculpting_grows_with_the_hand(hand, rig):
    tip = edited_hands.fingertip(hand, rig, "index_distal")
    for row in np.flatnonzero(tip):
        hand.data.vertices[row].co.z -= 0.003
    hand.thenar_hand.percentile = 95.0
    moved = edited_hands.rest_mm(hand) - thenar.hand(percentile=95)["vertices_mm"]
    near = edited_hands.fingertip(hand, rig, "index_distal")
    assert -3.6 < np.median(moved[near & (np.abs(moved[:, 2]) > 0.5)][:, 2]) < -3.0
    assert np.abs(moved[:, 2]).max() < 4.0 and np.abs(moved[:, :2]).max() < 0.01


def test_uv_islands_keep_their_scale(hand):
    """UV coordinates that are the rest positions along two axes: they must follow the vertices, scaled."""
    layer = hand.data.uv_layers.new(name="Flat")
    places = edited_hands.rest_mm(hand)[[loop.vertex_index for loop in hand.data.loops]]
    layer.data.foreach_set("uv", (places[:, :2] / 200.0).astype(np.float32).ravel())
    hand.thenar_hand.length_mm = 198.0
    uv = np.empty(2 * len(hand.data.loops), np.float32)
    hand.data.uv_layers["Flat"].data.foreach_get("uv", uv)
    places = edited_hands.rest_mm(hand)[[loop.vertex_index for loop in hand.data.loops]]
    off = uv.reshape(-1, 2)[:, 1] * 200.0 * 198.0 / 189.0 - places[:, 1]
    assert np.percentile(np.abs(off), 99) < 1.5


def test_drivers_on_shape_keys_stay(hand, rig):
    mark_tip(hand, rig, "index_distal")
    key = hand.data.shape_keys.key_blocks["Swollen"]
    key.driver_add("value").driver.expression = "0.9"
    hand.thenar_hand.percentile = 30.0
    bpy.context.view_layer.update()
    assert hand.data.shape_keys.key_blocks["Swollen"].value == pytest.approx(0.9)


def test_numbers_and_lists_of_the_user_stay(hand):
    materials = hand.thenar.materials
    materials["thenar"].thickness_mm = 11.5
    materials["thenar"].g0_kpa = 12.0
    materials.remove(materials.find("little_proximal pad" if "little_proximal pad" in materials else "hypothenar"))
    names = [material.name for material in materials]
    own = bpy.data.materials.new("My Skin")
    hand.data.materials.append(own)
    hand.data.polygons[100].material_index = 1
    hand.thenar_hand.percentile = 70.0
    assert [material.name for material in hand.thenar.materials] == names
    assert hand.thenar.materials["thenar"].thickness_mm == pytest.approx(11.5)
    assert hand.thenar.materials["thenar"].g0_kpa == pytest.approx(12.0)
    assert hand.data.materials[1] == own and any(polygon.material_index == 1 for polygon in hand.data.polygons)


def test_bones_and_constraints_of_the_user_stay(hand, rig):
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    ring = rig.data.edit_bones.new("ring jewel")
    ring.parent = rig.data.edit_bones["ring_proximal"]
    ring.head, ring.tail = ring.parent.tail, ring.parent.tail + ring.parent.vector * 0.2
    bpy.ops.object.mode_set(mode="OBJECT")
    rig.pose.bones["ring_proximal"].constraints.new("COPY_ROTATION").name = "Mine"
    hand.thenar_hand.percentile = 2.0
    assert "Mine" in rig.pose.bones["ring_proximal"].constraints
    jewel = rig.data.bones["ring jewel"]
    assert (jewel.head_local - rig.data.bones["ring_proximal"].tail_local).length < 5e-4


@pytest.fixture
def pressed(hand, rig):
    """The hand let down 1.5 mm deep on a cube, and the scene's settings."""
    rig.rotation_euler.x = np.pi
    bpy.ops.mesh.primitive_cube_add(size=0.5, location=(0.0, 0.0, 0.0))
    cube, settings = bpy.context.object, bpy.context.scene.thenar
    cube.location.z = 0.001 * (edited_hands.shown_mm(hand)[:, 2].min() + 1.5) - 0.25
    settings.product = cube
    bpy.context.view_layer.update()
    return settings


def test_a_contact_is_cleared_with_its_result(hand, pressed):
    bpy.ops.thenar.solve()
    assert pressed.result.is_valid and "pressure_kpa" in hand.data.attributes
    hand.thenar_hand.tone = 3.0
    assert pressed.result.is_valid
    hand.thenar_hand.percentile = 60.0
    assert not pressed.result.is_valid and "pressure_kpa" not in hand.data.attributes
    assert hand.data.shape_keys is None or "Thenar Contact" not in hand.data.shape_keys.key_blocks


def test_live_comes_first(hand, pressed):
    pressed.live = True
    hand.thenar_hand.percentile = 60.0
    problem, percentile = hand.thenar_hand.problem, hand.thenar_hand.percentile
    pressed.live = False
    assert "Live" in problem and percentile == 50.0


def subdivide(hand, rig):
    work = bmesh.new()
    work.from_mesh(hand.data)
    bmesh.ops.subdivide_edges(work, edges=work.edges[:3], cuts=1)
    work.to_mesh(hand.data)
    work.free()


def move_bone(hand, rig):
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    rig.data.edit_bones["index_middle"].head.x += 0.002
    bpy.ops.object.mode_set(mode="OBJECT")


def rename_bone(hand, rig):
    rig.data.bones["index_middle"].name = "finger"


def share_mesh(hand, rig):
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Twin", hand.data))


def bind(hand, rig):
    hand.modifiers.new("Fine", "MULTIRES")


def seam(hand, rig):
    hand.data.edges[5].use_seam = True


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (subdivide, "mesh was edited"),
        (move_bone, "rest of bone 'index_middle'"),
        (rename_bone, "no bone 'index_middle'"),
        (share_mesh, "shared by several objects"),
        (bind, "'Fine'"),
        (seam, "seams"),
    ],
)
def test_what_would_be_lost_is_refused_in_a_sentence(hand, rig, spoil, said):
    spoil(hand, rig)
    before = edited_hands.rest_mm(hand)
    hand.thenar_hand.percentile = 5.0
    assert said in hand.thenar_hand.problem
    assert hand.thenar_hand.percentile == 50.0 and np.array_equal(edited_hands.rest_mm(hand), before)


def test_an_animated_hand_changes_its_size_and_not_its_side(hand, rig):
    rig.pose.bones["index_middle"].keyframe_insert("rotation_euler", frame=1)
    hand.thenar_hand.side = "left"
    assert "animated" in hand.thenar_hand.problem and hand.thenar_hand.side == "right"
    hand.thenar_hand.percentile = 5.0
    assert hand.thenar_hand.problem == "" and rig.animation_data.action is not None
