"""What a viewer sees fits the product, whatever stands in the hand's stack; measured by Blender's own BVH tree."""

import bpy
import numpy as np
import pytest
import stage
from mathutils.bvhtree import BVHTree


def shown_mesh(obj):
    """World positions (n, 3), mm, and polygons of the evaluated mesh."""
    points = stage.evaluated(obj)
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    faces = [tuple(polygon.vertices) for polygon in evaluated.to_mesh().polygons]
    evaluated.to_mesh_clear()
    return points, faces


def depths(points, product):
    """How deep points (n, 3) lie in a convex product, mm; 0 outside."""
    corners, faces = shown_mesh(product)
    tree = BVHTree.FromPolygons([tuple(corner) for corner in corners], faces)
    found = []
    for point in points:
        place, normal, _, distance = tree.find_nearest(point)
        is_inside = (np.array(point) - place) @ np.array(normal) < 0.0
        found.append(distance if is_inside else 0.0)
    return np.array(found)


def between(hand):
    """Mid points of edges and centres of the fan triangles of the shown hand, mm."""
    points, faces = shown_mesh(hand)
    corners = points[np.array([(face[0], face[k], face[k + 1]) for face in faces for k in range(1, len(face) - 1)])]
    mids = 0.5 * (corners + np.roll(corners, 1, axis=1)).reshape(-1, 3)
    return np.concatenate([mids, corners.mean(axis=1)])


def rod(radius=5.0, depth=1.2, segments=256):
    """A fine rod across the ball's lowest point."""
    bpy.ops.mesh.primitive_cylinder_add(
        vertices=segments,
        radius=radius * stage.MM,
        depth=60 * stage.MM,
        location=(0, 0, (depth - 8.0 - radius) * stage.MM),
        rotation=(0, np.pi / 2, 0),
    )
    return bpy.context.object


def ball_on_rod(fineness=4, **options):
    hand, product = stage.pad(fineness=fineness), rod(**options)
    bpy.context.scene.thenar.hand, bpy.context.scene.thenar.product = hand, product
    bpy.context.view_layer.update()
    return hand, product


def surface_deform(hand):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=9 * stage.MM)
    hand.modifiers.new("Keeper", "SURFACE_DEFORM").target = bpy.context.object
    with bpy.context.temp_override(object=hand, active_object=hand):
        bpy.ops.object.surfacedeform_bind(modifier="Keeper")


def shrinkwrap(hand):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=5, radius=8.3 * stage.MM)
    hand.modifiers.new("Keeper", "SHRINKWRAP").target = bpy.context.object


def corrective_smooth(hand):
    hand.modifiers.new("Keeper", "CORRECTIVE_SMOOTH").iterations = 40


def laplacian_deform(hand):
    hand.vertex_groups.new(name="Anchors").add(list(range(0, len(hand.data.vertices), 9)), 1.0, "REPLACE")
    modifier = hand.modifiers.new("Keeper", "LAPLACIANDEFORM")
    modifier.vertex_group = "Anchors"
    with bpy.context.temp_override(object=hand, active_object=hand):
        bpy.ops.object.laplaciandeform_bind(modifier="Keeper")


def subdivision(hand):
    modifier = hand.modifiers.new("Keeper", "SUBSURF")
    modifier.levels = modifier.render_levels = 1


def subdivision_before_smooth(hand):
    subdivision(hand)
    corrective_smooth(hand)


KEEPERS = [surface_deform, shrinkwrap, corrective_smooth, laplacian_deform, subdivision, subdivision_before_smooth]


@pytest.mark.parametrize("keeper", KEEPERS, ids=lambda keeper: keeper.__name__)
def test_shown_skin_fits_behind_modifiers_that_keep_it(keeper):
    hand, product = stage.scene()
    keeper(hand)
    stage.raise_under(hand, product)
    result = stage.solve()
    deepest = stage.evaluated(product)[:, 2].max() - stage.evaluated(hand)[:, 2].min()
    assert result.force_n > 0.1
    assert deepest < 0.02
    assert result.shown_penetration_mm == pytest.approx(max(deepest, 0.0), abs=0.003)
    notes = [text.name for text in result.warnings if "Thenar Shown" in text.name]
    assert notes and "Keeper" in notes[0]


@pytest.mark.parametrize("levels", [1, 2])
def test_subdivided_skin_fits_a_rod(levels):
    hand, product = ball_on_rod(fineness=3)
    subdivision(hand)
    hand.modifiers["Keeper"].levels = levels
    bpy.context.view_layer.update()
    assert depths(stage.evaluated(hand), product).max() > 1.0, "it is pressed"
    result = stage.solve()
    measured = depths(stage.evaluated(hand), product).max()
    assert measured < 0.02
    assert result.shown_penetration_mm == pytest.approx(measured, abs=0.003)
    base = len(hand.data.vertices)
    for name in ("pressure_kpa", "contact_displacement_mm", "contact_region"):
        assert len(hand.data.attributes[name].data) == base


def test_triangles_between_vertices_are_measured_too():
    hand, product = ball_on_rod(fineness=3)
    result = stage.solve()
    at_vertices = depths(stage.evaluated(hand), product).max()
    inside = depths(between(hand), product).max()
    assert at_vertices < 0.02 and inside > 0.05, "flat triangles of 2 mm cut into a rod of 5 mm"
    assert result.shown_penetration_mm == pytest.approx(at_vertices, abs=0.003)
    assert result.shown_between_mm == pytest.approx(inside, rel=0.02)


