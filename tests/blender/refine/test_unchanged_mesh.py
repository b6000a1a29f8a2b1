"""What Refine Skin keeps: shape at rest, whole edges, weights, regions, shape keys, UVs, colors, materials, numbers."""

import bmesh
import bpy
import fine_features
import numpy as np
import pytest
import stage
from scipy.spatial import cKDTree

OLD = 162


def dressed(hand):
    """Everything that a mesh may carry, on a bent ball: bones, two regions and none, a key, UVs, colors, materials."""
    mesh, rng = hand.data, np.random.default_rng(5)
    stage.bend(hand)
    points = fine_features.points_mm(hand)
    for name, chosen in (("low", points[:, 1] < 2.0), ("high", points[:, 1] > 2.0)):
        group = hand.vertex_groups.new(name=name)
        group.add(np.flatnonzero(chosen & (points[:, 0] > -3.0)).tolist(), 1.0, "REPLACE")
        hand.thenar.materials.add().name = name
    hand.shape_key_add(name="Basis")
    key = hand.shape_key_add(name="Swollen", from_mix=False)
    key.points.foreach_set("co", (points * stage.MM * rng.uniform(1.0, 1.05, (len(points), 1))).astype("f").ravel())
    key.value = 0.3
    for name, kind, values in (
        ("number", "INT", rng.integers(0, 9, OLD)),
        ("share", "FLOAT", rng.random(OLD)),
        ("mark", "BOOLEAN", rng.random(OLD) < 0.5),
    ):
        mesh.attributes.new(name, kind, "POINT").data.foreach_set("value", values)
    corners = len(mesh.loops)
    if not mesh.uv_layers:
        mesh.uv_layers.new(name="UVMap")
    flat = points[[loop.vertex_index for loop in mesh.loops]][:, :2]  # linear over the mesh, cut where x changes sign
    flat[:, 0] += 50.0 * np.repeat([polygon.center.x > 0 for polygon in mesh.polygons], 3)
    mesh.uv_layers.active.data.foreach_set("uv", flat.astype("f").ravel())
    part = mesh.attributes.new("part", "INT", "CORNER")
    panel = rng.integers(0, 9, len(mesh.polygons))
    mesh.attributes.new("panel", "INT", "FACE").data.foreach_set("value", panel)
    part.data.foreach_set("value", (10 * panel.repeat(3) + rng.choice([0, 9], corners)).astype(np.int32))
    tint = mesh.color_attributes.new("Tint", "BYTE_COLOR", "CORNER")
    tint.data.foreach_set("color", rng.random(4 * corners).astype("f"))
    for name in ("One", "Two"):
        mesh.materials.append(bpy.data.materials.new(name))
    mesh.polygons.foreach_set("material_index", [int(polygon.center.y > 0) for polygon in mesh.polygons])
    bpy.context.view_layer.update()
    return hand


def weights(hand):
    """Weights (groups, n) by Blender's own table."""
    out = np.zeros((len(hand.vertex_groups), len(hand.data.vertices)))
    for vertex in hand.data.vertices:
        for element in vertex.groups:
            out[element.group, vertex.index] = element.weight
    return out


def regions_of(table):
    """Region (n,) of the last two groups, -1 for none."""
    return np.where(table[-2:].max(axis=0) > 1e-4, table[-2:].argmax(axis=0), -1)


@pytest.fixture
def pressed():
    """A dressed ball before and after one press: (hand, old readings, old edges that were halved)."""
    hand = dressed(fine_features.ball())
    wire_under(hand)
    old = readings(hand)
    edges = np.array([tuple(edge.vertices) for edge in hand.data.edges])
    assert bpy.ops.thenar.refine_skin() == {"FINISHED"}
    new = fine_features.points_mm(hand)[OLD:]
    assert len(new) > 20
    away, row = cKDTree(old["points"][edges].mean(axis=1)).query(new)
    assert away.max() < 1e-5  # each new vertex lies in the middle of an old edge
    assert len(np.unique(row)) == len(row)
    return hand, old, edges[row]


def wire_under(hand):
    """A wire through the skin of the bent ball as it is shown, between its vertices."""
    shown, triangles = stage.evaluated(hand), fine_features.triangles_of(hand)
    row = np.argmin(np.abs(triangles - 40).sum(axis=1))  # any triangle
    foot = shown[triangles[row]].mean(axis=0)
    a, b, c = shown[triangles[row]]
    out = np.cross(b - a, c - a)
    out /= np.linalg.norm(out)
    way = (b - a) / np.linalg.norm(b - a)
    fine_features.wire((foot, way, out), radius=0.4, sunk=0.3)


