"""Every state from which no right result can come is refused with one sentence, and nothing is changed."""

import bpy
import numpy as np
import pytest
import stage


def hide_viewport(hand, product):
    hand.hide_viewport = True


def exclude_collection(hand, product):
    collection = bpy.data.collections.new("Away")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(product)
    bpy.context.scene.collection.objects.unlink(product)
    bpy.context.view_layer.layer_collection.children["Away"].exclude = True


def disable_collection(hand, product):
    collection = bpy.data.collections.new("Away")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(product)
    bpy.context.scene.collection.objects.unlink(product)
    collection.hide_viewport = True


def edit(role):
    def enter(hand, product):
        bpy.context.view_layer.objects.active = hand if role == "hand" else product
        bpy.ops.object.mode_set(mode="EDIT")

    return enter


def share_mesh(hand, product):
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Twin", hand.data))


def absolute_keys(hand, product):
    hand.shape_key_add(name="Basis")
    hand.data.shape_keys.use_relative = False


def pin_key(hand, product):
    hand.shape_key_add(name="Basis")
    hand.show_only_shape_key = True


def not_a_number(hand, product):
    hand.data.vertices[7].co.x = float("nan")


def infinite(hand, product):
    hand.data.vertices[7].co.z = -float("inf")


def product_not_a_number(hand, product):
    product.data.vertices[3].co.y = float("inf")


def thousand_times(hand, product):
    for obj in (hand, product):
        obj.scale *= 1000


def tiny(hand, product):
    hand.scale *= 1e-4


def zero_scale(hand, product):
    hand.scale.z = 0


def no_faces(hand, product):
    hand.data.clear_geometry()


def decimate(hand, product):
    hand.modifiers.new("Fewer", "DECIMATE").ratio = 0.5


def camera_as_hand(hand, product):
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.thenar.hand = camera


def camera_as_product(hand, product):
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.thenar.product = camera


def same_object(hand, product):
    bpy.context.scene.thenar.product = hand


def bare_curve(hand, product):
    bpy.ops.curve.primitive_bezier_curve_add()
    bpy.context.object.name = "Wire"
    bpy.context.scene.thenar.product = bpy.context.object


def empty_collection(hand, product):
    settings = bpy.context.scene.thenar
    settings.product, settings.product_collection = None, bpy.data.collections.new("Parts")


def missing_group(hand, product):
    hand.thenar.materials.add().name = "thumb"


def unpainted_group(hand, product):
    hand.vertex_groups.new(name="thumb")
    hand.thenar.materials.add().name = "thumb"


def no_direction(hand, product):
    settings = bpy.context.scene.thenar
    settings.use_force, settings.direction_mode, settings.direction = True, "OWN", (0, 0, 0)


def unlinked(hand, product):
    bpy.context.scene.collection.objects.unlink(product)


def held_product(hand, product):
    target = bpy.data.objects.new("Holder", None)
    target.location = product.location
    bpy.context.scene.collection.objects.link(target)
    product.constraints.new("COPY_LOCATION").target = target
    settings = bpy.context.scene.thenar
    settings.use_force, settings.force_n = True, 5.0


STATES = {
    "hidden": (hide_viewport, "'Pad' is disabled in viewports"),
    "excluded": (exclude_collection, "'Plate' is not in the view layer"),
    "disabled collection": (disable_collection, "collection of the product 'Plate' is disabled"),
    "hand in edit mode": (edit("hand"), "'Pad' is in Edit Mode"),
    "product in edit mode": (edit("product"), "'Plate' is in Edit Mode"),
    "shared mesh": (share_mesh, "'Pad' is shared.*Make Single User"),
    "absolute keys": (absolute_keys, "'Pad' are absolute"),
    "pinned key": (pin_key, "'Pad' is pinned"),
    "nan": (not_a_number, "[Vv]ertex 7 of the hand 'Pad' is not a number"),
    "infinity": (infinite, "[Vv]ertex 7 of the hand 'Pad' is not a number"),
    "product nan": (product_not_a_number, "[Vv]ertex 3 of the product 'Plate'"),
    "scale 1000 off": (thousand_times, "'Pad' is 16 m long"),
    "tiny": (tiny, "'Pad' is 0.0016 mm long"),
    "zero scale": (zero_scale, "scale of 'Pad' is zero"),
    "no faces": (no_faces, "'Pad' has no faces"),
    "decimate": (decimate, "'Fewer' on 'Pad'"),
    "camera as hand": (camera_as_hand, "'Camera' is a camera"),
    "camera as product": (camera_as_product, "'Camera' is a camera"),
    "same object": (same_object, "'Pad' is both"),
    "bare curve": (bare_curve, "'Wire' has no faces"),
    "empty collection": (empty_collection, "[Nn]o product is chosen"),
    "missing group": (missing_group, "'Pad' has no vertex group 'thumb'"),
    "unpainted group": (unpainted_group, "no vertex of 'Pad' belongs to a region|No vertex of 'Pad'"),
    "no direction": (no_direction, "direction of the force is zero"),
    "unlinked": (unlinked, "'Plate' is not in the view layer"),
    "held product": (held_product, "'Plate' is held by a constraint"),
}


