"""A Subdivision level is computed as Blender shows it, and where it is not, Blender's own surface is used."""

import bmesh
import bpy
import numpy as np
import pytest
import stage
from thenar_blender.skin_display import shown
from thenar_blender.subdivision import catmull_clark, last

SINGLE = 2e-6
"""Single precision on meshes of a size of 2, over sums of some tens."""


def cube():
    bpy.ops.mesh.primitive_cube_add()


def triangles():
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3)


def polygons():
    bpy.ops.mesh.primitive_cylinder_add(vertices=7)


def open_tube():
    bpy.ops.mesh.primitive_cylinder_add(vertices=9, end_fill_type="NOTHING")


def sheet_with_corners():
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=5, y_subdivisions=4)


def fan():
    bpy.ops.mesh.primitive_circle_add(vertices=7, fill_type="TRIFAN")


def shaken(make):
    """The mesh of `make`, its vertices moved at random, and its Subdivision level."""
    make()
    obj = bpy.context.object
    points = local(obj.data)
    points += np.random.default_rng(5).normal(scale=0.05, size=points.shape)
    obj.data.vertices.foreach_set("co", points.astype(np.float32).ravel())
    modifier = obj.modifiers.new("Level", "SUBSURF")
    modifier.levels = 1
    return obj, modifier


def local(mesh):
    out = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", out)
    return out.reshape(-1, 3).astype(np.float64)


def by_blender(obj):
    """Positions, and triangles as a set of corners in turn, of the evaluated mesh."""
    bpy.context.view_layer.update()
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    mesh.calc_loop_triangles()
    found = local(mesh), in_turn([triangle.vertices[:] for triangle in mesh.loop_triangles])
    evaluated.to_mesh_clear()
    return found


def in_turn(triangles):
    return {tuple(np.roll(corners, -int(np.argmin(corners)))) for corners in np.asarray(triangles).tolist()}


@pytest.mark.parametrize("corners", ["ALL", "PRESERVE_CORNERS"])
@pytest.mark.parametrize("is_limit", [True, False], ids=["limit", "refined"])
@pytest.mark.parametrize("make", [cube, triangles, polygons, open_tube, sheet_with_corners, fan])
def test_vertices_and_triangles_are_those_that_blender_makes(make, is_limit, corners):
    obj, modifier = shaken(make)
    modifier.use_limit_surface, modifier.boundary_smooth = is_limit, corners
    rules = catmull_clark.Rules(is_limit, corners == "PRESERVE_CORNERS")
    level = catmull_clark.level(last._faces(obj.data), rules)
    if make is sheet_with_corners and is_limit and corners == "ALL":
        assert level is None, "there Blender approximates"
        return
    points, faces = by_blender(obj)
    cage = local(obj.data)
    computed = level.points(cage)
    assert np.abs(computed - points).max() < SINGLE
    assert np.array_equal(level.own_points(cage), computed[: len(cage)])
    assert in_turn(level.triangles(computed)) == faces


def test_only_vertices_that_come_of_chosen_ones_are_chosen():
    obj, _ = shaken(cube)
    level = catmull_clark.level(last._faces(obj.data), catmull_clark.Rules())
    corners = np.ones(8, bool)
    corners[0] = False
    chosen = level.only(corners)
    assert (~chosen).sum() == 1 + 3 + 3, "a corner of a cube, its edges and its faces"


def edge_of_three_faces(work):
    edge = work.edges[0]
    far = work.verts.new((3.0, 3.0, 3.0))
    work.faces.new([*edge.verts, far])


def turned_face(work):
    work.faces.ensure_lookup_table()
    work.faces[0].normal_flip()


def faces_that_meet_in_a_vertex(work):
    far = [work.verts.new(place) for place in ((3.0, 3.0, 3.0), (3.0, 4.0, 3.0))]
    work.verts.ensure_lookup_table()
    work.faces.new([work.verts[0], *far])


def wire(work):
    work.verts.ensure_lookup_table()
    work.edges.new([work.verts[0], work.verts.new((3.0, 3.0, 3.0))])


@pytest.mark.parametrize("spoil", [edge_of_three_faces, turned_face, faces_that_meet_in_a_vertex, wire])
def test_meshes_that_blender_subdivides_by_other_rules_are_not_taken(spoil):
    obj, _ = shaken(triangles)
    assert catmull_clark.level(last._faces(obj.data), catmull_clark.Rules()) is not None
    work = bmesh.new()
    work.from_mesh(obj.data)
    work.edges.ensure_lookup_table()
    spoil(work)
    work.to_mesh(obj.data)
    assert catmull_clark.level(last._faces(obj.data), catmull_clark.Rules()) is None


def ball(fineness=3):
    """A ball with a Subdivision level, pressed 1.2 mm by a plate."""
    hand, product = stage.pad(fineness=fineness), stage.plate()
    settings = bpy.context.scene.thenar
    settings.hand, settings.product = hand, product
    modifier = hand.modifiers.new("Level", "SUBSURF")
    modifier.levels = modifier.render_levels = 1
    stage.raise_under(hand, product)
    return hand, product