def readings(hand):
    """Arrays of all that the mesh carries."""
    keys = hand.data.shape_keys.key_blocks
    return {
        "points": fine_features.points_mm(hand),
        "triangles": fine_features.triangles_of(hand),
        "edges": fine_features.sides_of_edges(hand),
        "weights": weights(hand),
        "keys": {key.name: np.array([point.co for point in key.points]) / stage.MM for key in keys},
        "shown": stage.evaluated(hand),
        **{name: np.array([value.value for value in hand.data.attributes[name].data]) for name in ATTRIBUTES},
    }


ATTRIBUTES = ("number", "share", "mark")


def test_the_shape_at_rest_and_the_old_vertices_stay(pressed):
    hand, old, _ = pressed
    new = readings(hand)
    assert np.array_equal(new["points"][:OLD], old["points"])
    before = fine_features.area_and_volume(old["points"], old["triangles"])
    assert fine_features.area_and_volume(new["points"], new["triangles"]) == pytest.approx(before, rel=1e-6)
    assert np.abs(new["shown"][:OLD] - old["shown"]).max() < 1e-5


def test_every_edge_has_two_faces_as_before(pressed):
    hand, old, _ = pressed
    assert set(old["edges"].values()) == {2}
    assert set(fine_features.sides_of_edges(hand).values()) == {2}
    vertices, edges, faces = len(hand.data.vertices), len(hand.data.edges), len(hand.data.polygons)
    assert vertices - edges + faces == 2 and len(fine_features.sides_of_edges(hand)) == edges
    assert not hand.data.validate(verbose=True)


def test_weights_sum_to_one_and_new_ones_lie_halfway(pressed):
    hand, old, parents = pressed
    new = weights(hand)
    bones = [hand.vertex_groups[name].index for name in ("root", "tip")]
    assert new[bones].sum(axis=0) == pytest.approx(1.0, abs=1e-6)
    assert np.array_equal(new[:, :OLD], old["weights"])
    assert new[bones][:, OLD:] == pytest.approx(old["weights"][bones][:, parents].mean(axis=2), abs=1e-6)


def test_old_vertices_keep_their_region_and_new_ones_take_that_of_an_end(pressed):
    hand, old, parents = pressed
    before, after = regions_of(old["weights"]), regions_of(weights(hand))
    assert np.array_equal(after[:OLD], before)
    ends = before[parents]
    assert (after[OLD:, None] == ends).any(axis=1).all()
    assert (ends[:, 0] != ends[:, 1]).any() and len(np.unique(after[OLD:])) > 1
    pads = weights(hand)[-2:]
    assert set(np.unique(pads)) == {0.0, 1.0} and (pads.sum(axis=0) <= 1.0).all()


def test_keys_and_attributes_go_along(pressed):
    hand, old, parents = pressed
    new = readings(hand)
    assert list(new["keys"]) == ["Basis", "Swollen"]
    assert hand.data.shape_keys.key_blocks["Swollen"].value == pytest.approx(0.3)
    for name, points in new["keys"].items():
        assert np.array_equal(points[:OLD], old["keys"][name])
        assert points[OLD:] == pytest.approx(old["keys"][name][parents].mean(axis=1), abs=1e-5)
    assert new["share"][OLD:] == pytest.approx(old["share"][parents].mean(axis=1), abs=1e-6)
    for name in ("number", "mark"):
        assert np.array_equal(new[name][:OLD], old[name])
        assert (new[name][OLD:, None] == old[name][parents]).any(axis=1).all()


def test_faces_keep_uvs_seams_materials_and_colors(pressed):
    hand, _, _ = pressed
    mesh = hand.data
    points = fine_features.points_mm(hand)
    uv = np.array([corner.uv for corner in mesh.uv_layers.active.data])
    sides, materials = np.array([(p.center.x > 0, p.center.y > 0) for p in mesh.polygons]).T
    for polygon in mesh.polygons:
        for loop in polygon.loop_indices:
            place = points[mesh.loops[loop].vertex_index][:2]
            shift = uv[loop] - place
            assert shift == pytest.approx([shift[0].round() and 50.0, 0.0], abs=1e-4)
        assert (
            len({round(float(uv[loop][0] - points[mesh.loops[loop].vertex_index][0])) for loop in polygon.loop_indices})
            == 1
        )
    assert np.mean([p.material_index for p in mesh.polygons] == materials.astype(int)) > 0.97
    part = np.array([value.value for value in mesh.attributes["part"].data])
    panel = np.array([value.value for value in mesh.attributes["panel"].data])
    assert np.isin(part.reshape(-1, 3) - 10 * panel[:, None], [0, 9]).all() and len(np.unique(panel)) > 5
    assert {material.name for material in mesh.materials} == {"One", "Two"}
    assert mesh.color_attributes["Tint"].domain == "CORNER" and sides.any()
    tints = np.array([value.color for value in mesh.color_attributes["Tint"].data])
    assert (tints[:, 3] > 0.0).mean() > 0.95


