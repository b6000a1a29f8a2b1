"""The reference solve and the fast result: what is written, compared, refused, exported and forgotten."""

import bmesh
import bpy
import numpy as np
import pytest
import stage
from thenar_blender.results import result as results


def certified(**options):
    hand, product = stage.scene(**options)
    stage.solve()
    assert bpy.ops.thenar.certify() == {"FINISHED"}
    return hand, product, bpy.context.scene.thenar.result


def test_the_reference_is_compared_with_the_fast_result():
    hand, _, result = certified()
    reference = result.reference
    assert reference.is_valid and reference.note.startswith("The bones of the rig are not known: 'Pad' has no armature")
    assert reference.note.count(". ") == 0, "one note alone"
    assert reference.force_n == pytest.approx(result.regions[0].reference_n, rel=0.02)
    # A ball of 8 mm with a bone of 1 mm at its center is softer than a bonded layer without end.
    assert 0.4 < reference.force_n / result.force_n < 1.0
    assert 0.4 < reference.area_mm2 / result.area_mm2 < 1.0
    pressure = stage.attribute(hand, "reference_kpa")
    fast = stage.attribute(hand, "pressure_kpa")
    assert pressure.max() > 0.3 * fast.max()
    assert stage.attribute(hand, "reference_difference_kpa") == pytest.approx(pressure - fast, abs=1e-4)
    height = np.array([vertex.co.z for vertex in hand.data.vertices])
    assert (pressure[np.argsort(height)[:5]] > 0.0).all(), "the lowest skin lies on the plate"
    assert pressure[height > 0.0].max() == 0.0


def test_shape_and_fast_result_stay_as_they_are():
    hand, _ = stage.scene()
    stage.solve()
    before = stage.evaluated(hand), bpy.context.scene.thenar.result.force_n, stage.attribute(hand, "pressure_kpa")
    assert bpy.ops.thenar.certify() == {"FINISHED"}
    assert np.array_equal(stage.evaluated(hand), before[0])
    assert bpy.context.scene.thenar.result.force_n == before[1]
    assert np.array_equal(stage.attribute(hand, "pressure_kpa"), before[2])


@pytest.mark.parametrize("kind", ["REFERENCE", "REFERENCE_DIFFERENCE"])
def test_both_maps_are_shown(kind):
    hand, _, _ = certified()
    assert bpy.ops.thenar.show_map(kind=kind) == {"FINISHED"}
    assert bpy.context.scene.thenar.maps.shown == kind and hand.thenar.shows_pressure


def test_it_is_exported_and_a_new_solve_forgets_it():
    hand, product, result = certified()
    exported = results.as_dict(result)["reference"]
    assert exported["force_n"] == result.reference.force_n
    assert sum(row["force_n"] for row in exported["regions"]) == pytest.approx(result.reference.force_n, rel=0.02)
    stage.raise_under(hand, product, depth=0.8)
    stage.solve()
    assert not result.reference.is_valid and results.as_dict(result)["reference"] is None
    assert "reference_kpa" not in hand.data.attributes


def test_a_scene_that_was_changed_is_refused():
    hand, product = stage.scene()
    stage.solve()
    product.location.z += 2e-4
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="press Solve, then Certify"):
        bpy.ops.thenar.certify()
    assert "reference_kpa" not in hand.data.attributes


def test_a_contact_that_was_applied_is_refused():
    stage.scene()
    stage.solve()
    assert bpy.ops.thenar.apply() == {"FINISHED"}
    with pytest.raises(RuntimeError, match="undo Apply, or solve again"):
        bpy.ops.thenar.certify()
    stage.solve()
    assert bpy.ops.thenar.certify() == {"FINISHED"}


def test_skin_without_a_region_carries_no_force():
    hand, _ = stage.scene()
    right = [vertex.index for vertex in hand.data.vertices if vertex.co.x > 0.0]
    hand.vertex_groups.new(name="right").add(right, 1.0, "REPLACE")
    assert bpy.ops.thenar.assign_regions() == {"FINISHED"}
    result = stage.solve()
    assert bpy.ops.thenar.certify() == {"FINISHED"}
    outside = stage.attribute(hand, "contact_region") < 0
    assert stage.attribute(hand, "reference_kpa")[outside].max() == 0.0
    assert result.reference.force_n == pytest.approx(result.regions[0].reference_n, rel=1e-6)
    assert "inside the product the skin has no region" in result.reference.note


