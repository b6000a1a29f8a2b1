"""What a file keeps, and when its result is called out of date."""

import bpy
import numpy as np
import pytest
import stage


def out_of_date():
    from thenar_blender import workflow

    return workflow.is_out_of_date(bpy.context)


def test_result_survives_save_and_reload(tmp_path):
    hand, product = stage.scene()
    bpy.context.scene.thenar.use_force = True
    bpy.context.scene.thenar.force_n = 2.0
    result = stage.solve()
    kept = (result.force_n, result.area_mm2, result.offset_mm, [row.name for row in result.regions])
    pressure, shape = stage.attribute(hand, "pressure_kpa"), stage.evaluated(hand)
    path = str(tmp_path / "solved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    hand, result = bpy.data.objects["Pad"], bpy.context.scene.thenar.result
    assert (result.force_n, result.area_mm2, result.offset_mm, [row.name for row in result.regions]) == kept
    assert np.array_equal(stage.attribute(hand, "pressure_kpa"), pressure)
    assert np.abs(stage.evaluated(hand) - shape).max() < 1e-6
    assert not out_of_date()
    assert stage.solve().offset_mm == pytest.approx(kept[2], abs=1e-5), "the product's own place is kept in the file"


CHANGES = {
    "moved hand": lambda hand, product: setattr(hand, "location", (0.0001, 0, 0)),
    "moved product": lambda hand, product: setattr(product, "location", (0, 0, -0.0217)),
    "scaled product": lambda hand, product: setattr(product, "scale", (1.01, 1, 1)),
    "edited vertex": lambda hand, product: setattr(hand.data.shape_keys.key_blocks[0].data[5], "co", (0, 0, 0.0081)),
    "material": lambda hand, product: setattr(hand.thenar.default_material, "g0_kpa", 33),
    "model": lambda hand, product: setattr(bpy.context.scene.thenar, "model", "PAPER"),
    "unit": lambda hand, product: setattr(bpy.context.scene.unit_settings, "scale_length", 0.9),
    "weaker key": lambda hand, product: setattr(hand.data.shape_keys.key_blocks["Thenar Contact"], "value", 0.5),
}


@pytest.mark.parametrize("change", CHANGES, ids=lambda name: name.replace(" ", "-"))
def test_a_change_makes_the_result_out_of_date(change):
    hand, product = stage.scene()
    stage.solve()
    assert not out_of_date()
    CHANGES[change](hand, product)
    bpy.context.view_layer.update()
    assert out_of_date()


def test_looks_do_not_make_it_out_of_date():
    stage.scene()
    stage.solve()
    settings = bpy.context.scene.thenar
    settings.range_kpa, settings.palette = 40, "CIVIDIS"
    bpy.ops.thenar.show_pressure()
    assert not out_of_date()


def test_edit_mode_does_not_make_it_out_of_date():
    hand, _ = stage.scene()
    stage.solve()
    bpy.context.view_layer.objects.active = hand
    bpy.ops.object.mode_set(mode="EDIT")
    assert not out_of_date()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert not out_of_date()


def test_turning_everything_gives_the_same_numbers():
    hand, product = stage.scene()
    expected = stage.solve().force_n
    bpy.ops.thenar.clear()
    turner = bpy.data.objects.new("Turner", None)
    bpy.context.scene.collection.objects.link(turner)
    for obj in (hand, product):
        obj.parent = turner
    turner.rotation_euler, turner.location = (0.7, -0.4, 1.9), (0.3, 0.1, -0.2)
    bpy.context.view_layer.update()
    assert stage.solve().force_n == pytest.approx(expected, rel=1e-3)


def test_presets_set_published_numbers():
    import thenar

    hand, _ = stage.scene()
    material = hand.thenar.default_material
    material.preset = "PALM"
    palm = thenar.Material.palm()
    assert material.g0_kpa == pytest.approx(1000 * palm.g0_mpa)
    assert material.swelling_radius_mm == pytest.approx(palm.swelling[1])
    material.g0_kpa = 12
    assert material.preset == "CUSTOM"
    stiff = stage.solve().force_n
    material.preset = "FINGER_LAYER"
    assert material.g0_kpa == pytest.approx(1000 * thenar.Material.finger_layer().g0_mpa)
    assert stage.solve().force_n != stiff


def test_notes_of_a_solve_name_one_region_and_list_the_others():
    hand, _ = stage.scene(top=-3.5)
    points = stage.evaluated(hand)
    for name, inside in (("left_pad", points[:, 0] < 0.0), ("right_pad", points[:, 0] >= 0.0)):
        hand.vertex_groups.new(name=name).add([int(i) for i in np.flatnonzero(inside)], 1.0, "REPLACE")
    bpy.ops.thenar.assign_regions()
    deep = [note.name for note in stage.solve().warnings if "over half its" in note.name]
    assert len(deep) == 1, deep
    assert deep[0].startswith("region 'Left pad' is pressed")
    assert deep[0].endswith(" (also: Right pad)")
