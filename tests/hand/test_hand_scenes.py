"""The hand in Blender: making, units, foreign rigs, the fit operator, and samples that solve."""

import numpy as np
import pytest
from hand_scenes import evaluated_mm, with_cylinder
from mathutils.bvhtree import BVHTree
from thenar_blender.grasp import fitting, samples
from thenar_blender.grasp_fit import walls
from thenar_blender.hand import build, pads
from thenar_blender.hand_bones import reading

SAMPLE_KINDS = (
    "fingertip_on_plate", "palm_on_plate", "hand_on_glass", "finger_on_ball", "cylinder_48", "cylinder_60",
    "cylinder_100", "handlebar", "bottle", "held_bottle",
)  # fmt: skip


def test_hand_has_groups_materials_and_a_rig(blender, hand, made):
    mesh, rig = hand
    assert {bone["name"] for bone in made["bones"]} == {bone.name for bone in rig.data.bones}
    listed = [material.name for material in mesh.thenar.materials]
    assert listed == build.group_names(made) and len(listed) == 19
    assert all(name in mesh.vertex_groups for name in listed)
    assert [material.thickness_mm for material in mesh.thenar.materials] == pytest.approx(list(made["thickness_mm"]))
    assert evaluated_mm(mesh) == pytest.approx(made["vertices_mm"], abs=1e-3)


@pytest.mark.parametrize("scale", [1.0, 0.001, 0.01, 0.0254])
def test_hand_is_as_large_in_every_unit(blender, made, scale):
    blender.context.scene.unit_settings.scale_length = scale
    mesh, rig = build.add_hand(blender.context, made)
    arrays, _ = reading.read_rig(blender.context, mesh)
    assert evaluated_mm(mesh) == pytest.approx(made["vertices_mm"], abs=2e-3)
    assert arrays.vertices * (1000.0 * scale) == pytest.approx(made["vertices_mm"], abs=2e-3)


def test_positive_turn_about_x_flexes(blender, hand):
    mesh, rig = hand
    tip = rig.pose.bones["middle_distal"]
    before = np.array(rig.matrix_world @ tip.tail)
    rig.pose.bones["middle_proximal"].rotation_euler = (0.6, 0.0, 0.0)
    blender.context.view_layer.update()
    moved = np.array(rig.matrix_world @ tip.tail) - before
    assert moved[2] > 0.02, "the palm of the made hand faces +Z"


def test_fit_operator_moves_the_hand_only(blender, hand):
    mesh, rig = hand
    product, _ = with_cylinder(blender.context, mesh)
    product.location = (0.4, 0.1, 0.2)
    blender.context.view_layer.update()
    there = product.matrix_world.copy()
    assert blender.ops.thenar.fit_grasp(strength="LIGHT") == {"FINISHED"}
    assert product.matrix_world == there
    near = np.linalg.norm(evaluated_mm(mesh).mean(axis=0) - np.array(there.translation) * 1000.0)
    assert near < 120.0


def test_fit_operator_can_move_the_product(blender, hand):
    mesh, rig = hand
    product, _ = with_cylinder(blender.context, mesh)
    product.location = (0.4, 0.1, 0.2)
    blender.context.view_layer.update()
    there = rig.matrix_world.copy()
    assert blender.ops.thenar.fit_grasp(strength="LIGHT", moves="PRODUCT") == {"FINISHED"}
    assert rig.matrix_world == there
    blender.ops.thenar.solve()
    assert blender.context.scene.thenar.result.force_n == pytest.approx(60.0, rel=0.1)


def test_written_grasp_is_the_fitted_one(blender, hand):
    mesh, rig = hand
    product, job = with_cylinder(blender.context, mesh)
    found = fitting.compute(job)
    fitting.finish(blender.context, job, found, "HAND")
    gap = walls.Gauge(job.product, is_thin=False).gaps(evaluated_mm(mesh))
    for pad in job.hand.pads:
        assert pads.pad_depth(gap[pad.rows]) == pytest.approx(found.depths_mm[pad.name], abs=0.01)


def test_missing_bone_is_named(blender, hand):
    mesh, rig = hand
    with_cylinder(blender.context, mesh)
    rig.thenar_bones.ring_middle = "no such bone"
    with pytest.raises(RuntimeError, match="No bone called 'no such bone' for ring middle"):
        blender.ops.thenar.fit_grasp()


def test_hand_without_regions_gets_pads_from_its_bones(blender, hand):
    mesh, rig = hand
    mesh.thenar.materials.clear()
    found = {pad.role: pad for pad in fitting.read_hand(blender.context, mesh).pads}
    assert {"index_distal", "little_middle", "thumb_distal"} <= set(found)
    assert np.array(mesh.data.vertices[int(found["index_distal"].rows[0])].normal)[2] > -0.5


