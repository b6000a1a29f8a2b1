"""A product that passes between vertices is felt after Refine Skin, as by skin that is fine everywhere."""

import bpy
import fine_features
import numpy as np
import pytest
import stage
from handles import measuring

WIRE, CARD = "wire", "card"
MADE = {
    WIRE: lambda place: fine_features.wire(place, radius=0.5, sunk=0.4),
    CARD: lambda place: fine_features.blade(place, thickness=0.8, sunk=0.5),
}


def scene(kind, uniform=0):
    """A ball and a product between its vertices; `uniform`: how often all its triangles are quartered. The hand."""
    bpy.ops.wm.read_homefile(use_empty=True)
    hand = fine_features.ball()
    points, triangles = fine_features.points_mm(hand), fine_features.triangles_of(hand)
    MADE[kind](fine_features.gap_place(points, triangles))
    if uniform:
        fine_features.replaced(hand, *fine_features.quartered(points, triangles, uniform))
    return hand


@pytest.mark.parametrize("kind", [WIRE, CARD])
def test_what_touched_nothing_is_felt_as_by_skin_that_is_fine_everywhere(kind):
    scene(kind)
    result = stage.solve()
    assert result.force_n == 0.0 and fine_features.is_between(result)
    for presses, share in ((1, 0.05), (2, 0.02)):
        hand = scene(kind)
        fine_features.refine(presses)
        found = stage.solve().force_n
        assert len(hand.data.vertices) < 3 * 162
        scene(kind, uniform=presses)
        assert found == pytest.approx(stage.solve().force_n, rel=share)
    assert found > 0.05


def test_each_press_halves_the_spacing_until_a_sentence_ends_it():
    hand = scene(WIRE)
    spacing = []
    with pytest.raises(RuntimeError, match=r"already as fine as 'Wire' needs|as fine as may be"):
        for _ in range(8):
            fine_features.refine()
            points, triangles = fine_features.points_mm(hand), fine_features.triangles_of(hand)
            corners = points[triangles]
            foot = fine_features.gap_place(*_ball())[0]
            near = np.linalg.norm(corners.mean(axis=1) - foot, axis=1) < 0.8
            spacing.append(np.median(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)[near]))
    assert len(spacing) == 3
    assert np.divide(spacing[:-1], spacing[1:]) == pytest.approx(2.0, abs=0.3)
    lengths = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    assert lengths.min() > 0.25


def _ball():
    """The ball before anything was refined."""
    ball = stage.pad("Other", fine_features.RADIUS, 3)
    out = fine_features.points_mm(ball), fine_features.triangles_of(ball)
    bpy.data.objects.remove(ball)
    return out


def test_a_spacing_that_is_given_is_kept_wherever_the_product_is_close():
    hand = scene(WIRE)
    fine_features.refine(spacing_mm=0.8)
    points, triangles = fine_features.points_mm(hand), fine_features.triangles_of(hand)
    product = bpy.context.scene.thenar.product
    shape = fine_features.points_mm(product), fine_features.triangles_of(product)
    away = measuring.distances(points[triangles].mean(axis=1), *shape)[0]
    corners = points[triangles]
    lengths = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    assert lengths[away < 0.9].max() <= 0.8 and lengths[away > 6.0].min() > 1.9


def test_the_solve_after_it_is_sound():
    """No vertex of the shown skin is left in the product, and none moved farther than it lay deep, by other code."""
    hand = scene(WIRE)
    fine_features.refine(3)
    before = stage.evaluated(hand)
    result = stage.solve()
    after, product = stage.evaluated(hand), bpy.context.scene.thenar.product
    shape = stage.evaluated(product), fine_features.triangles_of(product)
    depth = measuring.depths(before, *shape)
    assert depth.max() > 0.2 and measuring.depths(after, *shape).max() < 0.05
    moved = np.linalg.norm(after - before, axis=1)
    assert moved.max() < depth.max() + 0.5
    pressure = stage.attribute(hand, "pressure_kpa")
    assert result.grade == "good" and (pressure > 0).sum() >= 12
    assert depth[pressure > 0].min() > 0.0