def test_regions_that_are_bones_stay_those_of_an_end_and_their_weights_whole():
    """Of two bones' regions that share a third bone the plain mean is the third one's: it must not be."""
    hand = fine_features.ball()
    points = fine_features.points_mm(hand)
    data = bpy.data.armatures.new("Rig")
    rig = bpy.data.objects.new("Rig", data)
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name in ("one", "two", "both"):
        bone = data.edit_bones.new(name)
        bone.head, bone.tail = (0, 0, 0), (0, 0.01, 0)
    bpy.ops.object.mode_set(mode="OBJECT")
    is_one = points @ [0.3, 0.5, 0.8] > 0.0
    for name, table in (("one", 0.6 * is_one), ("two", 0.6 * ~is_one), ("both", np.full(OLD, 0.4))):
        group = hand.vertex_groups.new(name=name)
        for vertex, weight in enumerate(table):
            if weight:
                group.add([vertex], float(weight), "REPLACE")
        hand.thenar.materials.add().name = name
    hand.modifiers.new("Rig", "ARMATURE").object = rig
    wire_under(hand)
    fine_features.refine(spacing_mm=1.3)
    now = weights(hand)
    assert len(now[0]) > OLD + 20 and now.sum(axis=0) == pytest.approx(1.0, abs=1e-6)
    new = now[:, OLD:].argmax(axis=0)
    assert set(new) <= {0, 1}
    assert ((now[0, OLD:] > 0.0) & (now[1, OLD:] > 0.0)).any()  # some do lie between the two


def test_one_undo_takes_it_back():
    """The operator asks for an undo step of its own; in background Blender keeps the stack by `ed.undo_push`."""
    hand = fine_features.ball()
    name = hand.name
    fine_features.wire(
        fine_features.gap_place(fine_features.points_mm(hand), fine_features.triangles_of(hand)), 0.5, 0.4
    )
    bpy.context.preferences.edit.use_global_undo = True
    bpy.ops.ed.undo_push(message="before")
    fine_features.refine()
    bpy.ops.ed.undo_push(message="refined")
    assert "UNDO" in bpy.types.THENAR_OT_refine_skin.bl_options
    assert len(bpy.data.objects[name].data.vertices) > OLD
    bpy.ops.ed.undo()
    assert len(bpy.data.objects[name].data.vertices) == OLD


@pytest.mark.parametrize("kind", ["quads", "many corners", "doubled"])
def test_hands_of_other_faces_stay_closed_and_as_large(kind):
    """A sphere of quads, one with a cap of many corners, and one whose vertices are doubled along a seam."""
    bpy.ops.mesh.primitive_uv_sphere_add(radius=fine_features.RADIUS * stage.MM, segments=20, ring_count=10)
    hand = bpy.context.object
    bpy.context.scene.thenar.hand = hand
    work = bmesh.new()
    work.from_mesh(hand.data)
    if kind == "many corners":
        top = max(work.verts, key=lambda vertex: vertex.co.z)
        bmesh.ops.dissolve_verts(work, verts=[top])
    if kind == "doubled":
        bmesh.ops.split_edges(work, edges=[edge for edge in work.edges if max(abs(v.co.x) for v in edge.verts) < 1e-6])
    work.to_mesh(hand.data)
    work.free()
    points, triangles = fine_features.points_mm(hand), fine_features.triangles_of(hand)
    top = triangles[points[triangles].mean(axis=1)[:, 2].argsort()[-30:]]
    foot = points[top[0]].mean(axis=0)
    out = foot / np.linalg.norm(foot)
    way = np.cross(out, [1.0, 0.0, 0.0])
    fine_features.wire((foot, way / np.linalg.norm(way), out), radius=0.4, sunk=0.3, half=12.0)
    fine_features.refine(2)
    now = fine_features.points_mm(hand), fine_features.triangles_of(hand)
    assert fine_features.area_and_volume(*now) == pytest.approx(
        fine_features.area_and_volume(points, triangles), rel=1e-6
    )
    welded = np.unique(now[0].round(5), axis=0, return_inverse=True)[1].ravel()
    sides = {}
    for polygon in hand.data.polygons:
        ring = [welded[vertex] for vertex in polygon.vertices]
        for pair in zip(ring, ring[1:] + ring[:1], strict=True):
            sides[tuple(sorted(pair))] = sides.get(tuple(sorted(pair)), 0) + 1
    assert set(sides.values()) == {2} and len(now[0]) > len(points) + 20
