"""The product's size: mistakes of units are refused with a factor; what is really large or small is not."""

import bpy
import numpy as np
import pytest
import stage
from thenar_blender import status
from thenar_blender.scene import sizes

MM = 1e-3
HAND_MM = (189.0, 85.0, 60.0)


def block(name, sides_mm, center_mm=(0.0, 0.0, 0.0)):
    """A box with its sides in its vertices, as importers make it."""
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * 0.5
    points = (corners * sides_mm + np.array(center_mm)) * MM
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(point) for point in points], [], faces)
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def chosen(*products, hand_mm=HAND_MM):
    hand = block("Hand", hand_mm)
    settings = bpy.context.scene.thenar
    settings.hand = hand
    home = bpy.data.collections.new("Parts")
    bpy.context.scene.collection.children.link(home)
    for product in products:
        home.objects.link(product)
    settings.product_collection = home
    bpy.context.view_layer.update()
    return hand


def refusal(call=None):
    with pytest.raises(RuntimeError) as error:
        (call or bpy.ops.thenar.solve)()
    return str(error.value)


def longest_mm(*objects):
    return max(np.ptp(np.concatenate([stage.evaluated(obj) for obj in objects]), axis=0))


# Sides in mm as they are, and what the file's unit was taken for.
MISTAKES = [
    ((125, 38, 32), 1000.0, "125 m"),
    ((125, 38, 32), 100.0, "12.5 m"),
    ((220, 65, 65), 1 / 0.0254, "8.661 m"),
    ((30, 30, 30), 1000.0, "30 m"),
    ((900, 40, 40), 1000.0, "900 m"),
    ((125, 38, 32), 0.001, "0.125 mm"),
    ((125, 38, 32), 0.01, "1.25 mm"),
    ((60, 60, 60), 0.0254, "1.52 mm"),
]


@pytest.mark.parametrize(("sides", "off", "said"), MISTAKES)
def test_a_file_read_in_the_wrong_unit_is_refused_and_the_button_mends_it(sides, off, said):
    product = block("Handle", np.array(sides) * off)
    chosen(product)
    for call in (bpy.ops.thenar.solve, lambda: bpy.ops.thenar.bake(frame_start=1, frame_end=2)):
        text = refusal(call)
        assert f"'Handle' is {said} long" in text and "189 mm" in text and "scale it by" in text
    offered = sizes.measure(bpy.context.scene, bpy.context.scene.thenar.hand, [product]).factors
    nearest = min(offered, key=lambda factor: abs(np.log(factor * off)))
    assert nearest * off == pytest.approx(1.0, rel=1e-6), "the true factor is among those offered"
    assert bpy.ops.thenar.scale_product(factor=nearest) == {"FINISHED"}
    assert longest_mm(product) == pytest.approx(max(sides), rel=1e-5)
    assert "long, the hand" not in message_of_solve()


def message_of_solve():
    """What Solve says; the hand is too coarse for a result, and that is looked at after the sizes."""
    try:
        bpy.ops.thenar.solve()
    except RuntimeError as error:
        return str(error)
    return ""


@pytest.mark.parametrize(
    ("what", "sides", "hand_mm"),
    [
        ("table", (2000, 1000, 750), HAND_MM),
        ("car door", (1500, 1100, 200), HAND_MM),
        ("wall", (5000, 2600, 240), HAND_MM),
        ("car", (4600, 1900, 1500), HAND_MM),
        ("railing", (30000, 1000, 45), HAND_MM),
        ("glass front", (12000, 3000, 20), HAND_MM),
        ("key", (60, 25, 2), HAND_MM),
        ("bead", (5, 5, 5), HAND_MM),
        ("ball under a fingertip patch", (2, 2, 2), (15, 15, 4)),
        ("table under a fingertip patch", (2000, 1000, 30), (15, 15, 4)),
    ],
)
def test_what_is_really_large_or_small_passes(what, sides, hand_mm):
    chosen(block("Product", sides, (0, 0, -sides[2] / 2 - 0.45 * hand_mm[2])), hand_mm=hand_mm)
    assert "long, the hand" not in message_of_solve()