def test_out_of_reach_is_reported(blender, hand):
    mesh, rig = hand
    product, _ = with_cylinder(blender.context, mesh)
    product.location = (2.0, 0.0, 0.0)
    blender.context.view_layer.update()
    with pytest.raises(RuntimeError, match="reach"):
        blender.ops.thenar.fit_grasp(place="KEEP", moves="FINGERS")


@pytest.mark.parametrize("side", ["left", "right"])
def test_both_hands_grasp(blender, side):
    assert blender.ops.thenar.make_hand(side=side) == {"FINISHED"}
    mesh = blender.context.scene.thenar.hand
    _, job = with_cylinder(blender.context, mesh)
    found = fitting.compute(job)
    misses = [abs(found.depths_mm[name] - want) for name, want in found.targets_mm.items()]
    assert np.median(misses) < 0.5
    assert not found.warnings


def test_added_sample_is_seen_through_its_camera(blender):
    blender.ops.mesh.primitive_cube_add()
    before = blender.context.scene
    assert blender.ops.thenar.add_sample(kind="fingertip_on_plate") == {"FINISHED"}
    window = blender.context.window
    assert window.scene != before and window.scene.camera is not None
    views = [area.spaces.active.region_3d for area in window.screen.areas if area.type == "VIEW_3D"]
    assert views and all(view.view_perspective == "CAMERA" for view in views)


@pytest.mark.parametrize("kind", SAMPLE_KINDS)
def test_sample_is_complete_and_solves(blender, kind):
    assert blender.ops.thenar.add_sample(kind=kind) == {"FINISHED"}
    scene = blender.context.scene
    settings = scene.thenar
    assert scene.camera is not None and scene.unit_settings.length_unit == "MILLIMETERS"
    assert sum(obj.type == "LIGHT" for obj in scene.objects) == 3
    posed = evaluated_mm(settings.hand)
    triangles = np.array([face.vertices for face in settings.hand.data.polygons])
    assert self_crossing(posed, triangles) <= 0.01
    assert blender.ops.thenar.solve() == {"FINISHED"}
    result = settings.result
    assert result.force_n > 0.5 and result.area_mm2 > 50.0 and result.penetration_mm < 0.021
    touching = {region.name for region in result.regions if region.force_n > 0.0}
    if kind.startswith("cylinder"):
        assert len(touching) == 19, "every region touches in the paper's grasps"
        wanted = {"cylinder_48": 337.0, "cylinder_60": 260.0, "cylinder_100": 122.0}[kind]
        assert result.force_n == pytest.approx(wanted, rel=0.05)
    for region, material in zip(result.regions, settings.hand.thenar.materials, strict=True):
        assert region.depth_mm < material.thickness_mm


def test_first_sample_is_good_and_in_balance(blender):
    """What the first card opens: its first solve is graded good, and the hand leaves no force on the bottle."""
    kind = samples.FIRST
    assert blender.ops.thenar.add_sample(kind=kind) == {"FINISHED"}
    settings = blender.context.scene.thenar
    assert settings.product.name == "Bottle" and settings.hand.parent.type == "ARMATURE"
    assert blender.ops.thenar.solve() == {"FINISHED"}
    result = settings.result
    assert result.grade.replace("_", " ").lower() == "good", [text.name for text in result.warnings]
    values = np.empty(len(settings.hand.data.vertices), np.float32)
    settings.hand.data.attributes["contact_force_n"].data.foreach_get("value", values)
    tree = BVHTree.FromPolygons(
        evaluated_mm(settings.product).tolist(), [tuple(face.vertices) for face in settings.product.data.polygons]
    )
    pressed, points = np.flatnonzero(values > 0.0), evaluated_mm(settings.hand)
    push = [-np.array(tree.find_nearest(points[k])[1]) for k in pressed]
    left = np.linalg.norm((values[pressed, None] * push).sum(axis=0))
    assert 50.0 < values.sum() < 70.0 and left < 0.05 * values.sum()


def self_crossing(vertices, triangles):
    """Share of triangles that cut another one with which they share no vertex."""
    tree = BVHTree.FromPolygons(vertices.tolist(), triangles.tolist())
    pairs = np.array([pair for pair in tree.overlap(tree) if pair[0] < pair[1]], int).reshape(-1, 2)
    first, second = triangles[pairs[:, 0]], triangles[pairs[:, 1]]
    apart = ~(first[:, :, None] == second[:, None, :]).any(axis=(1, 2))
    return len(np.unique(pairs[apart])) / len(triangles)


def test_samples_list_is_the_public_one():
    assert tuple(samples.SAMPLES) == SAMPLE_KINDS
