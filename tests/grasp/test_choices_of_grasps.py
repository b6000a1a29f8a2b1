"""The grasps found as choices: causes add up to the score, other kinds are added, and one click takes one."""

import json

import numpy as np


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
    assert {"POWER", "PINCH"} <= set(kinds)
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
