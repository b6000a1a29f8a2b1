"""A hand is made in turns with the window: ended at any of them, the file is as it was before."""

import time

import bpy
import numpy as np
import pytest
import test_computing
import thenar
from thenar_blender import status, steps
from thenar_blender.hand import operators
from thenar_blender.operators import computing
from thenar_blender.scene.checks import Refusal

KINDS = ("objects", "meshes", "armatures", "materials", "node_groups", "scenes", "collections", "texts", "images")
SHAPE = {"spacing_mm": 6.0}


def content():
    """Names of everything in the file, the active object and the scene's hand."""
    found = {kind: sorted(each.name for each in getattr(bpy.data, kind)) for kind in KINDS}
    return found | {"active": bpy.context.view_layer.objects.active, "hand": bpy.context.scene.thenar.hand}


def after(turns):
    """The steps of a hand after so many turns, and whether they came to their end."""
    run = operators.hand_steps(bpy.context, SHAPE)
    work = next(run)
    for _ in range(turns):
        try:
            work = steps.hand_back(run, work)
        except StopIteration:
            return run, True
    return run, False


def test_a_hand_that_is_ended_leaves_the_file_as_it_was():
    """At every turn that the window gets; the user's active object is active again."""
    bpy.ops.mesh.primitive_cube_add()
    before, turns = content(), 0
    run, is_whole = after(turns)
    while not is_whole:
        run.close()
        assert content() == before, turns
        turns += 1
        run, is_whole = after(turns)
    assert turns >= 4 and content()["hand"] is not None


class Making(test_computing.Operator):
    """Make Hand as a button starts it; an operator of Blender has no window in these tests."""

    def steps(self, context):
        return operators.hand_steps(bpy.context, SHAPE)


@pytest.fixture
def second_layer():
    """The window shows a second view layer, whose active object the first one leaves out."""
    window, collection = bpy.context.window, bpy.data.collections.new("Left out")
    first, window.view_layer = window.view_layer, window.scene.view_layers.new("Second")
    window.scene.collection.children.link(collection)
    first.layer_collection.children["Left out"].exclude = True
    bpy.ops.object.empty_add()
    active = bpy.context.object
    collection.objects.link(active)
    window.scene.collection.objects.unlink(active)
    bpy.context.view_layer.objects.active = active
    return window.view_layer


context = test_computing.context


@pytest.mark.parametrize("more", [0, 2])
def test_esc_leaves_the_file_as_it_was_in_every_view_layer(second_layer, context, monkeypatch, more):
    """Some turns after the first thing was added; nothing is under way any more."""
    monkeypatch.setattr(computing, "TURN_S", 0.0)
    layers = bpy.context.scene.view_layers
    before, active = content(), [layer.objects.active for layer in layers]
    operator = test_computing.started(Making([]), context)
    while content() == before:
        assert test_computing.turn(operator, context) == {"RUNNING_MODAL"}
        time.sleep(0.01)
    for _ in range(more):
        assert test_computing.turn(operator, context) == {"RUNNING_MODAL"}
    assert test_computing.turn(operator, context, "ESC") == {"CANCELLED"}
    assert content() == before and [layer.objects.active for layer in layers] == active
    assert bpy.context.view_layer == second_layer and not status.run.stage


@pytest.mark.parametrize("turns", [1, 2, 4])
def test_esc_takes_back_nothing_that_others_added(turns):
    """In a second window: an object and its mesh, a scene, another active object."""
    run, _ = after(turns)
    bpy.ops.mesh.primitive_cube_add()
    bpy.data.scenes.new("Own scene")
    mine = content()
    run.close()
    for kind in KINDS:
        assert all(name in mine[kind] for name in content()[kind]), kind
    assert content()["active"] == mine["active"] and "Own scene" in bpy.data.scenes
    assert [each.name for each in bpy.data.objects] == ["Cube"] and [each.name for each in bpy.data.meshes] == ["Cube"]


def test_a_scene_that_goes_takes_the_steps_with_it_and_leaves_nothing_of_them():
    other = bpy.data.scenes.new("Other")
    run, _ = after(2)
    scene, bpy.context.window.scene = bpy.context.scene, other
    bpy.data.scenes.remove(scene)
    with pytest.raises(Refusal, match="scene was removed"):
        next(run)
    assert not bpy.data.objects and bpy.context.scene == other


@pytest.mark.parametrize("turns", [0, 1, 2, 3])
def test_all_of_a_hand_is_in_the_scene_where_it_was_begun(turns):
    """The window shows another scene from a turn on."""
    scene, other = bpy.context.scene, bpy.data.scenes.new("Other")
    run = operators.hand_steps(bpy.context, SHAPE)
    work, hand, turn = next(run), None, 0
    while hand is None:
        bpy.context.window.scene = other if turn >= turns else scene
        try:
            work, turn = steps.hand_back(run, work), turn + 1
        except StopIteration as end:
            hand = end.value
    assert set(scene.collection.objects) == {hand, hand.parent} and not other.objects
    assert scene.thenar.hand == hand and other.thenar.hand is None
    assert bpy.context.scene == other and bpy.context.view_layer.objects.active is None


def test_a_hand_that_nobody_has_is_refused_and_leaves_nothing():
    before = content()
    with pytest.raises(Refusal, match=r"(?i)length"):
        steps.at_once(operators.hand_steps(bpy.context, {"length_mm": 900.0}))
    assert content() == before


def test_the_hand_of_the_button_is_that_of_the_library():
    """Vertices of the scene's mesh against the library's, within single precision; weights add up to one."""
    assert bpy.ops.thenar.make_hand() == {"FINISHED"}
    made, hand = thenar.hand(), bpy.context.scene.thenar.hand
    stored = np.empty(3 * len(hand.data.vertices), np.float32)
    hand.data.vertices.foreach_get("co", stored)
    assert 1e3 * stored.reshape(-1, 3) == pytest.approx(np.asarray(made["vertices_mm"]), abs=1e-3)
    bones = hand.parent.data.bones
    for row in range(0, len(hand.data.vertices), 97):
        shares = {hand.vertex_groups[each.group].name: each.weight for each in hand.data.vertices[row].groups}
        shares = {name: share for name, share in shares.items() if name in bones}
        wanted = dict(zip((bone["name"] for bone in made["bones"]), np.asarray(made["weights"])[row], strict=True))
        assert shares.keys() <= wanted.keys()
        for name, share in wanted.items():
            assert shares.get(name, 0.0) == pytest.approx(share, abs=1.5 / 4096.0), (row, name)


def test_a_made_hand_is_one_step_of_undo():
    bpy.context.preferences.edit.use_global_undo = True
    bpy.ops.ed.undo_push(message="before")
    before = content()
    assert bpy.ops.thenar.make_hand(**SHAPE) == {"FINISHED"}
    bpy.ops.ed.undo_push(message="Make Hand")  # as the window does after an operator with UNDO
    bpy.ops.ed.undo()
    assert content() == before
