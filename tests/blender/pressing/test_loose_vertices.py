"""Vertices without a face are no skin and no product; the refusal names the modifier that reorders vertices."""

import bpy
import numpy as np
import pytest
import stage
from thenar_blender.results.result import as_dict

MM = stage.MM


def loosen(obj, places_mm):
    """Add vertices without faces; local places, mm."""
    before = len(obj.data.vertices)
    obj.data.vertices.add(len(places_mm))
    for vertex, place in zip(obj.data.vertices[before:], places_mm, strict=True):
        vertex.co = np.array(place) * MM
    obj.data.update()
    bpy.context.view_layer.update()
    return before


# Deep inside the plate, far outside, within the skin, and on its lowest point.
LOOSE = [(3.0, 2.0, -17.0), (4e5, 3e5, 5e5), (0.0, 0.0, 0.0), (0.0, 0.0, -8.0)]


def shape(hand, count):
    return stage.evaluated(hand)[:count], stage.attribute(hand, "pressure_kpa")[:count]


def test_loose_vertices_change_nothing_but_a_note():
    hand, product = stage.scene()
    wanted = as_dict(stage.solve())
    count = len(hand.data.vertices)
    positions, pressure = shape(hand, count)
    bpy.ops.thenar.clear()
    loosen(hand, LOOSE)
    loosen(product, LOOSE)
    found = as_dict(stage.solve())
    assert any("vertices without a triangle" in note for note in found["warnings"])
    assert not any("inside out" in note or "measures" in note for note in found["warnings"])
    for key in ("force_n", "contact_area_mm2", "peak_pressure_kpa", "max_penetration_before_mm"):
        assert found[key] == pytest.approx(wanted[key], rel=1e-5), key
    assert np.allclose(shape(hand, count)[0], positions, atol=1e-4)
    assert np.allclose(shape(hand, count)[1], pressure, atol=1e-2)
    for name in ("pressure_kpa", "contact_depth_mm", "contact_force_n"):
        assert not stage.attribute(hand, name)[count:].any(), name
        assert stage.attribute(hand, name)[:count].max() > 0.0
    local = np.array([vertex.co for vertex in hand.data.shape_keys.key_blocks["Thenar Contact"].data[count:]]) / MM
    assert np.allclose(local, LOOSE, rtol=1e-6, atol=1e-4), "and are not moved"


MODIFIERS = {
    "SUBSURF": False,
    "MIRROR": False,
    "SOLIDIFY": False,
    "SMOOTH": False,
    "TRIANGULATE": False,
    "DECIMATE": True,
    "REMESH": True,
    "MASK": True,
}
"""Modifier -> whether the vertices of the mesh can no longer be identified after it."""


def added(kind, hand):
    made = hand.modifiers.new(f"my {kind}", kind)
    if kind == "DECIMATE":
        made.ratio = 0.5
    if kind == "REMESH":
        made.mode, made.voxel_size = "VOXEL", 1.5 * MM
    if kind == "MASK":
        made.vertex_group = hand.vertex_groups[0].name
    if kind == "MIRROR":
        made.use_axis, made.use_mirror_merge = (True, False, False), False
    return made


@pytest.mark.parametrize("guilty", [[], ["DECIMATE"], ["REMESH"], ["MASK"], ["DECIMATE", "MASK"]])
def test_a_refusal_names_the_modifiers_at_fault_and_no_others(guilty):
    hand, product = stage.scene()
    group = hand.vertex_groups.new(name="Half")
    group.add([vertex.index for vertex in hand.data.vertices if vertex.co.z < 0.0], 1.0, "REPLACE")
    for kind in (*guilty, *(kind for kind, is_harmful in MODIFIERS.items() if not is_harmful)):
        added(kind, hand)
    hidden = hand.modifiers.new("hidden", "DECIMATE")
    hidden.ratio, hidden.show_viewport = 0.1, False
    if not guilty:
        hand.modifiers.remove(hand.modifiers["my MIRROR"])
        assert stage.solve().force_n > 0.0
        return
    shown = [modifier.show_viewport for modifier in hand.modifiers]
    with pytest.raises(RuntimeError) as error:
        bpy.ops.thenar.solve()
    listed = ", ".join(f"'my {kind}'" for kind in MODIFIERS if kind in guilty)
    change = "change" if len(guilty) > 1 else "changes"
    assert f"{listed} on 'Pad' {change} which vertices".lower() in str(error.value).lower()
    assert [modifier.show_viewport for modifier in hand.modifiers] == shown
