"""Thickness painted by a vertex group: made from what is there, in mm by weight, and told when it changes."""

import bpy
import numpy as np
import pytest
import stage
from thenar_blender import workflow


def bone(amplitude=1.0, thickness=4.0):
    hand, _ = stage.scene()
    hand.thenar.default_material.thickness_mm = 7.0
    assert bpy.ops.thenar.effect_add(kind="bone") == {"FINISHED"}
    effect = hand.thenar.effects[0]
    effect.amplitude, effect.numbers["thickness_mm"].value = amplitude, thickness
    return hand, effect


@pytest.mark.parametrize("amplitude", [1.0, 0.5])
def test_the_button_paints_what_is_there_already(amplitude):
    hand, effect = bone(amplitude)
    before = stage.solve().force_n
    assert bpy.ops.thenar.paint_thickness() == {"FINISHED"}
    assert hand.mode == "WEIGHT_PAINT" and hand.vertex_groups.active.name == effect.painted == "Thickness"
    now = 1.0 / (amplitude / 4.0 + (1.0 - amplitude) / 7.0)
    weights = np.array([hand.vertex_groups["Thickness"].weight(k) for k in range(len(hand.data.vertices))])
    assert weights * effect.painted_full == pytest.approx(now, rel=1e-6)
    assert 1.25 * now <= effect.painted_full <= 3 * now, "there is room to paint thicker skin"
    assert stage.solve().force_n == pytest.approx(before, rel=1e-5), "nothing changes until a brush does"


def test_a_stroke_makes_the_result_out_of_date_and_thins_the_skin():
    hand, effect = bone()
    bpy.ops.thenar.paint_thickness()
    before = stage.solve().force_n
    assert not workflow.is_out_of_date(bpy.context)
    group = hand.vertex_groups[effect.painted]
    group.add([int(stage.evaluated(hand)[:, 2].argmin())], group.weight(0) * 0.9, "REPLACE")
    assert workflow.is_out_of_date(bpy.context), "one vertex was painted"
    stage.solve()
    assert not workflow.is_out_of_date(bpy.context)
    group.add(list(range(len(hand.data.vertices))), group.weight(0) / 2, "REPLACE")
    assert workflow.is_out_of_date(bpy.context)
    assert stage.solve().force_n > 1.2 * before
    effect.painted_full *= 2
    assert workflow.is_out_of_date(bpy.context), "the weights stand for other thicknesses now"
    assert bpy.ops.thenar.show_map(kind="THICKNESS") == {"FINISHED"}
    assert hand.mode == "OBJECT", "painting hides materials"


def test_a_group_that_is_there_is_painted_on():
    hand, effect = bone()
    hand.vertex_groups.new(name="mine").add([0, 1], 0.5, "REPLACE")
    hand.vertex_groups.new(name="other")
    effect.painted, effect.painted_full = "mine", 12.0
    assert bpy.ops.thenar.paint_thickness() == {"FINISHED"}
    assert (effect.painted, effect.painted_full, len(hand.vertex_groups)) == ("mine", 12.0, 2)
    assert hand.vertex_groups.active.name == "mine"


def test_what_cannot_be_painted_is_told():
    hand, _ = bone()
    hand.thenar.effects.clear()
    bpy.ops.thenar.effect_add(kind="compressibility")
    with pytest.raises(RuntimeError, match="has no field to paint; select bone"):
        bpy.ops.thenar.paint_thickness()
    hand.thenar.effects.clear()
    bpy.ops.thenar.effect_add(kind="bone")
    hand.thenar.effects[0].amplitude = hand.thenar.default_material.thickness_mm = 0.0
    with pytest.raises(RuntimeError, match="No skin of 'Pad' lies over bone"):
        bpy.ops.thenar.paint_thickness()
    assert not hand.vertex_groups and hand.mode == "OBJECT"


def test_painting_is_kept_in_the_file(tmp_path):
    bone()
    bpy.ops.thenar.paint_thickness()
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "painted.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "painted.blend"))
    hand = bpy.context.scene.thenar.hand
    assert hand.thenar.effects[0].painted == "Thickness" and hand.thenar.effects[0].painted_full == 5.0
    stage.solve()
    assert not workflow.is_out_of_date(bpy.context)
