"""Pinches: where a product has two sides to pinch, and thin products that thumb and fingertips hold."""

import numpy as np
import pytest
import thenar
from handles import anatomy, grasping, shapes
from scipy.spatial.transform import Rotation
from thenar_blender.grasp import fitting
from thenar_blender.grasp_fit import pinches, pinching, places, walls
from thenar_blender.hand_bones import reading

PALM = {"thenar", "hypothenar", "palm_hollow", "distal_palm_radial", "distal_palm_ulnar"}


def sheet(thickness):
    """A sheet of 160 by 110 mm about the origin, of twelve triangles."""
    return shapes.block([-80.0, -55.0, -0.5 * thickness], [80.0, 55.0, 0.5 * thickness], 1)


def gauge_of(mesh):
    vertices, triangles = mesh
    return walls.Gauge(thenar.Product(vertices, triangles), is_thin=False)


@pytest.mark.parametrize("thickness", [2.0, 6.0, 25.0])
def test_a_sheet_is_pinched_across_from_its_rim(thickness):
    mesh = sheet(thickness)
    found = pinches.spots(gauge_of(mesh), *mesh)
    assert found
    for pinch in found:
        assert pinch.width_mm == pytest.approx(thickness, abs=0.01)
        assert abs(pinch.across[2]) == pytest.approx(1.0, abs=1e-6)
        assert pinch.center[2] == pytest.approx(0.0, abs=0.01)
        assert abs(pinch.reach[2]) < 1e-6
        web = pinch.center[:2] - pinches.WEB_MM[-1] * pinch.reach[:2]
        assert (np.abs(web) > [80.0, 55.0]).any(), "the web of the thumb stands off the sheet"


def test_a_block_too_thick_to_span_is_not_pinched():
    mesh = shapes.block([-100.0, -100.0, -100.0], [100.0, 100.0, 100.0], 2)
    assert pinches.spots(gauge_of(mesh), *mesh) == []


def test_a_wedge_whose_sides_do_not_face_away_is_not_pinched_across_them():
    turn = np.radians([0.0, 120.0, 240.0])
    ends = [np.stack([55.0 * np.cos(turn), 55.0 * np.sin(turn), np.full(3, z)], axis=1) for z in (-90.0, 90.0)]
    mesh = shapes.loft(ends)
    assert all(abs(pinch.across[2]) > 0.9 for pinch in pinches.spots(gauge_of(mesh), *mesh))


@pytest.mark.parametrize("name", ["tray edge", "toothbrush", "gaming mouse"])
def test_pinches_go_along_with_the_product(name):
    vertices, triangles = shapes.SHAPES[name]()
    vertices, triangles = np.asarray(vertices, float), np.asarray(triangles)
    first = own_pinches(vertices, triangles)
    for seed in range(2):
        turned = vertices @ Rotation.random(random_state=seed).as_matrix().T + [120.0, -40.0, 250.0]
        again = own_pinches(turned, triangles)
        assert len(again) == len(first) > 0
        for one, other in zip(first, again, strict=True):
            assert one.center == pytest.approx(other.center, abs=1e-2)
            assert one.reach == pytest.approx(other.reach, abs=1e-3)
            assert one.digits == other.digits


def own_pinches(vertices, triangles):
    """Pinches in the product's own frame, as the search asks for them."""
    origin, axes = places.own_frame(vertices, triangles)
    local = ((vertices - origin) @ axes).round(6)
    return pinches.spots(gauge_of((local, triangles)), local, triangles)


def test_points_are_spread_by_area_whatever_the_triangles():
    for mesh in (sheet(4.0), shapes.block([-80.0, -55.0, -2.0], [80.0, 55.0, 2.0], 9)):
        points, normals = places.sampled(*mesh, 4000)
        assert (np.abs(normals[:, 2]) > 0.9).mean() == pytest.approx(17600.0 / (17600.0 + 4.0 * 270.0), abs=0.02)
        assert ((points[:, 0] > 0.0) & (points[:, 1] > 0.0)).mean() == pytest.approx(0.25, abs=0.02)