def depth(hand, product):
    return stage.evaluated(product)[:, 2].max() - stage.evaluated(hand)[:, 2].min()


@pytest.fixture
def computed(monkeypatch):
    """The calls in which a level was computed."""
    monkeypatch.setattr(last, "_refuted", set())
    calls, plain = [], shown._computed

    def counted(*arguments):
        calls.append(arguments)
        return plain(*arguments)

    monkeypatch.setattr(shown, "_computed", counted)
    return calls


@pytest.mark.parametrize("scale", [1.0, -1.0], ids=["", "mirrored"])
def test_the_result_is_that_of_blenders_own_evaluation(scale, computed, monkeypatch):
    hand, product = ball()
    stage.bend(hand)
    hand.modifiers.move(hand.modifiers.find("Level"), 1)
    hand.scale.x = scale
    stage.raise_under(hand, product)
    fast = stage.solve()
    force, found, surface = fast.force_n, fast.shown_between_mm, stage.evaluated(hand)
    assert len(computed) == 1 and force > 0.1
    bpy.ops.thenar.clear()
    monkeypatch.setattr(last, "_candidate", lambda context, hand: None)
    slow = stage.solve()
    assert len(computed) == 1
    assert force == pytest.approx(slow.force_n, rel=1e-3)
    assert found == pytest.approx(slow.shown_between_mm, abs=2e-3)
    assert np.abs(stage.evaluated(hand) - surface).max() < 0.02


def test_blender_evaluates_the_level_once(computed):
    hand, _ = ball()
    seen = []

    def watch(scene, graph):
        changed = any(update.is_updated_geometry and update.id.original == hand for update in graph.updates)
        if changed and hand.modifiers["Level"].show_viewport:
            seen.append(len(hand.modifiers))

    stage.evaluated(hand)
    bpy.app.handlers.depsgraph_update_post.append(watch)
    try:
        stage.solve()
        bpy.context.view_layer.update()
        assert len(seen) == 1 and len(computed) == 1
        bpy.context.scene.thenar.product.location.z += 0.2 * stage.MM
        bpy.context.view_layer.update()
        seen.clear()
        stage.solve()
        bpy.context.view_layer.update()
        assert len(seen) == 1 and len(computed) == 2
    finally:
        bpy.app.handlers.depsgraph_update_post.remove(watch)


def test_where_blender_shows_otherwise_its_own_surface_is_used(computed, monkeypatch):
    hand, product = ball()
    plain = catmull_clark.Level.points
    monkeypatch.setattr(catmull_clark.Level, "points", lambda level, cage: plain(level, cage) + 5e-5)
    result = stage.solve()
    assert len(computed) == 1 and last._refuted
    assert depth(hand, product) < 0.02 and result.shown_penetration_mm < 0.02
    assert hand.modifiers["Level"].show_viewport
    stage.solve()
    assert len(computed) == 1, "it is remembered"


def creased(hand):
    hand.data.attributes.new("crease_edge", "FLOAT", "EDGE").data[0].value = 0.8


def creased_vertex(hand):
    hand.data.attributes.new("crease_vert", "FLOAT", "POINT").data[0].value = 0.8


def two_levels(hand):
    hand.modifiers["Level"].levels = 2


def smoothed_behind(hand):
    hand.modifiers.new("Keeper", "CORRECTIVE_SMOOTH").iterations = 5


def bilinear(hand):
    hand.modifiers["Level"].subdivision_type = "SIMPLE"


@pytest.mark.parametrize("change", [creased, creased_vertex, two_levels, smoothed_behind, bilinear])
def test_other_subdivisions_are_left_to_blender(change, computed):
    hand, product = ball()
    change(hand)
    stage.raise_under(hand, product)
    stage.solve()
    assert not computed and depth(hand, product) < 0.02


def test_scene_wide_simplification_counts(computed):
    hand, product = ball()
    two_levels(hand)
    bpy.context.scene.render.use_simplify, bpy.context.scene.render.simplify_subdivision = True, 1
    stage.raise_under(hand, product)
    stage.solve()
    assert len(computed) == 1 and depth(hand, product) < 0.02


def test_an_edited_mesh_gets_a_level_of_its_own(computed):
    hand, product = ball()
    hand.shape_key_add(name="Basis")
    stage.solve()
    bpy.ops.thenar.clear()
    hand.shape_key_clear()
    work = bmesh.new()
    work.from_mesh(hand.data)
    bmesh.ops.poke(work, faces=work.faces[:40])
    work.to_mesh(hand.data)
    work.free()
    stage.raise_under(hand, product)
    stage.solve()
    assert len(computed) == 2 and not last._refuted and depth(hand, product) < 0.02


def test_painted_shapes_count(computed):
    """A shape key of the user's own goes through the level."""
    hand, product = ball()
    hand.shape_key_add(name="Basis")
    key = hand.shape_key_add(name="Fuller")
    for point in key.data:
        point.co *= 1.05
    key.value = 0.7
    stage.raise_under(hand, product)
    stage.solve()
    assert len(computed) == 1 and depth(hand, product) < 0.02
