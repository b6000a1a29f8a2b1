"""Effects switched on in the panel: they act, they are kept in the file, and off is the base model."""

import bpy
import numpy as np
import pytest
import stage
from thenar_blender import handlers, workflow
from thenar_blender.properties import effect_settings


def add(kind, **numbers):
    """Switch an effect on by its button, and set its numbers."""
    assert bpy.ops.thenar.effect_add(kind=kind) == {"FINISHED"}
    effect = bpy.context.scene.thenar.hand.thenar.effects[-1]
    for name, value in numbers.items():
        effect.numbers[name].value = value
    return effect


def pressures(hand):
    """Solve and read the pressures."""
    stage.solve()
    return stage.attribute(hand, "pressure_kpa").copy()


@pytest.mark.parametrize("switch", ["is_on", "amplitude"])
def test_an_effect_that_is_off_changes_nothing(switch):
    hand, _ = stage.scene()
    base = pressures(hand)
    effect = add("bone", thickness_mm=2.0)
    thin = pressures(hand)
    setattr(effect, switch, 0)
    assert (pressures(hand) == base).all()
    assert thin.max() > 1.1 * base.max(), "2 mm over bone press harder than 7 mm"


def test_every_effect_on_the_menu_can_be_solved_with():
    stage.scene()
    kinds = bpy.ops.thenar.effect_add.get_rna_type().properties["kind"].enum_items
    offered = list(effect_settings.offered())
    assert {"bone", "stiffening_law", "inclusion", "compressibility", "region_coupling"} <= set(offered), kinds
    for kind in offered:
        add(kind)
        assert stage.solve().force_n > 0.0
    assert bpy.context.scene.thenar.result.effects.startswith("bone 1, ")
    assert {"friction", "adhesion"} <= set(offered)


def test_an_effect_on_one_region_leaves_the_others():
    hand, _ = stage.scene()
    points = stage.evaluated(hand)
    for name, inside in (("left", points[:, 0] < 0.0), ("right", points[:, 0] >= 0.0)):
        hand.vertex_groups.new(name=name).add([int(i) for i in np.flatnonzero(inside)], 1.0, "REPLACE")
    bpy.ops.thenar.assign_regions()
    before = [row.shear_modulus_kpa for row in stage.solve().regions]
    add("stiffening_law").region = "right"
    after = {row.name: row.shear_modulus_kpa for row in stage.solve().regions}
    assert after["left"] == before[0]
    assert after["right"] != before[1]
    hand.thenar.effects[0].region = "gone"
    with pytest.raises(RuntimeError, match="region 'gone'.*under Effects"):
        bpy.ops.thenar.solve()


def test_thickness_is_painted_by_a_vertex_group():
    hand, _ = stage.scene()
    every = [vertex.index for vertex in hand.data.vertices]
    hand.vertex_groups.new(name="thickness").add(every, 0.25, "REPLACE")
    effect = add("bone", thickness_mm=6.0)
    effect.painted, effect.painted_full = "thickness", 12.0
    painted = stage.solve().force_n
    effect.painted, effect.numbers["thickness_mm"].value = "", 3.0
    assert stage.solve().force_n == pytest.approx(painted, rel=0.02), "a quarter of 12 mm is 3 mm"
    effect.painted = "gone"
    with pytest.raises(RuntimeError, match="vertex group 'gone'"):
        bpy.ops.thenar.solve()


def test_a_number_that_cannot_be_is_told():
    stage.scene()
    add("bone", thickness_mm=-1.0)
    with pytest.raises(RuntimeError, match="thickness_mm"):
        bpy.ops.thenar.solve()


def test_effects_are_kept_in_the_file_and_make_the_result_out_of_date(tmp_path):
    stage.scene()
    stage.solve()
    assert not workflow.is_out_of_date(bpy.context)
    add("stiffening_law", exponent=3.0).choices["law"].value = "power"
    assert workflow.is_out_of_date(bpy.context)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "kept.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "kept.blend"))
    effect = bpy.context.scene.thenar.hand.thenar.effects[0]
    assert (effect.name, effect.choices["law"].value) == ("stiffening_law", "power")
    assert effect.numbers["exponent"].value == pytest.approx(3.0)
    assert bpy.ops.thenar.effect_remove() == {"FINISHED"}
    assert len(bpy.context.scene.thenar.hand.thenar.effects) == 0