@pytest.mark.parametrize("state", STATES, ids=lambda name: name.replace(" ", "-"))
def test_refused_with_a_sentence(state):
    hand, product = stage.scene()
    change, sentence = STATES[state]
    change(hand, product)
    bpy.context.view_layer.update()
    names, place = sorted(hand.data.attributes.keys()), tuple(product.delta_location)
    with pytest.raises(RuntimeError, match=sentence):
        bpy.ops.thenar.solve()
    assert sorted(hand.data.attributes.keys()) == names
    assert hand.data.shape_keys is None or "Thenar Contact" not in hand.data.shape_keys.key_blocks
    assert tuple(product.delta_location) == place
    assert not bpy.context.scene.thenar.result.is_valid
    assert not [obj for obj in bpy.data.objects if obj.name.startswith(".thenar")]


def test_unit_fix_is_the_right_one():
    hand, product = stage.scene()
    for obj in (hand, product):
        obj.scale *= 9
        obj.scale *= 1000
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match=r"Unit Scale to 0.001 \(it is 1\)"):
        bpy.ops.thenar.solve()


def test_poll_explains_itself():
    with pytest.raises(RuntimeError, match="Choose the hand's mesh"):
        bpy.ops.thenar.solve()
    bpy.context.scene.thenar.hand = stage.pad()
    with pytest.raises(RuntimeError, match="Choose the product"):
        bpy.ops.thenar.solve()
    with pytest.raises(RuntimeError, match="press Solve first"):
        bpy.ops.thenar.export(filepath="/nowhere.csv")
    with pytest.raises(RuntimeError, match="press Solve first"):
        bpy.ops.thenar.show_pressure()


def test_linked_hand_is_refused(tmp_path):
    stage.scene()
    library = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=library)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    product = stage.plate()
    with bpy.data.libraries.load(library, link=True) as (_, wanted):
        wanted.objects = ["Pad"]
    hand = wanted.objects[0]
    bpy.context.scene.collection.objects.link(hand)
    settings = bpy.context.scene.thenar
    settings.hand, settings.product = hand, product
    with pytest.raises(RuntimeError, match="'Pad' is linked from a library.*Make Local"):
        bpy.ops.thenar.solve()
    override = hand.override_create(remap_local_usages=True)
    bpy.context.scene.thenar.hand = override
    with pytest.raises(RuntimeError, match="mesh of 'Pad' is linked"):
        bpy.ops.thenar.solve()


def test_swallowed_hand_is_a_result_or_a_sentence():
    hand, product = stage.scene()
    product.location.z = 0
    bpy.context.view_layer.update()
    try:
        result = stage.solve()
    except RuntimeError as refusal:
        assert "inside" in str(refusal)
    else:
        assert np.isfinite([result.force_n, result.area_mm2, result.peak_kpa]).all() and result.warnings


def test_hidden_by_the_eye_is_no_obstacle():
    hand, product = stage.scene()
    expected = stage.solve().force_n
    bpy.ops.thenar.clear()
    product.hide_set(True)
    product.hide_render = True
    assert stage.solve().force_n == pytest.approx(expected, rel=1e-6)
