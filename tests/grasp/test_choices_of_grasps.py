"""The grasps found as choices: causes add up to the score, other kinds are added, and one click takes one; lateral
grips and hooks, by what of the hand bears."""

import json

import numpy as np
import pytest
from handles import grasping, shapes
from thenar_blender import names
from thenar_blender.grasp_choices import more

KEY_MM = [-30.0, -12.0, -1.25], [30.0, 12.0, 1.25]


def angles(context):
    """Pose of every bone and place of the armature."""
    rig = context.scene.thenar.hand.parent
    return np.concatenate([np.array(rig.matrix_world).ravel(), *(np.array(b.matrix).ravel() for b in rig.pose.bones)])


def causes(row):
    return json.loads(row.facts)["counted"]


def test_other_kinds_are_added_and_taken_by_a_click(scene, bar, blender):
    scene(bar)
    context = blender.context
    assert blender.ops.thenar.fit_grasp(strength="FIRM") == {"FINISHED"}
    stored = context.scene.thenar_grasps
    best = stored.found[0]
    # What the best one's thumb counts is taken off all scores.
    explained = sum(causes(best).values()) - causes(best)["thumb"]
    assert abs(explained - best.score) < 1e-3, "causes explain a grasp's score"
    assert all(len(row.picture) > 500 for row in stored.found)
    first, pose = stored.found[0].pose, angles(context)
    assert blender.ops.thenar.more_grasps() == {"FINISHED"}
    assert (angles(context) == pose).all(), "the hand stays as it is"
    assert stored.found[0].pose == first and stored.shown == 0
    kinds = [row.kind for row in stored.found]
    assert {"POWER", "PINCH", "HOOK"} <= set(kinds)
    assert len({row.picture for row in stored.found}) > len(set(kinds)) - 1, "pictures differ"
    scores = [row.score for row in stored.found][1:]
    assert scores == sorted(scores)
    index = kinds.index("PINCH")
    assert blender.ops.thenar.use_grasp(index=index) == {"FINISHED"}
    assert stored.shown == index and np.abs(angles(context) - pose).max() > 0.01
    assert blender.ops.thenar.more_grasps() == {"FINISHED"}
    assert [row.kind for row in stored.found].count("PINCH") == 1, "a kind that was found is not sought again"


def test_without_a_grasp_there_is_nothing_to_add_to(scene, bar, blender):
    scene(bar)
    assert not blender.ops.thenar.more_grasps.poll()


def carried(result):
    """Force by region, N, of regions that bear any."""
    return {row.name: row.force_n for row in result.regions if row.force_n > 0.01}


def pressed(hand):
    """Numbers of the pressed vertices of a solved hand (n,), and their pressure."""
    pressure = np.array([each.value for each in hand.data.attributes[names.PRESSURE_KPA].data])
    return np.flatnonzero(pressure > 0.0), pressure[pressure > 0.0]


def toward_thumb(hand, digit):
    """Cosine between the way in which the pressed skin of a digit faces and the way to the thumb's side, at rest."""
    rows, weight = pressed(hand)
    groups = {hand.vertex_groups[f"{digit}_{part}_pad"].index for part in ("distal", "middle")}
    own = np.array([any(group.group in groups for group in hand.data.vertices[row].groups) for row in rows])
    facing = np.average([np.array(hand.data.vertices[row].normal) for row in rows[own]], axis=0, weights=weight[own])
    bones = hand.parent.data.bones
    along = np.array(bones[f"{digit}_middle"].vector.normalized())
    way = np.array(bones["index_proximal"].head_local - bones["little_proximal"].head_local)
    way -= along * (way @ along)
    return float(facing @ way / np.linalg.norm(facing) / np.linalg.norm(way))


@pytest.mark.parametrize("side", ["right", "left"])
def test_a_key_is_held_by_the_thumb_against_the_side_of_the_index_finger(scene, blender, side):
    blender.ops.thenar.make_hand(side=side)
    product = grasping._add(shapes.block(*KEY_MM, 3), (20, -30, 40))
    blender.context.scene.thenar.product = product
    assert blender.ops.thenar.fit_grasp(kind="LATERAL") == {"FINISHED"}
    assert blender.context.scene.thenar_grasps.found[0].kind == "LATERAL"
    blender.ops.thenar.solve()
    result = blender.context.scene.thenar.result
    force = carried(result)
    assert result.force_n == pytest.approx(30.0, rel=0.1)
    assert np.linalg.norm(result.force_vector_n) < 0.05 * result.force_n
    thumb = sum(value for name, value in force.items() if name.startswith("thumb"))
    index = sum(value for name, value in force.items() if name.startswith("index"))
    assert thumb > 0.4 * result.force_n and index > 0.4 * result.force_n
    assert toward_thumb(blender.context.scene.thenar.hand, "index") > 0.5


