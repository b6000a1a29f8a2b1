"""The buttons of the cards do their whole step; what cannot act yet says why."""

import bpy
import product_files as files
import pytest
import stage
from thenar_blender.panels import main


def test_a_product_in_mm_gets_a_hand_and_keeps_its_place_in_the_settings(tmp_path):
    path = tmp_path / "handle.stl"
    path.write_bytes(files.stl())
    assert bpy.ops.thenar.add_product(filepath=str(path)) == {"FINISHED"}
    product = bpy.context.scene.thenar.product
    bpy.ops.thenar.scale_product(factor=1e-3)
    assert bpy.ops.thenar.make_hand(spacing_mm=6.0) == {"FINISHED"}
    settings = bpy.context.scene.thenar
    assert settings.product == product and settings.hand.type == "MESH"
    assert bpy.ops.thenar.fit_grasp.poll() and bpy.ops.thenar.solve.poll()


def test_the_mesh_of_the_active_armature_is_the_hand():
    hand, plate = stage.pad(), stage.plate()
    stage.bend(hand)
    small = stage.pad("Nail", fineness=1)
    small.modifiers.new("Armature", "ARMATURE").object = bpy.data.objects["Rig"]
    bpy.context.view_layer.objects.active = bpy.data.objects["Rig"]
    assert bpy.ops.thenar.pick_hand() == {"FINISHED"}
    assert bpy.context.scene.thenar.hand == hand
    bpy.context.view_layer.objects.active = plate
    bpy.context.scene.thenar.product = plate
    assert bpy.ops.thenar.pick_hand() == {"FINISHED"}
    assert bpy.context.scene.thenar.hand == plate and bpy.context.scene.thenar.product is None


def test_a_hand_that_was_posed_is_not_asked_to_grasp():
    hand, _ = stage.scene()
    stage.bend(hand)
    assert main._is_posed(hand)
    for bone in bpy.data.objects["Rig"].pose.bones:
        bone.rotation_euler = (0.0, 0.0, 0.0)
    bpy.context.view_layer.update()
    assert not main._is_posed(hand)


@pytest.mark.parametrize("kind", ["EMPTY", "ARMATURE", None])
def test_what_is_no_hand_cannot_be_picked(kind):
    if kind == "ARMATURE":
        bpy.ops.object.armature_add()
    elif kind:
        bpy.ops.object.empty_add()
    assert not bpy.ops.thenar.pick_hand.poll()
    with pytest.raises(RuntimeError, match="hand's mesh or its armature"):
        bpy.ops.thenar.pick_hand()
