"""Soft grips from the panel's settings to what is shown: skin on the pressed grip, refusals, batch."""

import csv
import json

import bpy
import numpy as np
import pytest
import stage
import thenar
from thenar_blender import batch, status, workflow
from thenar_blender.batch import jobs
from thenar_blender.scene.checks import Refusal
from thenar_blender.soft_grip import settings as grip_settings


def covered(material="CUSTOM", youngs_mpa=0.1, thickness_mm=3.0, **options):
    hand, product = stage.scene(**options)
    grip = product.thenar.grip
    grip.material, grip.youngs_mpa, grip.thickness_mm = material, youngs_mpa, thickness_mm
    return hand, product


def copy_of(product):
    return next(obj for obj in bpy.data.objects if obj.thenar.copy_of == product.name)


def test_a_soft_grip_lowers_force_and_peak_and_its_yield_is_shown():
    hand, product = stage.scene()
    rigid = stage.solve()
    force, peak, digest = rigid.force_n, rigid.peak_kpa, rigid.input_hash
    product.thenar.grip.material = "CUSTOM"
    product.thenar.grip.youngs_mpa = 0.1
    soft = stage.solve()
    assert soft.force_n < 0.9 * force and soft.peak_kpa < 0.9 * peak and soft.input_hash != digest
    assert 0.1 < soft.grip_mm < 1.2 and soft.grip_share == pytest.approx(soft.grip_mm / 3.0, rel=1e-5)


def test_the_shown_skin_lies_on_the_pressed_grip():
    """Skin goes below the plate as it was, by what the grip yields, and not below the copy that shows it pressed."""
    hand, product = covered()
    result = stage.solve()
    skin, top = stage.evaluated(hand), stage.evaluated(product)[:, 2].max()
    pressed = stage.evaluated(copy_of(product))
    depth = top - pressed[(np.abs(pressed[:, :2]).max(axis=1) < 3.0) & (pressed[:, 2] > top - 5.0)][:, 2].min()
    assert depth == pytest.approx(result.grip_mm, rel=0.02)
    touching = stage.attribute(hand, "pressure_kpa") > 0.0
    assert (top - skin[touching, 2]).min() > 0.02, "every touching vertex lies below the plate as it was"
    assert result.shown_penetration_mm < 0.02
    moved = stage.attribute(copy_of(product), "grip_displacement_mm")
    assert moved[:, 2].min() == pytest.approx(-result.grip_mm, rel=0.02)


def test_a_grip_on_a_group_yields_there_only():
    hand, product = covered()
    everywhere = stage.solve().force_n
    place = stage.evaluated(product)
    group = product.vertex_groups.new(name="Pad")
    group.add(np.flatnonzero(place[:, 0] > 5.0).tolist(), 1.0, "REPLACE")
    product.thenar.grip.group = "Pad"
    apart = stage.solve()
    assert apart.force_n > 1.1 * everywhere and apart.grip_mm < 0.1
    product.thenar.grip.material = "RIGID"
    assert apart.force_n <= stage.solve().force_n * (1.0 + 1e-3)


def test_presets_and_hardness_give_the_library_s_numbers():
    _hand, product = covered("SHORE_A", thickness_mm=2.0)
    product.thenar.grip.hardness = 50.0
    made = thenar.Elastomer.of_shore_a(50.0, 2.0)
    assert grip_settings.numbers(product) == (2.0, made.youngs_mpa, 0.49)
    for row in thenar.Elastomer.presets():
        product.thenar.grip.material = row["name"].upper()
        assert grip_settings.numbers(product) == (2.0, row["youngs_mpa"], row["poisson_ratio"])


@pytest.mark.parametrize("change", ["paper", "group", "unpainted", "modifier"])
def test_what_a_grip_cannot_do_is_refused_with_a_remedy(change):
    hand, product = covered()
    wanted = {"paper": "choose the model", "group": "no vertex group 'Gone'", "unpainted": "paint the group"}
    if change == "paper":
        bpy.context.scene.thenar.model = "PAPER"
    elif change == "group":
        product.thenar.grip.group = "Gone"
    else:
        product.vertex_groups.new(name="Pad")
        product.thenar.grip.group = "Pad"
        if change == "modifier":
            product.modifiers.new("S", "SUBSURF")
    with pytest.raises(RuntimeError, match=wanted.get(change, "mend that, or clear Group")):
        bpy.ops.thenar.solve()
    assert not bpy.context.scene.thenar.result.is_valid and hand.data.shape_keys is None


def test_live_bake_and_certify_refuse_a_soft_product():
    covered()
    stage.solve()
    with pytest.raises(RuntimeError, match="has a soft grip, but Certify solves rigid products only"):
        bpy.ops.thenar.certify()
    with pytest.raises(RuntimeError, match="has a soft grip, but a bake presses rigid products only"):
        bpy.ops.thenar.bake(frame_start=1, frame_end=2)
    bpy.ops.thenar.clear()
    scene = bpy.context.scene
    scene.thenar.live = True
    try:
        assert "has a soft grip, but Live presses" in status.live[scene.name].problem
    finally:
        scene.thenar.live = False


def test_clear_takes_the_pressed_grip_away_and_apply_keeps_the_skin():
    hand, product = covered()
    stage.solve()
    bpy.ops.thenar.clear()
    assert not any(obj.thenar.copy_of for obj in bpy.data.objects) and hand.data.shape_keys is None


def test_a_result_is_out_of_date_once_the_grip_changes():
    _hand, product = covered()
    stage.solve()
    assert not workflow.is_out_of_date(bpy.context)
    product.thenar.grip.thickness_mm = 4.0
    assert workflow.is_out_of_date(bpy.context)


