"""What a press in Blender must give: forces that agree, a surface that does not penetrate, the same twice."""

import bpy
import numpy as np
import pytest
import stage
from mathutils import Euler, Matrix
from thenar_blender.results import result as results


def triangle_areas(obj):
    """Triangles and their areas, mm², of the evaluated mesh."""
    points = stage.evaluated(obj)
    obj.data.calc_loop_triangles()
    corners = np.array([triangle.vertices[:] for triangle in obj.data.loop_triangles])
    a, b, c = points[corners[:, 0]], points[corners[:, 1]], points[corners[:, 2]]
    return corners, 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


def test_totals_are_those_of_the_vertices():
    hand, _ = stage.scene()
    result = stage.solve()
    force, pressure = stage.attribute(hand, "contact_force_n"), stage.attribute(hand, "pressure_kpa")
    assert result.force_n > 0.1
    assert result.force_n == pytest.approx(force.sum(), rel=1e-4)
    assert result.peak_kpa == pytest.approx(pressure.max(), rel=1e-5)
    assert result.mean_kpa == pytest.approx(1000 * result.force_n / result.area_mm2, rel=1e-4)
    assert ((force > 0) == (pressure > 0)).all() and (force >= 0).all()
    assert np.array(result.force_vector_n)[2] == pytest.approx(-result.force_n, rel=1e-2), "the plate is pushed down"


def test_moment_is_about_the_worlds_origin():
    """Of hand and product moved together by a turn R and a shift t: force R F, moment R M + t x R F."""
    hand, product = stage.scene()
    hand.location.x, product.location.x = 0.003, 0.003
    bpy.context.view_layer.update()
    result = stage.solve()
    force, moment = np.array(result.force_vector_n), np.array(result.moment_nmm)
    center = np.array(result.center_mm)
    turn, shift_mm = Euler((0.7, -0.4, 1.1)).to_matrix(), np.array([40.0, -25.0, 60.0])
    for obj in (hand, product):
        obj.matrix_world = Matrix.Translation(shift_mm * stage.MM) @ turn.to_4x4() @ obj.matrix_world
    bpy.context.view_layer.update()
    moved, turned = stage.solve(), np.array(turn) @ force
    assert np.array(moved.force_vector_n) == pytest.approx(turned, rel=1e-3, abs=1e-3 * moved.force_n)
    wanted = np.array(turn) @ moment + np.cross(shift_mm, turned)
    assert np.array(moved.moment_nmm) == pytest.approx(wanted, abs=1e-3 * np.linalg.norm(wanted))
    assert np.array(moved.center_mm) == pytest.approx(np.array(turn) @ center + shift_mm, abs=0.01)


def test_a_pad_on_a_plate_holds_nothing_from_one_side():
    stage.scene()
    result = stage.solve()
    assert result.is_held_known and not result.is_force_closed and result.held_n == 0.0
    kept = results.as_dict(result)["holding"]
    assert kept["friction"] == pytest.approx(0.38) and kept["smallest_wrench_share"] == 0.0
    assert 0.5 < kept["torque_arm_mm"] < 8.0, "within the pad's radius of the middle of the forces"


def test_written_surface_does_not_penetrate():
    hand, _ = stage.scene()
    before = stage.evaluated(hand)[:, 2].min()
    result = stage.solve()
    assert before == pytest.approx(-8.0, abs=1e-3)
    assert stage.evaluated(hand)[:, 2].min() >= -6.8 - 0.02
    assert result.depth_mm == pytest.approx(1.2, abs=0.01)
    assert stage.attribute(hand, "contact_depth_mm").max() == pytest.approx(1.2, abs=0.01)


def test_product_carries_the_same_force():
    _, product = stage.scene(cuts=60)
    result = stage.solve()
    corners, areas = triangle_areas(product)
    pressure = stage.attribute(product, "pressure_kpa").astype(float) / 1000
    assert (pressure[corners].mean(axis=1) * areas).sum() == pytest.approx(result.force_n, rel=0.01)


def test_second_solve_does_not_read_the_first():
    hand, _ = stage.scene()
    stage.solve()
    first = [stage.attribute(hand, name) for name in ("pressure_kpa", "contact_displacement_mm")]
    shape = stage.evaluated(hand)
    for _ in range(2):
        stage.solve()
    second = [stage.attribute(hand, name) for name in ("pressure_kpa", "contact_displacement_mm")]
    for one, two in zip(first, second, strict=True):
        assert np.array_equal(one, two)
    assert np.abs(stage.evaluated(hand) - shape).max() < 1e-4


