"""Maps beside pressure: shear, slip margin, depth, thickness; their colours, ranges, legend and what they refuse."""

import bpy
import numpy as np
import pytest
import stage
from thenar_blender import colormap

GROUP = "Thenar Pressure Overlay"


def dragged(coefficient=0.4, slide=(0.3, 0.0, 0.0)):
    """Ball on plate, dragged a little: it slips at the rim and sticks in the middle."""
    hand, product = stage.scene()
    assert bpy.ops.thenar.effect_add(kind="friction") == {"FINISHED"}
    hand.thenar.effects[0].numbers["coefficient"].value = coefficient
    bpy.context.scene.thenar.slide_mm = slide
    stage.solve()
    return hand, product


def nodes():
    return bpy.data.node_groups[GROUP].nodes


def show(kind):
    assert bpy.ops.thenar.show_map(kind=kind) == {"FINISHED"}
    return bpy.context.scene.thenar


@pytest.mark.parametrize(
    ("kind", "attribute", "cover"),
    [
        ("PRESSURE", "pressure_kpa", "contact_edge_mm"),
        ("SHEAR", "shear_kpa", "contact_edge_mm"),
        ("SLIP", "slip_margin", "contact_edge_mm"),
        ("DEPTH", "contact_depth_mm", "contact_overlap_mm"),
        ("THICKNESS", "tissue_thickness_mm", "tissue_thickness_mm"),
    ],
)
def test_a_map_colors_what_carries_it(kind, attribute, cover):
    hand, product = dragged()
    settings = show(kind)
    assert settings.maps.shown == kind and hand.thenar.shows_pressure
    assert product.thenar.shows_pressure == (kind == "PRESSURE"), "only pressure is known on the product"
    assert (nodes()["Value"].attribute_name, nodes()["Cover"].attribute_name) == (attribute, cover)
    active = hand.data.color_attributes[hand.data.color_attributes.active_color_index].name
    assert active == ("Thenar Pressure" if kind == "PRESSURE" else "Thenar Map")
    bpy.ops.thenar.show_pressure(show=False)
    assert not hand.thenar.shows_pressure


def test_shear_has_its_own_range_and_colors():
    hand, _ = dragged()
    settings = show("SHEAR")
    shear = stage.attribute(hand, "shear_kpa")
    most = int(np.where(stage.attribute(hand, "contact_edge_mm") > 1.5, shear, 0.0).argmax())
    settings.maps.shear_kpa = high = float(shear[most]) * 1.25
    colors = stage.attribute(hand, "Thenar Map")
    wanted = colormap.to_linear(colormap.srgb("PLASMA", np.array([0.8])))[0]
    assert colors[most, :3] == pytest.approx(wanted, abs=2e-3)
    assert nodes()["Range"].inputs["From Max"].default_value == pytest.approx(high)
    pressure = stage.attribute(hand, "Thenar Pressure").copy()
    settings.maps.shear_kpa = 2 * high
    assert not np.allclose(stage.attribute(hand, "Thenar Map"), colors)
    assert np.array_equal(stage.attribute(hand, "Thenar Pressure"), pressure), "the pressure's colours stay"
    assert bpy.ops.thenar.reset_range() == {"FINISHED"}
    assert shear.max() <= settings.maps.shear_kpa <= 2 * shear.max()