def test_walls_without_vertices_on_their_sides_are_thin():
    vertices, triangles = sheet(3.0)
    product = thenar.Product(vertices, triangles)
    points = places.sampled(vertices, triangles, 500)[0]
    assert walls.gauge_of(product, points, 5.0).is_thin
    thick = shapes.block([-40.0, -40.0, -40.0], [40.0, 40.0, 40.0], 1)
    points = places.sampled(*thick, 500)[0]
    assert not walls.gauge_of(thenar.Product(*thick), points, 5.0).is_thin


def test_depth_in_a_thin_wall_fades_as_the_skin_turns_away():
    """A point 2 mm below the top of a sheet of 3 mm: read from above 2 mm deep, from below 1 mm; no jump between."""
    vertices, triangles = sheet(3.0)
    turns = np.radians(np.arange(0.0, 181.0, 2.0))
    normals = np.stack([np.sin(turns), np.zeros_like(turns), -np.cos(turns)], axis=1)
    points = np.tile([5.0, 3.0, -0.5], (len(turns), 1))
    product = thenar.Product(vertices, triangles)
    plain = walls.Gauge(product, is_thin=True).gaps(points, normals)
    faced = walls.Gauge(product, is_thin=True, is_faced=True).gaps(points, normals)
    assert faced[0] == pytest.approx(plain[0]) and faced[-1] == pytest.approx(plain[-1])
    assert faced[-1] == pytest.approx(-1.0, abs=1e-6)
    assert np.abs(np.diff(faced)).max() < 0.2
    assert faced[45] == pytest.approx(0.0, abs=1e-6), "skin on edge to a wall is in neither side of it"


def test_a_tray_is_held_by_thumb_and_fingertips(blender, scene):
    hand, product = scene(shapes.SHAPES["tray edge"](), turn=(20, 10, 30))
    assert blender.ops.thenar.fit_grasp() == {"FINISHED"}
    before = [np.array(vertex.co) for vertex in hand.data.vertices]
    blender.ops.thenar.solve()
    result = blender.context.scene.thenar.result
    push = np.array(result.force_vector_n)
    assert 20.0 < result.force_n < 40.0, "30 N in sum, 15 N from each side"
    assert np.linalg.norm(push) < 0.12 * result.force_n
    assert result.peak_kpa < 600.0 and result.grade != "DO_NOT_USE"
    carried = {row.name: row.force_n for row in result.regions if row.force_n > 0.01}
    assert "thumb_distal_pad" in carried and not PALM & set(carried)
    assert len(before) == len(hand.data.vertices)


@pytest.mark.parametrize("width", [22.0, 40.0, 60.0, 75.0])
def test_the_hand_opens_for_a_pinch_with_its_thumb_toward_the_fingertips(blender, width):
    blender.ops.thenar.make_hand(percentile=50)
    shown = blender.context.scene.thenar.hand
    hand = fitting.read_hand(blender.context, shown)
    reading.write_angles(shown.parent, hand.rig, hand.joints, pinching.opened(hand, width))
    blender.context.view_layer.update()
    points, triangles = grasping.seen(shown)
    assert anatomy.facing(shown, (points, triangles), "thumb", ("index", "middle"))[0] <= 25.0
    thumb, *fingers = (
        points[anatomy._rows(shown, f"{digit}_distal_pad")].mean(axis=0) for digit in ("thumb", "index", "middle")
    )
    assert np.linalg.norm(thumb - np.mean(fingers, axis=0)) == pytest.approx(width, abs=2.0)


def test_the_kind_is_the_users(blender, scene, bar):
    scene(bar)
    assert blender.ops.thenar.fit_grasp(kind="PINCH") == {"FINISHED"}
    blender.ops.thenar.solve()
    result = blender.context.scene.thenar.result
    carried = {row.name for row in result.regions if row.force_n > 0.01}
    assert not PALM & carried, "a pinch leaves the palm bare"
    assert result.force_n == pytest.approx(30.0, rel=0.25)


def test_a_force_of_the_user_is_the_whole_one_for_a_pinch_too(blender, scene, bar):
    scene(bar)
    assert blender.ops.thenar.fit_grasp(kind="PINCH", force_n=20.0) == {"FINISHED"}
    best = blender.context.scene.thenar_grasps.found[0]
    assert best.total_n == pytest.approx(20.0, rel=0.1)
    assert best.kind == "PINCH"