def test_a_product_that_is_dragged_shears_the_skin(tmp_path):
    hand, _ = stage.scene()
    assert stage.solve().shear_n == 0.0
    assert "shear_kpa" not in hand.data.attributes
    normal = add("friction", coefficient=0.4) and stage.solve().force_n
    bpy.context.scene.thenar.slide_mm = (5.0, 0.0, 0.0)
    result = stage.solve()
    assert result.shear_n == pytest.approx(0.4 * result.force_n, rel=0.02), "5 mm is a full slip"
    assert result.force_n == pytest.approx(normal, rel=1e-3)
    margin, shear = stage.attribute(hand, "slip_margin"), stage.attribute(hand, "shear_kpa")
    pressure = stage.attribute(hand, "pressure_kpa")
    assert margin[pressure > 0].max() < 1e-3
    assert margin[pressure == 0].min() == 1.0
    assert shear == pytest.approx(0.4 * pressure, rel=1e-3, abs=1e-3)
    assert bpy.ops.thenar.export(filepath=str(tmp_path / "dragged.csv")) == {"FINISHED"}
    header = next(tmp_path.glob("dragged*.csv")).read_text().splitlines()[0]
    assert header.endswith("in_contact,shear_kpa,slip_margin"), header
    hand.thenar.effects.clear()
    assert stage.solve().shear_n == 0.0
    assert "shear_kpa" not in hand.data.attributes


def test_what_acts_over_time_is_said_after_a_press():
    hand, _ = stage.scene()
    base = pressures(hand)
    add("relaxation")
    add("drainage").is_on = False
    assert (pressures(hand) == base).all()
    told = [text.name for text in bpy.context.scene.thenar.result.warnings]
    assert "relaxation acts over time: bake to see it" in told
    hand.thenar.effects[1].is_on = True
    stage.solve()
    told = [text.name for text in bpy.context.scene.thenar.result.warnings]
    assert "relaxation and drainage act over time: bake to see it" in told


def test_bonds_of_touch_need_a_bake_and_old_effects_get_the_choice():
    hand, _ = stage.scene()
    adhesion = add("adhesion")
    assert not effect_settings.needs_history(hand)
    adhesion.choices["bonds"].value = "touched"
    assert effect_settings.needs_history(hand)
    stage.solve()
    said = [text.name for text in bpy.context.scene.thenar.result.warnings]
    assert "adhesion acts over time: bake to see it" in said
    adhesion.choices.clear()  # as saved before there was a choice
    handlers._objects_came()
    assert effect_settings.chosen(adhesion) == [("bonds", "reversible")]


def test_numbers_of_a_layer_stand_where_it_is_chosen_and_old_drainage_gets_them():
    hand, _ = stage.scene()
    drainage = add("drainage")
    plain = ["diffusivity_mm2_per_s", "drained_poisson_ratio"]
    assert [number.name for number in effect_settings.shown_numbers(drainage)] == plain
    drainage.choices["curve"].value = "layer"
    assert [number.name for number in effect_settings.shown_numbers(drainage)] == [*plain, "spread", "radius_mm"]
    drainage.choices.clear()
    for _name in ("spread", "radius_mm"):  # as saved before there was a layer
        drainage.numbers.remove(len(drainage.numbers) - 1)
    handlers._objects_came()
    assert effect_settings.chosen(drainage) == [("curve", "halfspace")]
    assert drainage.numbers["spread"].value == pytest.approx(1.2)
    inclusion = add("inclusion")
    assert "radius_mm" in [number.name for number in effect_settings.shown_numbers(inclusion)]


def test_two_jobs_of_one_hand_keep_their_own_effects():
    """A job may be computed in its thread while another one is prepared."""
    hand, product = stage.scene()
    bare = workflow.read_job(bpy.context, hand, [product])
    add("bone", thickness_mm=2.0)
    thin = workflow.read_job(bpy.context, hand, [product])
    skins = workflow.prepared(thin), workflow.prepared(bare)
    assert [effect.name for effect in skins[0].effects] == ["bone"] and not skins[1].effects
    assert workflow.prepared(thin) is skins[0], "prepared once"
    forces = [float(np.asarray(workflow.compute(job).force_n).sum()) for job in (thin, bare)]
    assert forces[0] > 1.1 * forces[1]