def test_skin_that_is_inside_out_is_turned_where_closed_and_refused_where_open():
    hand, _, result = certified()
    expected = result.reference.force_n
    hand.data.flip_normals()
    stage.solve()
    assert bpy.ops.thenar.certify() == {"FINISHED"}
    assert result.reference.force_n == pytest.approx(expected, rel=1e-6)
    opened = bmesh.new()
    opened.from_mesh(hand.data)
    bmesh.ops.delete(opened, geom=[max(opened.verts, key=lambda vertex: vertex.co.z)], context="VERTS")
    bpy.ops.thenar.clear()
    opened.to_mesh(hand.data)
    opened.free()
    stage.solve()
    with pytest.raises(RuntimeError, match="turn the normals of the skin outward"):
        bpy.ops.thenar.certify()


def test_an_effect_that_the_reference_lacks_is_named_in_words():
    hand, _ = stage.scene()
    for name in ("friction", "bone"):
        assert bpy.ops.thenar.effect_add(kind=name) == {"FINISHED"}
    stage.solve()
    assert bpy.ops.thenar.certify() == {"FINISHED"}
    note = bpy.context.scene.thenar.result.reference.note
    assert "The reference has no effects: friction acts in the fast result alone" in note


def test_clear_and_bake_forget_the_reference(tmp_path):
    hand, _, result = certified()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "pad.blend"))
    assert bpy.ops.thenar.show_map(kind="REFERENCE") == {"FINISHED"}
    assert bpy.ops.thenar.bake(frame_start=1, frame_end=1) == {"FINISHED"}
    assert not result.reference.is_valid and "reference_kpa" not in hand.data.attributes
    with pytest.raises(RuntimeError, match="plays a bake; press Clear first, then Solve and Certify"):
        bpy.ops.thenar.certify()
    bpy.context.scene.thenar.maps.shown = "REFERENCE"
    assert bpy.ops.thenar.clear() == {"FINISHED"}
    assert bpy.context.scene.thenar.maps.shown == "PRESSURE"


def test_without_a_result_the_button_says_what_to_do():
    stage.scene()
    assert not bpy.ops.thenar.certify.poll()


def test_tissue_without_bone_is_refused():
    hand, _ = stage.scene()
    hand.thenar.default_material.thickness_mm = 1000.0
    stage.solve()
    with pytest.raises(RuntimeError, match="without bone"):
        bpy.ops.thenar.certify()


def test_tissue_thicker_than_the_body_is_refused_by_region():
    hand, _ = stage.scene()
    hand.thenar.default_material.thickness_mm = 12.0
    stage.solve()
    with pytest.raises(
        RuntimeError, match=r"skin vertex \d+ \(Whole skin\), where tissue is 1\d\.\d mm thick; give thinner"
    ):
        bpy.ops.thenar.certify()


@pytest.mark.parametrize(("fineness", "says"), [(2, True), (3, False)])
def test_skin_that_is_too_coarse_is_said(fineness, says):
    hand, product = stage.pad(fineness=fineness), stage.plate()
    settings = bpy.context.scene.thenar
    settings.hand, settings.product = hand, product
    stage.solve()
    assert bpy.ops.thenar.certify() == {"FINISHED"}
    assert ("mm apart, too far for the reference" in settings.result.reference.note) == says


def test_seams_do_not_cut_the_tissue():
    """Vertices that stand twice, as an importer leaves them at seams, are one."""
    _, _, whole = certified()
    expected = whole.reference.force_n
    bpy.ops.wm.read_homefile(use_empty=True)
    hand, _ = stage.scene()
    bpy.context.view_layer.objects.active = hand
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.edge_split()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert len(hand.data.vertices) == 3 * len(hand.data.polygons), "every face has its own vertices"
    stage.solve()
    assert bpy.ops.thenar.certify() == {"FINISHED"}
    reference = bpy.context.scene.thenar.result.reference
    assert reference.force_n == pytest.approx(expected, rel=0.01)