def test_a_bar_in_a_power_grip_lies_on_the_fingers_palm_side(scene, blender):
    hand, _ = scene(shapes.revolved(np.array([0.0, 20.0, 20.0, 0.0]), np.array([-80.0, -80.0, 80.0, 80.0]), 48))
    assert blender.ops.thenar.fit_grasp() == {"FINISHED"}
    blender.ops.thenar.solve()
    assert abs(toward_thumb(hand, "index")) < 0.45, "the measure of the test above tells the sides of a finger"


def test_what_the_thumb_cannot_span_is_refused_for_a_lateral_grip(scene, blender):
    scene(shapes.block([-60.0, -60.0, -25.0], [60.0, 60.0, 25.0], 2))
    with pytest.raises(RuntimeError, match="No two sides of the product can be pinched"):
        blender.ops.thenar.fit_grasp(kind="LATERAL")


def ring(radius, thickness):
    """A ring about z: vertices (n, 3), mm, and triangles (m, 3)."""
    turn, around = np.meshgrid(*(np.linspace(0.0, 2.0 * np.pi, n, endpoint=False) for n in (72, 28)), indexing="ij")
    off = radius + 0.5 * thickness * np.cos(around)
    points = np.stack([off * np.cos(turn), off * np.sin(turn), 0.5 * thickness * np.sin(around)], axis=-1)
    at = np.arange(72 * 28).reshape(72, 28)
    after, both = np.roll(at, -1, 0), np.roll(np.roll(at, -1, 0), -1, 1)
    first, second = np.stack([at, after, both], -1), np.stack([at, both, np.roll(at, -1, 1)], -1)
    return points.reshape(-1, 3), np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)])


@pytest.mark.parametrize(("strength", "weight"), [("FIRM", 100.0), ("LIGHT", 30.0)])
def test_a_ring_hangs_in_four_fingers_below_them(scene, blender, strength, weight):
    hand, product = scene(ring(70.0, 22.0), turn=(10, 40, 0), shift=(0.2, 0.1, -0.3))
    assert blender.ops.thenar.fit_grasp(kind="HOOK", strength=strength) == {"FINISHED"}
    assert blender.context.scene.thenar_grasps.found[0].kind == "HOOK"
    blender.ops.thenar.solve()
    result = blender.context.scene.thenar.result
    push = np.array(result.force_vector_n)
    assert np.linalg.norm(push) == pytest.approx(weight, rel=0.05), "the fingers bear the weight"
    assert {name.partition("_")[0] for name in carried(result)} == {"index", "middle", "ring", "little"}
    up = grasping.seen(hand)[0][pressed(hand)[0]].mean(axis=0) - 1000.0 * np.array(product.matrix_world.translation)
    assert push @ up > 0.8 * np.linalg.norm(push) * np.linalg.norm(up), "the middle of the ring is below the fingers"


def test_a_hook_without_fingers_is_refused(scene, blender, bar):
    scene(bar)
    with pytest.raises(RuntimeError, match="A hook takes the last and middle pads"):
        blender.ops.thenar.fit_grasp(kind="HOOK", digits={"thumb", "palm"})


def test_a_hook_far_from_the_middle_is_not_said_to_balance(scene, blender):
    """A bar of 600 mm, marked 200 mm off its middle: 100 N there have 20 N m about the middle, which tip it."""
    vertices, triangles = shapes.revolved(
        np.array([0.0, 13.0, 13.0, 0.0]), np.array([-500.0, -500.0, 100.0, 100.0]), 32
    )
    scene((vertices, triangles))
    try:
        blender.ops.thenar.fit_grasp(kind="HOOK")
    except RuntimeError as refused:
        assert "No way to hold" in str(refused)
        return
    best = blender.context.scene.thenar_grasps.found[0]
    assert best.friction > 0.38


def test_other_kinds_are_sought_as_strong_as_the_first():
    assert more._strength("HOOK", 30.0) == "LIGHT" and more._strength("HOOK", 100.0) == "FIRM"
    assert more._strength("PINCH", 9.0) == "LIGHT" and more._strength("LATERAL", 30.0) == "FIRM"
    assert more._strength("POWER", 60.0) == "LIGHT" and more._strength("POWER", None) == "FIRM"
