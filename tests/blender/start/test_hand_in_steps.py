"""A hand is made in turns with the window: ended at any of them, the file is as it was before."""

import bpy
import numpy as np
import pytest
import thenar
from thenar_blender import steps
from thenar_blender.hand import operators
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