def test_force_target_moves_the_product_and_clear_puts_it_back():
    hand, product = stage.scene()
    settings = bpy.context.scene.thenar
    settings.use_force, settings.force_n = True, 3.0
    place = stage.evaluated(product)
    result = stage.solve()
    offset = result.offset_mm
    assert result.force_n == pytest.approx(3.0, rel=0.02)
    moved = stage.evaluated(product) - place
    assert np.abs(moved - offset * np.array(result.direction)).max() < 1e-3
    assert stage.solve().offset_mm == pytest.approx(offset, abs=1e-6), "again from its own place"
    assert bpy.ops.thenar.clear() == {"FINISHED"}
    assert np.abs(stage.evaluated(product) - place).max() < 1e-4
    assert tuple(product.delta_location) == (0, 0, 0)


def test_regions_come_from_vertex_groups():
    hand, _ = stage.scene()
    points = stage.evaluated(hand)
    for name, side in (("index_left", points[:, 0] < 0), ("index_right", points[:, 0] >= 0)):
        hand.vertex_groups.new(name=name).add(np.flatnonzero(side & (points[:, 2] < 4)).tolist(), 1.0, "REPLACE")
    assert bpy.ops.thenar.assign_regions() == {"FINISHED"}
    result = stage.solve()
    region = stage.attribute(hand, "contact_region")
    assert (region[points[:, 2] >= 4] == -1).all()
    assert (region[(points[:, 2] < 4) & (points[:, 0] < 0)] == 0).all()
    assert [row.name for row in result.regions] == ["index_left", "index_right"]
    force = stage.attribute(hand, "contact_force_n")
    for index, row in enumerate(result.regions):
        assert row.force_n == pytest.approx(force[region == index].sum(), rel=1e-3)
    assert sum(row.force_n for row in result.regions) == pytest.approx(result.force_n, rel=1e-3)
    bpy.ops.thenar.select_region(index=1)
    assert [vertex.select for vertex in hand.data.vertices] == (region == 1).tolist()


def test_clear_leaves_nothing_behind():
    hand, product = stage.scene()
    before = sorted(hand.data.attributes.keys()), sorted(product.data.attributes.keys())
    shape = stage.evaluated(hand)
    stage.solve()
    bpy.ops.thenar.show_pressure()
    bpy.ops.thenar.clear()
    assert (sorted(hand.data.attributes.keys()), sorted(product.data.attributes.keys())) == before
    assert hand.data.shape_keys is None and not bpy.context.scene.thenar.result.is_valid
    assert np.array_equal(stage.evaluated(hand), shape)
    with pytest.raises(RuntimeError, match="press Solve first"):
        bpy.ops.thenar.clear()


def test_apply_keeps_the_shape_without_the_key():
    hand, _ = stage.scene()
    stage.solve()
    shape = stage.evaluated(hand)
    bpy.ops.thenar.apply()
    assert hand.data.shape_keys is None
    assert np.abs(stage.evaluated(hand) - shape).max() < 1e-4


def test_no_contact_is_a_result_and_is_said():
    hand, product = stage.scene(top=-9.0)
    result = stage.solve()
    assert result.force_n == 0 and result.area_mm2 == 0
    assert np.abs(stage.attribute(hand, "contact_displacement_mm")).max() == 0


@pytest.mark.parametrize("scale", [0.001, 0.01, 1.0])
def test_unit_scale_changes_nothing(scale):
    hand, product = stage.scene()
    expected = stage.solve()
    expected = (expected.force_n, expected.area_mm2, expected.peak_kpa)
    bpy.ops.thenar.clear()
    bpy.context.scene.unit_settings.scale_length = scale
    for obj in (hand, product):
        obj.scale /= scale
        obj.location /= scale
    bpy.context.view_layer.update()
    result = stage.solve()
    assert (result.force_n, result.area_mm2, result.peak_kpa) == pytest.approx(expected, rel=1e-4)


def test_far_from_the_origin_changes_little():
    hand, product = stage.scene()
    expected = stage.solve().force_n
    bpy.ops.thenar.clear()
    for obj in (hand, product):
        obj.location.x += 64.0  # exact in single precision beside the parts' own 0.01 mm
    bpy.context.view_layer.update()
    assert stage.solve().force_n == pytest.approx(expected, rel=1e-3)


def test_tables_keep_no_row_of_the_result_before(scene):
    stage.scene()
    result = stage.solve()
    tables = (result.regions, result.fingers, result.stages, result.warnings)
    lengths = [len(table) for table in tables]
    for table in tables:
        table.add().name = "old"
    result = stage.solve()
    assert [len(table) for table in tables] == lengths
    result.regions.clear()
    result = stage.solve()
    assert len(result.regions) == lengths[0]
    assert sum(row.force_n for row in result.regions) == pytest.approx(result.force_n, rel=1e-6)
