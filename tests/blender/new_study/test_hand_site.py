"""The place of a new study on the hand: clicked or by region, written as the hand is at rest, found there again."""

import tomllib
from types import SimpleNamespace

import bpy
import laboratory
import numpy as np
import pytest
import thenar
from mathutils import Vector
from mathutils.bvhtree import BVHTree
from thenar_blender.new_study import drafting, operators
from thenar_blender.scene import matching, read
from thenar_blender.scene.checks import Refusal


@pytest.fixture
def draft(tmp_path):
    """A made hand, and a draft of two presses."""
    bpy.ops.thenar.make_hand()
    for number in (1, 2):
        laboratory.write(tmp_path / f"p{number}.csv", laboratory.press(number))
    bpy.ops.thenar.new_study(directory=f"{tmp_path}/", files=[{"name": "p1.csv"}, {"name": "p2.csv"}])
    state = bpy.context.scene.thenar_new_study
    state.protocols[0].diameter_mm = 12.0
    assert state.skin == "HAND"
    return state


def hand():
    return bpy.context.scene.thenar.hand


def site(folder):
    written = tomllib.loads((folder / "study.toml").read_text())
    (found,) = written["sites"].values()
    return np.array(found["point_mm"]), np.array(found["direction"])


def test_without_a_place_the_study_is_not_written(draft):
    assert "where on the hand" in drafting.problem(bpy.context).lower()
    assert not bpy.ops.thenar.write_study.poll()