def test_a_grip_is_kept_in_the_file(tmp_path):
    _hand, product = covered()
    product.thenar.grip.group = ""
    force = stage.solve().force_n
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "soft.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "soft.blend"))
    assert bpy.context.scene.thenar.product.thenar.grip.youngs_mpa == pytest.approx(0.1)
    assert stage.solve().force_n == pytest.approx(force, rel=1e-6)


def test_batch_sweeps_a_grip_s_thickness(tmp_path):
    covered("RIGID")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "grip.blend"))
    (tmp_path / "jobs.toml").write_text(
        'blend = "grip.blend"\nsave = false\ngrip_youngs_mpa = 0.1\n[[sweep]]\ngrip_thickness_mm = [0.5, 2.0, 6.0]\n'
    )
    batch.run(tmp_path / "jobs.toml", tmp_path / "out", batch.By(1, None, None))
    with (tmp_path / "out" / "results.csv").open() as file:
        rows = sorted(csv.DictReader(file), key=lambda row: float(row["set_grip_thickness_mm"]))
    forces = [float(row["force_n"]) for row in rows]
    assert len(forces) == 3 and forces[0] > 1.05 * forces[1] > 1.05 * forces[2]
    assert all(float(row["grip_mm"]) > 0.0 for row in rows)


@pytest.mark.parametrize(
    ("case", "wanted"),
    [
        ({"grip": "wood"}, "must be"),
        ({"grip": "tpe", "grip_shore_a": 50}, "keep one"),
        ({"grip_shore_a": 90}, "20 to 80"),
        ({"grip_youngs_mpa": 1e-5}, "0.001 to 100000"),
        ({"grip_thickness_mm": 0.01}, "0.1 to 1000"),
        ({"grip_thickness_mm": 0}, "a number above zero"),
    ],
)
def test_a_case_with_an_impossible_grip_is_refused(case, wanted):
    with pytest.raises(Refusal, match=wanted):
        jobs.check({"blend": "a.blend", **case}, "one")
    assert json.dumps(case)


def test_the_product_is_back_after_solving_again_with_the_map_on():
    _hand, product = covered()
    stage.solve()
    bpy.ops.thenar.show_pressure(show=True)
    assert product.hide_get() and not copy_of(product).hide_viewport
    stage.solve()
    assert product.hide_get() and not copy_of(product).hide_viewport and copy_of(product).thenar.shows_pressure
    bpy.ops.thenar.show_pressure(show=False)
    assert not product.hide_get() and not product.hide_render and copy_of(product).hide_viewport
    bpy.ops.thenar.show_pressure(show=True)
    bpy.ops.thenar.clear()
    assert not product.hide_get() and not product.hide_render


def test_repainting_the_grip_s_group_makes_the_result_out_of_date():
    _hand, product = covered()
    group = product.vertex_groups.new(name="Pad")
    group.add(range(len(product.data.vertices)), 1.0, "REPLACE")
    product.thenar.grip.group = "Pad"
    stage.solve()
    assert not workflow.is_out_of_date(bpy.context)
    group.add(range(50), 0.1, "REPLACE")
    assert workflow.is_out_of_date(bpy.context)


def test_the_overlap_is_that_of_the_product_as_it_was():
    _hand, product = stage.scene()
    rigid = stage.solve().depth_mm
    product.thenar.grip.material, product.thenar.grip.youngs_mpa = "CUSTOM", 0.1
    assert stage.solve().depth_mm == pytest.approx(rigid, rel=1e-4)


def test_two_halves_with_one_grip_are_one_block():
    """The seam does not tear open: what lies within the solid is no surface, and shares its normal with none."""
    hand, product = covered()
    whole = stage.solve()
    force, yielded = whole.force_n, whole.grip_mm
    bpy.ops.thenar.clear()
    home = bpy.data.collections.new("Halves")
    bpy.context.scene.collection.children.link(home)
    for side in (-1.0, 1.0):
        bpy.ops.mesh.primitive_cube_add(size=30 * stage.MM, location=(side * 15 * stage.MM, 0, -21.8 * stage.MM))
        half = bpy.context.object
        half.thenar.grip.material, half.thenar.grip.youngs_mpa = "CUSTOM", 0.1
        bpy.context.scene.collection.objects.unlink(half)
        home.objects.link(half)
    settings = bpy.context.scene.thenar
    settings.product, settings.product_collection = None, home
    product.hide_set(True)
    halves = stage.solve()
    assert halves.force_n == pytest.approx(force, rel=0.03) and halves.grip_mm == pytest.approx(yielded, rel=0.06)


def test_a_sheet_yields_whichever_way_it_is_wound():
    forces = []
    for is_flipped in (False, True):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        hand = stage.pad()
        bpy.ops.mesh.primitive_grid_add(
            x_subdivisions=30, y_subdivisions=30, size=30 * stage.MM, location=(0, 0, -6.8 * stage.MM)
        )
        sheet = bpy.context.object
        if is_flipped:
            sheet.data.flip_normals()
        settings = bpy.context.scene.thenar
        settings.hand, settings.product = hand, sheet
        sheet.thenar.grip.material, sheet.thenar.grip.youngs_mpa = "CUSTOM", 0.1
        result = stage.solve()
        assert result.grip_mm > 0.1
        forces.append(result.force_n)
    assert forces[0] == pytest.approx(forces[1], rel=1e-3)


def test_a_grip_thicker_than_half_the_product_says_so():
    _hand, product = covered(thickness_mm=20.0)
    result = stage.solve()
    assert any("no rigid core is left" in text.name for text in result.warnings)
    product.thenar.grip.thickness_mm = 10.0
    assert not any("no rigid core is left" in text.name for text in stage.solve().warnings)
