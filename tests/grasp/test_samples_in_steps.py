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


@pytest.mark.parametrize(("kind", "is_first_empty"), [("held_bottle", True), ("fingertip_on_plate", False)])
def test_a_sample_is_in_one_scene_whatever_the_window_shows(blender, kind, is_first_empty):
    """The window goes back and forth between two scenes; what a user adds to the other one stays there alone."""
    if not is_first_empty:
        blender.ops.object.empty_add()
    first, other = blender.context.scene, bpy.data.scenes.new("Other")
    run, is_whole = samples.scene_steps(blender.context, kind), False
    work = next(run)
    while not is_whole:
        blender.context.window.scene = other if blender.context.scene != other else first
        try:
            work = steps.hand_back(run, work)
        except StopIteration:
            is_whole = True
    (scene,) = [each for each in bpy.data.scenes if each.thenar.hand is not None]
    assert (scene == first) == is_first_empty and scene != other and not other.objects
    assert len(first.objects) == (len(scene.objects) if is_first_empty else 1)
    made = set(bpy.data.objects) - (set() if is_first_empty else set(first.objects))
    rings = {each for each in made if not each.users_scene}
    assert set(scene.objects) == made - rings
    assert {scene.thenar.hand, scene.thenar.hand.parent, scene.thenar.product, scene.camera} <= set(scene.objects)


def test_a_sample_that_is_ended_gives_the_window_its_view_layer_again(blender):
    blender.ops.object.empty_add()
    window = blender.context.window
    layer = window.scene.view_layers.new("Second")
    window.view_layer = layer
    scene = window.scene
    run = samples.scene_steps(blender.context, "held_bottle")
    steps.hand_back(run, next(run))
    assert window.scene != scene
    run.close()
    assert (window.scene, window.view_layer) == (scene, layer)


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