@pytest.mark.parametrize("pose", ["rest", "relaxed"])
def test_a_click_on_the_skin_is_the_study_s_site(draft, tmp_path, pose):
    """A ray is sent at a vertex of a fingertip as it is posed; the study has that vertex as it is at rest."""
    if pose != "rest":
        bpy.ops.thenar.apply_pose(name=pose)
    group = next(each.name for each in hand().thenar.materials if "index" in each.name.lower())
    index = hand().vertex_groups[group].index
    members = [v.index for v in hand().data.vertices if any(g.group == index and g.weight > 0.5 for g in v.groups)]
    depsgraph = bpy.context.evaluated_depsgraph_get()
    shown = hand().evaluated_get(depsgraph).to_mesh()
    wanted = members[len(members) // 2]
    place = hand().matrix_world @ shown.vertices[wanted].co
    outward = hand().matrix_world.to_3x3() @ shown.vertices[wanted].normal
    hand().evaluated_get(depsgraph).to_mesh_clear()
    operators.take_site(bpy.context, place + 0.002 * outward, -outward)
    assert draft.site_vertex == wanted
    assert bpy.ops.thenar.write_study() == {"FINISHED"}
    point, direction = site(tmp_path)
    rest = read.rest_mm(bpy.context, hand())
    np.testing.assert_allclose(point, rest[wanted], atol=1e-4)
    assert np.linalg.norm(direction) == pytest.approx(1.0, abs=1e-5)
    study = thenar.Study.load(tmp_path)
    match = matching.on_scene_hand(bpy.context, np.asarray(study.skin.vertices_mm))
    assert match is not None
    np.testing.assert_allclose(match.point_mm(point), rest[wanted], atol=1e-4)


def test_the_tool_travels_into_the_skin(draft, tmp_path):
    """Just before the site no skin is in the way of the tool, and behind it the ray leaves the finger again."""
    draft.site_region = next(each.name for each in hand().thenar.materials if "distal" in each.name.lower())
    assert bpy.ops.thenar.write_study() == {"FINISHED"}
    point, direction = site(tmp_path)
    rest = read.rest_mm(bpy.context, hand())
    faces = [list(face.vertices) for face in hand().data.polygons]
    tree = BVHTree.FromPolygons([Vector(each) for each in rest], faces)
    start = Vector(point - 10.0 * direction)
    hits = []
    while (hit := tree.ray_cast(start, Vector(direction), 60.0))[0] is not None and len(hits) < 9:
        hits.append((np.array(hit[0]), float(np.array(hit[1]) @ direction)))
        start = hit[0] + 1e-3 * Vector(direction)
    entering = [where for where, cosine in hits if cosine < 0.0]
    assert np.linalg.norm(entering[0] - point) < 1.0
    assert any(cosine > 0.0 and (where - point) @ direction > 3.0 for where, cosine in hits)


def test_a_piece_of_one_digit_is_written_with_its_tissue(draft, tmp_path):
    region = next(each for each in hand().thenar.materials if "distal" in each.name.lower())
    draft.site_region = region.name
    bpy.ops.thenar.write_study()
    study = thenar.Study.load(tmp_path)
    point, _ = site(tmp_path)
    vertices = np.asarray(study.skin.vertices_mm)
    assert np.linalg.norm(vertices - point, axis=1).max() <= 30.01
    assert 200 < len(vertices) < len(hand().data.vertices)
    materials = tomllib.loads((tmp_path / "study.toml").read_text())["skin"]["materials"]
    assert materials[region.name]["g0_mpa"] == pytest.approx(region.g0_kpa / 1e3, rel=1e-5)
    assert materials[region.name]["thickness_mm"] == pytest.approx(region.thickness_mm, rel=1e-5)


@pytest.mark.parametrize("shape", ["PLANE", "CYLINDER"])
def test_plate_and_cylinder_press_a_hand(draft, tmp_path, shape):
    draft.site_region = next(each.name for each in hand().thenar.materials if "distal" in each.name.lower())
    draft.protocols[0].shape, draft.protocols[0].turn_deg = shape, 30.0
    assert bpy.ops.thenar.write_study() == {"FINISHED"}
    (tool,) = tomllib.loads((tmp_path / "study.toml").read_text())["indenters"].values()
    _, direction = site(tmp_path)
    if shape == "CYLINDER":
        assert abs(np.array(tool["axis"]) @ direction) < 1e-5
        assert tool["radius_mm"] == 6.0
    else:
        assert tool == {"shape": "plane"}


def test_skin_of_no_region_has_no_tissue_and_is_refused(draft, tmp_path):
    """The nail's side is in no region: neither a click nor a number takes it for the site."""
    bare = next(v for v in hand().data.vertices if all(g.weight < 1e-4 for g in regions_of(v)))
    place, outward = hand().matrix_world @ bare.co, hand().matrix_world.to_3x3() @ bare.normal
    with pytest.raises(Refusal, match="belongs to no region"):
        operators.take_site(bpy.context, place + 0.002 * outward, -outward)
    assert draft.site_vertex == -1
    draft.site_vertex = bare.index
    with pytest.raises(RuntimeError, match="belongs to no region"):
        bpy.ops.thenar.write_study()
    assert not (tmp_path / "study.toml").exists()


def regions_of(vertex):
    """The vertex's groups that are regions."""
    listed = {hand().vertex_groups[each.name].index for each in hand().thenar.materials}
    return [each for each in vertex.groups if each.group in listed]


def test_a_click_off_the_hand_and_a_hand_that_changed_are_refused(draft):
    with pytest.raises(Refusal, match="that is not on"):
        operators.take_site(bpy.context, Vector((9.0, 9.0, 9.0)), Vector((0.0, 0.0, 1.0)))
    draft.site_vertex = len(hand().data.vertices)
    assert "was changed since" in drafting.problem(bpy.context)


def test_a_place_on_another_hand_is_no_place_on_this_one(draft):
    draft.site_vertex = 5
    assert drafting.problem(bpy.context) == ""
    clicked = hand()
    other = clicked.copy()
    other.data = clicked.data.copy()
    bpy.context.collection.objects.link(other)
    bpy.context.scene.thenar.hand = other
    assert "clicked on another hand" in drafting.problem(bpy.context)
    assert not bpy.ops.thenar.write_study.poll()
    bpy.context.scene.thenar.hand = clicked
    assert drafting.problem(bpy.context) == ""


def test_a_hand_with_more_vertices_than_when_it_was_clicked_is_another(draft):
    draft.site_vertex = 5
    hand().data.vertices.add(1)
    assert "was changed since the place was clicked" in drafting.problem(bpy.context)


@pytest.mark.parametrize("gone", ["hand", "hand in the scene", "draft"])
def test_a_click_without_hand_or_draft_ends_picking_with_the_reason(draft, monkeypatch, gone):
    """The modal's click, with a ray that would meet the hand."""
    for name in ("region_2d_to_origin_3d", "region_2d_to_vector_3d"):
        monkeypatch.setattr(operators, name, lambda *_: Vector((0.0, 0.0, 1.0)))
    if gone == "hand":
        bpy.data.objects.remove(hand())
    elif gone == "hand in the scene":
        bpy.context.collection.objects.unlink(hand())
    else:
        bpy.ops.thenar.discard_study()
    said = []
    window = SimpleNamespace(type="WINDOW", x=0, y=0, width=9, height=9)
    area = SimpleNamespace(regions=[window], tag_redraw=lambda: None)
    context = SimpleNamespace(
        scene=bpy.context.scene,
        view_layer=bpy.context.view_layer,
        area=area,
        space_data=SimpleNamespace(region_3d=None),
        workspace=SimpleNamespace(status_text_set=lambda text: None),
        evaluated_depsgraph_get=bpy.context.evaluated_depsgraph_get,
    )
    picking = SimpleNamespace(
        report=lambda level, text: said.append(text),
        _end=lambda context, result: result,
        bl_idname="thenar.pick_site",
    )
    click = SimpleNamespace(type="LEFTMOUSE", value="PRESS", mouse_x=4, mouse_y=4)
    assert operators.THENAR_OT_pick_site.modal(picking, context, click) == {"CANCELLED"}
    assert ("No study is being made" if gone == "draft" else "The hand is not in the scene") in said[0]
    assert draft.site_vertex == -1


def test_undo_brings_a_discarded_draft_back(draft, tmp_path):
    draft.site_region = hand().thenar.materials[0].name
    bpy.ops.ed.undo_push(message="draft")
    bpy.ops.thenar.discard_study()
    bpy.ops.ed.undo_push(message="discarded")
    assert not bpy.context.scene.thenar_new_study.is_open
    bpy.ops.ed.undo()
    state = bpy.context.scene.thenar_new_study
    assert state.is_open and len(state.files) == 2 and state.protocols[0].diameter_mm == 12.0
