"""A sample is added in turns with the window: ended at any of them, the file is as it was before."""

import bpy
import numpy as np
import pytest
from thenar_blender import steps
from thenar_blender.grasp import samples

KINDS = ("objects", "meshes", "armatures", "materials", "cameras", "lights", "worlds", "scenes", "collections")


def content():
    """Names of everything in the file, and the unit that the scene shows."""
    unit = bpy.context.scene.unit_settings
    found = {kind: sorted(each.name for each in getattr(bpy.data, kind)) for kind in KINDS}
    return found | {"unit": (unit.system, unit.length_unit, unit.scale_length), "scene": bpy.context.scene.name}


@pytest.mark.parametrize("kind", ["held_bottle", "cylinder_60", "fingertip_on_plate"])
def test_a_sample_that_is_ended_leaves_the_file_as_it_was(blender, kind):
    """At every turn that the window gets; the last one is the whole sample."""
    blender.context.scene.unit_settings.system = "IMPERIAL"
    before, turns = content(), 0
    while True:
        run, is_whole = samples.scene_steps(blender.context, kind), False
        work = next(run)
        for _ in range(turns):
            try:
                work = steps.hand_back(run, work)
            except StopIteration:
                is_whole = True
                break
        if is_whole:
            break
        run.close()
        assert content() == before, turns
        turns += 1
    assert turns >= 2 and blender.context.scene.thenar.hand is not None
    assert content() != before


def test_a_sample_that_fails_on_the_way_leaves_the_file_as_it_was(blender):
    before = content()
    run = samples.scene_steps(blender.context, "cylinder_60")
    steps.hand_back(run, next(run))
    assert content() != before, "the hand is there by now"
    with pytest.raises(RuntimeError, match="no memory"):
        run.throw(RuntimeError("no memory"))
    assert content() == before


def test_in_steps_and_at_once_are_the_same_sample(blender):
    seen = []
    for add in (
        lambda: samples.add_sample(bpy.context, "held_bottle"),
        lambda: bpy.ops.thenar.add_sample(kind="held_bottle"),
    ):
        blender.ops.wm.read_factory_settings(use_empty=True)
        add()
        settings = bpy.context.scene.thenar
        bpy.context.view_layer.update()
        places = [np.array(obj.matrix_world) for obj in (settings.hand, settings.product)]
        seen.append((*places, [np.array(bone.matrix) for bone in settings.hand.parent.pose.bones]))
    for first, second in zip(*seen, strict=True):
        assert np.array_equal(first, second)
