"""Refine Skin on a made hand that a wire crosses: felt, sound, skin and nails drawn as before."""

import bpy
import fine_features
import numpy as np
import pytest
import stage
from handles import measuring

LINEAR = ("skin_rest_mm", "skin_tone", "skin_finger", "skin_nail", "skin_lines_mm", "skin_lines_fade")


@pytest.fixture
def crossed():
    return fine_features.crossed_finger()


def test_what_passed_between_vertices_is_felt_and_sound(crossed):
    hand, wire = crossed
    assert stage.solve().force_n == 0.0
    assert fine_features.is_between(bpy.context.scene.thenar.result)
    for _ in range(2):
        fine_features.refine()
    assert 9_600 < len(hand.data.vertices) < 10_400
    before = stage.evaluated(hand)
    result = stage.solve()
    after, shape = stage.evaluated(hand), (stage.evaluated(wire), fine_features.triangles_of(wire))
    depth = measuring.depths(before, *shape)
    assert result.force_n > 0.005 and result.grade != "do not use"
    assert depth.max() > 0.1 and measuring.depths(after, *shape).max() < 0.05
    assert np.linalg.norm(after - before, axis=1).max() < depth.max() + 0.5


def test_shape_regions_and_drawn_skin_stay(crossed):
    hand, _ = crossed
    old = {name: stage.attribute(hand, name) for name in LINEAR}
    points, triangles = fine_features.points_mm(hand), fine_features.triangles_of(hand)
    pads, areas = regions(hand), region_areas(hand)
    edges = np.array([tuple(edge.vertices) for edge in hand.data.edges])
    fine_features.refine()
    count = len(points)
    now = fine_features.points_mm(hand), fine_features.triangles_of(hand)
    assert np.array_equal(now[0][:count], points) and np.array_equal(regions(hand)[:count], pads)
    before = fine_features.area_and_volume(points, triangles)
    assert fine_features.area_and_volume(*now) == pytest.approx(before, rel=1e-6)
    assert set(fine_features.sides_of_edges(hand).values()) == {2}
    middles = points[edges].mean(axis=1)
    parents = [edges[np.linalg.norm(middles - point, axis=1).argmin()] for point in now[0][count:]]
    for name, values in old.items():
        new = stage.attribute(hand, name)
        assert np.array_equal(new[:count], values)
        assert new[count:] == pytest.approx(values[np.array(parents)].mean(axis=1), abs=1e-4)
    for region, area in areas.items():
        assert region_areas(hand)[region] == pytest.approx(area, abs=3.0), region  # mm2: half a triangle's at a border
    bones = [hand.vertex_groups[bone.name].index for bone in hand.parent.data.bones if bone.name in hand.vertex_groups]
    total = np.zeros(len(now[0]))
    for vertex in hand.data.vertices:
        total[vertex.index] = sum(group.weight for group in vertex.groups if group.group in bones)
    assert total == pytest.approx(1.0, abs=1e-3)  # made weights are whole parts of 1/4096
    assert np.abs(total[count:] - total[np.array(parents)].mean(axis=1)).max() < 1e-6


def regions(hand):
    """Index (n,) of the listed group that each vertex has, -1 for none."""
    listed = {hand.vertex_groups[row.name].index: k for k, row in enumerate(hand.thenar.materials)}
    return np.array([next((listed[g.group] for g in v.groups if g.group in listed), -1) for v in hand.data.vertices])


def region_areas(hand):
    """Region -> a third of every triangle at each of its vertices, mm2."""
    points, triangles, of = fine_features.points_mm(hand), fine_features.triangles_of(hand), regions(hand)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    third = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6.0
    return {region: third @ (of[triangles] == region).sum(axis=1) for region in range(len(hand.thenar.materials))}


def test_hand_shape_says_why_it_cannot_change_the_size(crossed):
    hand, _ = crossed
    fine_features.refine()
    count = len(hand.data.vertices)
    hand.thenar_hand.percentile = 80.0
    assert "edited or refined, and a new size would lose that" in hand.thenar_hand.problem
    assert len(hand.data.vertices) == count and hand.thenar_hand.percentile == pytest.approx(50.0)
