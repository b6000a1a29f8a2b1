"""A press runs in short steps in the window's thread; stopped between any two, it leaves the scene unchanged."""

import bpy
import numpy as np
import pytest
import stage
from thenar_blender import workflow


def subdivided_ball(levels=1, fineness=3):
    hand, product = stage.pad(fineness=fineness), stage.plate()
    settings = bpy.context.scene.thenar
    settings.hand, settings.product = hand, product
    modifier = hand.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = levels
    stage.raise_under(hand, product)
    return hand, product


def run(steps, most=None):
    """Run `steps`, or the first `most` of them. Returns whether they ended."""
    done, value = 0, None
    while most is None or done < most:
        try:
            work = steps.send(value)
        except StopIteration:
            return True
        done += 1
        value = None if work is None else work(None, None)
    return False


def seen(hand, product):
    """All that a press may change, as plain values."""
    attributes = {item.name: stage.attribute(hand, item.name) for item in hand.data.attributes if "thenar" in item.name}
    key = hand.data.shape_keys and hand.data.shape_keys.key_blocks.get("Thenar Contact")
    points = None if key is None else (key.mute, key.value, [tuple(point.co) for point in key.points])
    shown = [(modifier.name, modifier.show_viewport) for modifier in hand.modifiers]
    counts = [len(group) for group in (bpy.data.objects, bpy.data.meshes, bpy.data.node_groups)]
    return stage.evaluated(hand), stage.evaluated(product), attributes, points, shown, counts


def is_same(before, after):
    return (
        np.array_equal(before[0], after[0])
        and np.array_equal(before[1], after[1])
        and before[2].keys() == after[2].keys()
        and all(np.array_equal(values, after[2][name]) for name, values in before[2].items())
        and before[3:] == after[3:]
    )


@pytest.mark.parametrize("is_second", [False, True], ids=["first", "again"])
def test_ended_after_any_step_the_scene_is_as_before(is_second):
    hand, product = subdivided_ball()
    settings = bpy.context.scene.thenar
    settings.use_force, settings.force_n = True, 0.8
    if is_second:
        stage.solve()
        settings.force_n = 1.1
    before = seen(hand, product)
    for most in range(1, 40):
        steps = workflow.steps(bpy.context)
        is_over = run(steps, most)
        if is_over:
            break
        steps.close()
        assert is_same(before, seen(hand, product)), f"after {most} steps"
    assert is_over and most > 10
    assert not is_same(before, seen(hand, product))