def test_a_size_that_is_accepted_is_not_asked_about_until_it_changes():
    product = block("Bus", (12000, 3000, 2500))
    product.location.z = -1.25 - 0.025
    chosen(product)
    assert "12 m long" in refusal()
    assert bpy.ops.thenar.accept_size() == {"FINISHED"}
    assert "long, the hand" not in message_of_solve()
    product.scale = (3, 3, 3)
    bpy.context.view_layer.update()
    assert "36 m long" in refusal()


def test_parts_and_their_children_keep_their_places_to_each_other():
    handle = block("Handle", (125e3, 38e3, 32e3))
    cap = block("Cap", (20e3, 38e3, 32e3))
    cap.location.x = 75.0
    screw = block("Screw", (5e3, 5e3, 20e3), (0, 0, 20e3))
    screw.parent, screw.location = cap, (0.0, 0.0, 10.0)
    chosen(handle, cap, screw)
    before = np.concatenate([stage.evaluated(obj) for obj in (handle, cap, screw)])
    assert bpy.ops.thenar.scale_product(factor=1e-3) == {"FINISHED"}
    after = np.concatenate([stage.evaluated(obj) for obj in (handle, cap, screw)])
    assert np.allclose(after, before * 1e-3, atol=1e-4)


def test_one_object_keeps_its_origin_and_its_parent_and_turn():
    product = block("Handle", (125e3, 38e3, 32e3))
    holder = bpy.data.objects.new("Holder", None)
    bpy.context.scene.collection.objects.link(holder)
    holder.scale, holder.rotation_euler, holder.location = (2, 2, 2), (0.3, 0.5, 0.7), (1, 2, 3)
    product.parent, product.location, product.rotation_euler = holder, (0.1, 0.2, 0.3), (0.2, 0.0, 0.4)
    chosen(product)
    origin = np.array(product.matrix_world.translation) / MM
    before = stage.evaluated(product)
    assert bpy.ops.thenar.scale_product(factor=5e-4) == {"FINISHED"}
    assert np.allclose(stage.evaluated(product) - origin, 5e-4 * (before - origin), atol=2e-3)


def test_what_cannot_be_scaled_is_refused_and_stays():
    product = block("Handle", (125e3, 38e3, 32e3))
    hand = chosen(product)
    product.scale = (1, 1, 1)
    product.constraints.new("LIMIT_SCALE").use_min_x = True
    product.constraints[0].min_x = 1.0
    before = stage.evaluated(product)
    assert "'Handle' did not take the scale" in refusal(lambda: bpy.ops.thenar.scale_product(factor=1e-3))
    assert np.array_equal(stage.evaluated(product), before)
    product.constraints.clear()
    hand.parent = product
    assert "hand 'Hand' hangs on the product" in refusal(lambda: bpy.ops.thenar.scale_product(factor=1e-3))
    assert np.array_equal(stage.evaluated(product), before)


def test_grasp_and_live_ask_too():
    assert bpy.ops.thenar.make_hand() == {"FINISHED"}
    settings = bpy.context.scene.thenar
    settings.product = block("Handle", (125e3, 38e3, 32e3))
    bpy.context.view_layer.update()
    assert "'Handle' is 125 m long" in refusal(bpy.ops.thenar.fit_grasp)
    settings.live = True
    assert "'Handle' is 125 m long" in status.live[bpy.context.scene.name].problem
    settings.live = False


def test_a_body_is_as_large_as_the_skin_of_its_hand():
    """A character is 1.7 m tall: only what has a region is the hand whose size is asked about."""
    hand, _ = stage.scene()
    group = hand.vertex_groups.new(name="palm")
    group.add(range(len(hand.data.vertices)), 1.0, "REPLACE")
    hand.thenar.materials.add().name = "palm"
    alone = stage.solve().force_n
    bpy.ops.thenar.clear()
    body = block("Body", (400, 300, 1700), (600, 0, 0))
    with bpy.context.temp_override(active_object=hand, selected_editable_objects=[hand, body]):
        bpy.ops.object.join()
    assert longest_mm(hand) > 1600
    assert stage.solve().force_n == pytest.approx(alone, rel=1e-6) and alone > 0.1
    bpy.ops.thenar.clear()
    hand.vertex_groups["palm"].add(range(len(hand.data.vertices)), 1.0, "REPLACE")
    assert "1.7 m long" in refusal()