def test_a_moved_product_is_measured_where_it_is():
    hand, product = ball_on_rod(fineness=3)
    subdivision(hand)
    settings = bpy.context.scene.thenar
    settings.use_force, settings.force_n = True, 1.5
    result = stage.solve()
    assert abs(result.offset_mm) > 0.05
    measured = depths(stage.evaluated(hand), product).max()
    assert measured < 0.02
    assert result.shown_penetration_mm == pytest.approx(measured, abs=0.003)


def test_what_is_shown_stays_through_a_second_solve_and_goes_with_clear():
    hand, product = ball_on_rod(fineness=3)
    subdivision(hand)
    names = sorted(hand.data.attributes.keys())
    kept = [len(group) for group in (bpy.data.objects, bpy.data.meshes, bpy.data.node_groups)]
    before = stage.evaluated(hand)
    stage.solve()
    first = stage.evaluated(hand)
    stage.solve()
    assert np.abs(stage.evaluated(hand) - first).max() < 1e-4
    assert [modifier.name for modifier in hand.modifiers] == ["Keeper", "Thenar Shown"]
    bpy.ops.thenar.clear()
    assert [modifier.name for modifier in hand.modifiers] == ["Keeper"]
    assert sorted(hand.data.attributes.keys()) == names
    assert [len(group) for group in (bpy.data.objects, bpy.data.meshes, bpy.data.node_groups)] == kept
    assert np.array_equal(stage.evaluated(hand), before)


def test_apply_keeps_what_is_shown():
    hand, _ = ball_on_rod(fineness=3)
    subdivision(hand)
    stage.solve()
    shape = stage.evaluated(hand)
    bpy.ops.thenar.apply()
    assert np.abs(stage.evaluated(hand) - shape).max() < 1e-3
    assert "Thenar Shown" not in hand.modifiers


def test_another_level_in_the_render_is_not_torn():
    """Offsets by number of an evaluated vertex mean others at another level: there they must not act."""
    hand, product = ball_on_rod(fineness=3)
    subdivision(hand)
    stage.solve()
    hand.modifiers["Keeper"].levels = 2
    bpy.context.view_layer.update()
    assert depths(stage.evaluated(hand), product).max() < 0.2
    edges = np.array(
        [edge.vertices[:] for edge in hand.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.edges]
    )
    points = stage.evaluated(hand)
    assert np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1).max() < 2.0


def test_what_cannot_be_shown_is_refused_by_name_and_leaves_the_scene(monkeypatch):
    from thenar_blender.scene import correction

    hand, product = stage.scene()
    shrinkwrap(hand)
    stage.raise_under(hand, product)
    shape, place = stage.evaluated(hand), stage.evaluated(product)
    attach = correction.attach

    def switched_off(*arguments):
        modifier = attach(*arguments)
        modifier.show_viewport = False
        return modifier

    monkeypatch.setattr(correction, "attach", switched_off)
    with pytest.raises(RuntimeError, match="'Keeper' \\(Shrinkwrap\\)"):
        bpy.ops.thenar.solve()
    assert np.array_equal(stage.evaluated(hand), shape) and np.array_equal(stage.evaluated(product), place)
    assert [modifier.name for modifier in hand.modifiers] == ["Keeper"]
    assert "pressure_kpa" not in hand.data.attributes and not bpy.context.scene.thenar.result.is_valid


def test_loose_vertices_and_bare_parts_do_not_count():
    hand, product = stage.scene()
    points = stage.evaluated(hand)
    group = hand.vertex_groups.new(name="skin")
    group.add(np.flatnonzero(points[:, 0] < 1.0).tolist(), 1.0, "REPLACE")
    hand.data.vertices.add(1)
    hand.data.vertices[-1].co = (0, 0, -0.012)
    group.add([len(hand.data.vertices) - 1], 1.0, "REPLACE")
    bpy.ops.thenar.assign_regions()
    result = stage.solve()
    assert (stage.evaluated(product)[:, 2].max() - stage.evaluated(hand)[:, 2]).max() > 1.0
    assert result.shown_penetration_mm < 0.02


def test_a_bake_takes_off_what_an_earlier_contact_left(tmp_path):
    hand, _ = ball_on_rod(fineness=3)
    subdivision(hand)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    stage.solve()
    assert "Thenar Shown" in hand.modifiers
    bpy.ops.thenar.bake(frame_start=1, frame_end=2)
    assert "Thenar Shown" not in hand.modifiers and "thenar_shown_offset" not in hand.data.attributes


def test_a_duplicated_hand_keeps_its_own_surface():
    hand, product = ball_on_rod(fineness=3)
    subdivision(hand)
    stage.solve()
    twin = hand.copy()
    twin.data = hand.data.copy()
    bpy.context.scene.collection.objects.link(twin)
    shape = stage.evaluated(twin)
    product.location.z += 0.3 * stage.MM
    stage.solve()
    assert np.array_equal(stage.evaluated(twin), shape)
    bpy.ops.thenar.clear()
    assert np.array_equal(stage.evaluated(twin), shape)