def test_a_contact_elsewhere_keeps_its_force():
    """A plate under the ball is pressed as before when the skin at a wire on top of it is refined."""
    forces = []
    for presses in (0, 2):
        bpy.ops.wm.read_homefile(use_empty=True)
        hand, plate = stage.scene(top=-6.8)
        points, triangles = fine_features.points_mm(hand), fine_features.triangles_of(hand)
        foot, way, out = fine_features.gap_place(points, triangles[points[triangles].mean(axis=1)[:, 2] > 7.0])
        wire, _ = fine_features.wire((foot, way, out), radius=0.3, sunk=0.3)
        parts = bpy.data.collections.new("Parts")
        parts.objects.link(plate)
        parts.objects.link(wire)
        settings = bpy.context.scene.thenar
        settings.product, settings.product_collection = None, parts
        if presses:
            fine_features.refine(presses)
        stage.solve()
        low = stage.evaluated(hand)[:, 2] < 0.0
        assert low[len(points) :].sum() == 0
        force = stage.attribute(hand, "contact_force_n")
        forces.append(force[low].sum())
    assert forces[0] > 0.5 and forces[1] == pytest.approx(forces[0], rel=0.02)
    assert force[~low].sum() > 0.0


def test_a_product_that_a_force_target_has_moved_is_read_at_its_present_place():
    """A bar 3 mm off is pressed on by a force target; the skin under its place in the contact is refined."""
    hand = fine_features.ball()
    points, triangles = fine_features.points_mm(hand), fine_features.triangles_of(hand)
    foot, way, out = fine_features.gap_place(points, triangles)
    fine_features.wire((foot, way, out), radius=1.5, sunk=-3.0)
    with pytest.raises(RuntimeError, match="No skin of 'Pad' comes within 1 mm of 'Wire'"):
        fine_features.refine()
    settings = bpy.context.scene.thenar
    settings.use_force, settings.force_n, settings.direction_mode = True, 0.1, "OWN"
    settings.direction = -out
    assert stage.solve().reason_kind == "few_vertices"
    fine_features.refine(1)
    new = fine_features.points_mm(hand)[len(points) :]
    assert len(new) > 20 and np.linalg.norm(new - foot, axis=1).max() < 10.0
    assert not settings.product.thenar.is_moved
    assert abs(np.dot(stage.solve().force_vector_n, out)) == pytest.approx(0.1, rel=0.02)


def test_a_contact_that_is_on_the_hand_changes_nothing_of_it():
    """The skin is refined where it is before the contact: after a solve as without one."""
    found = []
    for solves in (False, True):
        hand = scene(WIRE)
        fine_features.refine()
        if solves:
            assert stage.solve().force_n > 0.0 and hand.data.shape_keys is not None
        fine_features.refine()
        found.append(fine_features.points_mm(hand))
    assert np.array_equal(*found)


def test_a_round_is_refined_until_its_radius_is_two_edges():
    """A bar of 2 mm radius, 0.4 mm deep: edges of 1.2 mm are too long, those of 0.6 mm are not."""
    bpy.ops.wm.read_homefile(use_empty=True)
    hand = stage.pad(radius=16.0, fineness=5)
    bpy.context.scene.thenar.hand = hand
    place = fine_features.gap_place(fine_features.points_mm(hand), fine_features.triangles_of(hand))
    fine_features.wire(place, radius=2.0, sunk=0.4)
    assert stage.solve().reason_kind != "few_vertices"
    fine_features.refine()
    with pytest.raises(RuntimeError, match="already as fine as 'Wire' needs"):
        fine_features.refine()


def test_the_skin_is_prepared_again():
    """The second solve presses the new vertices: its arrays are as long as the new mesh."""
    hand = scene(WIRE)
    stage.solve()
    fine_features.refine()
    assert not bpy.context.scene.thenar.result.is_valid
    assert "pressure_kpa" not in hand.data.attributes and hand.data.shape_keys is None
    result = stage.solve()
    assert result.vertices == len(hand.data.vertices) > 162
    assert (stage.attribute(hand, "pressure_kpa")[162:] > 0).any()