def test_slip_is_red_where_skin_slips_and_bare_off_the_contact():
    from thenar_blender.skin_display import colors as scene_colors

    hand, _ = dragged()
    show("SLIP")
    pressure, margin = stage.attribute(hand, "pressure_kpa"), stage.attribute(hand, "slip_margin")
    pressed = pressure > 0.2 * pressure.max()
    assert margin[pressed].min() < 1e-3 and margin[pressed].max() > 0.05, "part of it slips, part of it sticks"
    colors = stage.attribute(hand, "Thenar Map")[:, :3]
    edge = stage.attribute(hand, "contact_edge_mm")
    slipping = pressed & (margin < 1e-3)
    bare = colormap.to_linear(np.array(scene_colors.SKIN))
    red = colormap.to_linear(np.array([0xB4, 4, 0x26]) / 255) - bare
    covered = (colors[slipping] - bare) @ red / (red @ red)  # within 1.2 spacings of the edge colors of vertices fade
    assert covered.min() > 0.5 and covered.max() < 1.0 + 1e-4
    assert colors[slipping] == pytest.approx(bare + covered[:, None] * red, abs=1e-4)
    off = edge < -1.5  # 1.3 spacings
    assert not (off & (pressure > 0)).any() and off.sum() > 500
    assert colors[off] == pytest.approx(np.tile(bare, (off.sum(), 1)), abs=1e-5)
    with pytest.raises(RuntimeError, match="range of slip margin is fixed"):
        bpy.ops.thenar.reset_range()


def test_the_result_says_how_much_slips():
    hand, _ = dragged()
    result = bpy.context.scene.thenar.result
    assert result.shear_peak_kpa == pytest.approx(stage.attribute(hand, "shear_kpa").max(), rel=1e-5)
    assert 0.05 < result.slipping < 0.95
    bpy.context.scene.thenar.slide_mm = (5.0, 0.0, 0.0)
    assert stage.solve().slipping == pytest.approx(1.0), "5 mm is a full slip"


def test_thickness_is_shown_without_a_solve():
    hand, _ = stage.scene()
    hand.thenar.default_material.thickness_mm = 6.5
    show("THICKNESS")
    assert stage.attribute(hand, "tissue_thickness_mm") == pytest.approx(np.full(len(hand.data.vertices), 6.5))
    assert bpy.ops.thenar.effect_add(kind="bone") == {"FINISHED"}
    effect = hand.thenar.effects[0]
    effect.amplitude, effect.numbers["thickness_mm"].value = 0.5, 13.0
    show("THICKNESS")
    half = 1.0 / (0.5 / 6.5 + 0.5 / 13.0)
    assert stage.attribute(hand, "tissue_thickness_mm") == pytest.approx(half, rel=1e-6)


def test_a_map_that_is_not_there_is_told_and_changes_nothing():
    hand, _ = stage.scene()
    with pytest.raises(RuntimeError, match="no pressure yet; press Solve"):
        bpy.ops.thenar.show_map(kind="DEPTH")
    stage.solve()
    with pytest.raises(RuntimeError, match="Nothing shears the skin; add the effect friction"):
        bpy.ops.thenar.show_map(kind="SHEAR")
    assert not hand.thenar.shows_pressure and bpy.context.scene.thenar.maps.shown == "PRESSURE"


def test_shear_gives_way_to_pressure_when_friction_is_taken_away():
    hand, product = dragged()
    settings = show("SHEAR")
    hand.thenar.effects.clear()
    stage.solve()
    assert settings.maps.shown == "PRESSURE" and product.thenar.shows_pressure
    assert "Thenar Map" not in hand.data.attributes


def test_map_and_ranges_are_kept_in_the_file(tmp_path):
    dragged()
    show("SLIP").maps.shear_kpa = 12
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "kept.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "kept.blend"))
    settings = bpy.context.scene.thenar
    assert (settings.maps.shown, settings.maps.shear_kpa) == ("SLIP", 12)
    assert settings.hand.thenar.shows_pressure and nodes()["Value"].attribute_name == "slip_margin"


def test_an_overlay_of_an_earlier_version_is_made_anew():
    dragged()
    show("PRESSURE")
    nodes().clear()
    show("SHEAR")
    assert nodes()["Value"].attribute_name == "shear_kpa" and nodes()["Cover"].attribute_name == "contact_edge_mm"
    assert nodes()["Edge"].inputs["Value"].is_linked and nodes()["Ramp"].inputs["Fac"].is_linked
