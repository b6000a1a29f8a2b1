"""A bake plays what a solve of each frame gives, survives reloading, and is whole or not there."""

import bpy
import numpy as np
import pytest
import stage


def animated(tmp_path, prepare=lambda hand: None):
    hand, product = stage.scene(top=-7.5)
    prepare(hand)
    bpy.context.view_layer.update()
    stage.raise_under(hand, product, depth=0.5)
    for frame, rise in ((1, 0.0), (3, 0.001)):
        product.location.z += rise
        product.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "grip.blend"))
    return bpy.data.objects["Pad"], bpy.data.objects["Plate"]


def unmoved_places(product):
    """World place of the product by frame, as its keys say."""
    places = {}
    for frame in (1, 2, 3):
        bpy.context.scene.frame_set(frame)
        places[frame] = product.matrix_world.translation.copy()
    return places


def solved_frames(hand, look=lambda: None):
    """Shape, pressure and force by frame, and what `look` saw then, by a solve of each."""
    shapes, seen = {}, {}
    for frame in (1, 2, 3):
        bpy.context.scene.frame_set(frame)
        result = stage.solve()
        shapes[frame] = stage.evaluated(hand), stage.attribute(hand, "pressure_kpa"), result.force_n
        seen[frame] = look()
        bpy.ops.thenar.clear()
    return shapes, seen


@pytest.mark.parametrize("prepare", [lambda hand: None, stage.bend], ids=["plain", "armature"])
def test_bake_plays_the_frames_as_solved(tmp_path, prepare):
    hand, _ = animated(tmp_path, prepare)
    expected, _ = solved_frames(hand)
    bpy.context.scene.frame_set(2)
    assert bpy.ops.thenar.bake(frame_start=1, frame_end=3) == {"FINISHED"}
    assert bpy.context.scene.frame_current == 2
    path = str(tmp_path / "grip.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    hand = bpy.data.objects["Pad"]
    for frame in (3, 1, 2):
        bpy.context.scene.frame_set(frame)
        shape, pressure, _ = expected[frame]
        assert np.abs(stage.evaluated(hand) - shape).max() < 0.01, frame
        assert np.abs(stage.attribute(hand, "pressure_kpa") - pressure).max() < 1e-3 * pressure.max()
    assert expected[3][2] > expected[1][2] > 0


def test_bake_with_a_force_moves_the_product_in_every_frame(tmp_path):
    hand, product = animated(tmp_path)
    settings = bpy.context.scene.thenar
    settings.use_force, settings.force_n = True, 2.0
    expected, places = solved_frames(hand, lambda: product.matrix_world.translation.copy())
    bpy.context.scene.frame_set(2)
    homes = unmoved_places(product)
    assert bpy.ops.thenar.bake(frame_start=1, frame_end=3) == {"FINISHED"}
    path = str(tmp_path / "grip.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    hand, product = bpy.data.objects["Pad"], bpy.data.objects["Plate"]
    for frame in (3, 1, 2):
        bpy.context.scene.frame_set(frame)
        shape, pressure, force = expected[frame]
        assert force == pytest.approx(2.0, rel=0.01)
        assert np.abs(stage.evaluated(hand) - shape).max() < 0.01, frame
        assert np.abs(stage.attribute(hand, "pressure_kpa") - pressure).max() < 1e-3 * pressure.max()
        moved = product.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world.translation
        assert (moved - places[frame]).length < 1e-5, "m; a hundredth of a mm"
        assert (moved - homes[frame]).length > 1e-5, "the force is another than where the product stands"
    bpy.ops.thenar.clear()
    assert {frame: tuple(place) for frame, place in unmoved_places(product).items()} == {
        frame: tuple(place) for frame, place in homes.items()
    }


def test_a_force_that_a_held_product_cannot_follow_is_refused(tmp_path):
    hand, product = animated(tmp_path)
    product.constraints.new("LIMIT_LOCATION").use_min_z = True
    product.constraints[0].use_max_z = True
    bpy.context.scene.thenar.use_force = True
    with pytest.raises(RuntimeError, match="'Plate' is held by a constraint or driver"):
        bpy.ops.thenar.bake(frame_start=1, frame_end=3)
    assert not hand.modifiers and tuple(product.delta_location) == (0.0, 0.0, 0.0)


def test_clear_takes_the_bake_away(tmp_path):
    hand, _ = animated(tmp_path)
    bpy.ops.thenar.bake(frame_start=1, frame_end=2)
    with pytest.raises(RuntimeError, match="'Pad' plays a bake; press Clear first"):
        bpy.ops.thenar.solve()
    bpy.ops.thenar.clear()
    assert not hand.modifiers and not hand.thenar.bake_path
    assert bpy.ops.thenar.solve() == {"FINISHED"}


def test_a_frame_that_cannot_be_pressed_leaves_nothing(tmp_path):
    hand, product = animated(tmp_path)
    product.hide_viewport = False
    product.keyframe_insert("hide_viewport", frame=1)
    product.hide_viewport = True
    product.keyframe_insert("hide_viewport", frame=3)
    bpy.context.scene.frame_set(1)
    with pytest.raises(RuntimeError, match="'Plate' is disabled in viewports"):
        bpy.ops.thenar.bake(frame_start=1, frame_end=3)
    assert not hand.modifiers and bpy.context.scene.frame_current == 1
    assert not [path for path in tmp_path.rglob("*") if path.suffix in (".pc2", ".npz", ".partial")]


def test_refused_ranges(tmp_path):
    stage.scene()
    with pytest.raises(RuntimeError, match="save the file first"):
        bpy.ops.thenar.bake(frame_start=1, frame_end=2)
    with pytest.raises(RuntimeError, match="before it starts"):
        bpy.ops.thenar.bake(frame_start=3, frame_end=2)


def test_a_bake_takes_fields_of_the_press_before_it_away(tmp_path):
    hand, _ = animated(tmp_path)
    stage.solve()
    of_one_press = ("contact_force_n", "contact_displacement_mm")
    assert set(of_one_press) <= set(hand.data.attributes.keys())
    assert bpy.ops.thenar.bake(frame_start=1, frame_end=2) == {"FINISHED"}
    assert not set(of_one_press) & set(hand.data.attributes.keys()), "they are of another moment than the one shown"
    assert {"pressure_kpa", "contact_depth_mm"} <= set(hand.data.attributes.keys())
