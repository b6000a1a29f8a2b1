"""A coarse product is shown by a finer copy: same force, no stripes, the hand's numbers as they were."""

import bpy
import numpy as np
import pytest
import stage
from thenar_blender.skin_display import refine


def box(sides_mm=(120.0, 90.0, 40.0), name="Box"):
    """A block of 12 triangles under the pad's place, its top side at z = 0."""
    corners = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-1.0, 0.0)]) * sides_mm
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(corner * stage.MM) for corner in corners], [], faces)
    mesh.update()
    part = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(part)
    return part


def pressed(part):
    """A ball 0.6 mm deep in the part's top side. Returns the scene's result."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=5, radius=8 * stage.MM)
    hand = bpy.context.object
    hand.location.z = 7.4 * stage.MM
    settings = bpy.context.scene.thenar
    settings.hand, settings.product = hand, part
    return stage.solve()


def copy_of(part):
    return next((obj for obj in bpy.data.objects if obj.thenar.copy_of == part.name), None)


def force_and_area(obj):
    """Force (N) and pressed area (mm2) of an object's map, by its own triangles."""
    mesh = obj.data
    mesh.calc_loop_triangles()
    points = np.array([obj.matrix_world @ vertex.co for vertex in mesh.vertices]) / stage.MM
    pressure = stage.attribute(obj, "pressure_kpa") * 1e-3
    force = area = 0.0
    for triangle in mesh.loop_triangles:
        a, b, c = (points[vertex] for vertex in triangle.vertices)
        share = np.linalg.norm(np.cross(b - a, c - a)) / 6.0
        force += share * sum(pressure[vertex] for vertex in triangle.vertices)
        area += share * sum(pressure[vertex] > 0.0 for vertex in triangle.vertices)
    return force, area


def test_a_block_of_twelve_triangles_shows_where_it_is_pressed():
    part = box()
    result = pressed(part)
    copy = copy_of(part)
    assert not [text for text in result.warnings if "smeared" in text.name]
    for carrier in (copy, part):
        assert force_and_area(carrier)[0] == pytest.approx(result.force_n, rel=1e-4)
    assert force_and_area(copy)[1] < 3.0 * result.area_mm2 < 0.1 * force_and_area(part)[1]
    peak = stage.attribute(copy, "pressure_kpa").max()
    assert 0.6 * result.peak_kpa < peak < 1.4 * result.peak_kpa


def test_the_hand_does_not_feel_it():
    part = box()
    result = pressed(part)
    hand = bpy.context.scene.thenar.hand
    fine = result.force_n, result.peak_kpa, stage.attribute(hand, "pressure_kpa").copy()
    bpy.ops.thenar.clear()
    before, refine.FOR_MAPS = refine.FOR_MAPS, (np.inf, np.inf)
    try:
        result = stage.solve()
    finally:
        refine.FOR_MAPS = before
    assert copy_of(part) is None and any("smeared" in text.name for text in result.warnings)
    assert (result.force_n, result.peak_kpa) == pytest.approx(fine[:2], rel=1e-6)
    assert np.allclose(stage.attribute(hand, "pressure_kpa"), fine[2], atol=1e-3)


def test_the_copy_goes_with_clear_with_live_and_with_a_fine_product(tmp_path):
    part = box()
    pressed(part)
    assert bpy.ops.thenar.show_pressure() == {"FINISHED"}
    assert part.hide_get() and not copy_of(part).hide_viewport
    bpy.ops.thenar.clear()
    assert copy_of(part) is None and not part.hide_get()
    stage.solve()
    bpy.context.scene.thenar.live = True
    assert copy_of(part) is None
    bpy.context.scene.thenar.live = False
    bpy.ops.thenar.clear()
    stage.solve()
    assert copy_of(part) is not None
    modifier = part.modifiers.new("Fine", "SUBSURF")
    modifier.subdivision_type, modifier.levels = "SIMPLE", 7
    stage.solve()
    assert copy_of(part) is None


def test_a_bake_plays_on_the_part_itself(tmp_path):
    part = box()
    pressed(part)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    assert bpy.ops.thenar.bake(frame_start=1, frame_end=2) == {"FINISHED"}
    assert copy_of(part) is None


def test_cut_triangles_keep_common_edges_and_the_surface():
    """Against areas and edges counted here: every edge of a closed surface has two sides, and no area is lost."""
    rng = np.random.default_rng(3)
    points = np.array([(x, y, z) for x in (0, 90) for y in (0, 60) for z in (0, 40)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([each for a, b, c, d in quads for each in ((a, b, c), (a, c, d))])
    for _ in range(20):
        near = rng.uniform(0, (90, 60, 40), (5, 3))
        new_points, new_faces, parents = refine._cut(points, faces, near, (10.0, 3.75))
        edges = np.sort(np.concatenate([new_faces[:, pair] for pair in ([0, 1], [1, 2], [2, 0])]), axis=1)
        assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
        assert refine._vertex_areas(new_points, new_faces).sum() == pytest.approx(2 * (90 * 60 + 90 * 40 + 60 * 40))
        assert len(new_points) == len(points) + sum(map(len, parents))
        away = np.linalg.norm(new_points[new_faces].mean(axis=1)[:, None] - near, axis=2).min(axis=1)
        sides = new_points[new_faces] - np.roll(new_points[new_faces], 1, axis=1)
        assert np.linalg.norm(sides, axis=2).max(axis=1)[away < 8.0].max(initial=0.0) <= 1.5 * 2.5 + 1e-9
