"""The written shape key moves the evaluated hand by the solved displacement, under every usual stack."""

import bpy
import numpy as np
import pytest
import stage
from mathutils import Euler, Matrix


def lattice(hand):
    data = bpy.data.lattices.new("Lattice")
    data.points_u = data.points_v = data.points_w = 3
    cage = bpy.data.objects.new("Lattice", data)
    cage.scale = (0.02, 0.02, 0.02)
    bpy.context.scene.collection.objects.link(cage)
    for index, point in enumerate(data.points):
        point.co_deform.x += 0.1 * np.sin(index)
        point.co_deform.z += 0.08 * np.cos(2 * index)
    hand.modifiers.new("Lattice", "LATTICE").object = cage


def other_key(hand):
    hand.shape_key_add(name="Basis")
    key = hand.shape_key_add(name="Fat")
    for point, vertex in zip(key.data, hand.data.vertices, strict=True):
        point.co = vertex.co * 1.1
    key.value = 0.5


def shear(hand):
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.scale = (1.0, 1.5, 0.8)
    hand.parent, hand.rotation_euler = parent, (0.5, 0.3, 0.2)


def turned(hand):
    hand.matrix_world = Matrix.Translation((0.1, 0.2, 0.3)) @ Euler((1, 2, 3)).to_matrix().to_4x4()


def modifier(kind, **values):
    def add(hand):
        made = hand.modifiers.new(kind.title(), kind)
        for name, value in values.items():
            setattr(made, name, value)

    return add


def scaled(*factors):
    def scale(hand):
        hand.scale = factors

    return scale


STACKS = {
    "plain": lambda hand: None,
    "armature": stage.bend,
    "dual quaternion": lambda hand: stage.bend(hand, volume=True),
    "lattice": lattice,
    "key at 0.5": other_key,
    "armature and key": lambda hand: (other_key(hand), stage.bend(hand)),
    "scale": scaled(1.3, 0.9, 1.1),
    "negative scale": scaled(-1.0, 1.0, 1.0),
    "shear": shear,
    "turned": turned,
    "simple deform": modifier("SIMPLE_DEFORM", deform_method="TAPER", factor=0.4),
    "smooth": modifier("SMOOTH", iterations=3),
    "corrective smooth": modifier("CORRECTIVE_SMOOTH", iterations=3),
    "subdivision": modifier("SUBSURF", levels=1),
    "solidify": modifier("SOLIDIFY", thickness=-0.001),
    "mirror": modifier("MIRROR", use_axis=(False, False, True), use_mirror_merge=False),
}


@pytest.mark.parametrize("stack", STACKS, ids=lambda name: name.replace(" ", "-"))
def test_evaluated_hand_moves_as_solved(stack):
    hand, product = stage.scene()
    STACKS[stack](hand)
    bpy.context.view_layer.update()
    count = len(hand.data.vertices)
    stage.raise_under(hand, product)
    product.location.x, product.location.y = stage.evaluated(hand)[:count].mean(axis=0)[:2] * stage.MM
    before = stage.evaluated(hand)[:count]
    result = stage.solve()
    wanted = stage.attribute(hand, "contact_displacement_mm")
    achieved = stage.evaluated(hand)[:count] - before
    error = np.abs(achieved - wanted).max()
    assert np.abs(wanted).max() > 0.3
    assert error < 0.01
    assert error < result.write_error_mm + 1e-3, "the reported error is the real one"


def test_mirrored_hand_carries_the_same():
    hand, _ = stage.scene()
    expected = stage.solve().force_n
    bpy.ops.thenar.clear()
    hand.scale.x = -1
    bpy.context.view_layer.update()
    assert stage.solve().force_n == pytest.approx(expected, rel=1e-3)


def test_active_key_and_user_keys_stay():
    hand, _ = stage.scene()
    other_key(hand)
    hand.active_shape_key_index = 1
    stage.solve()
    assert hand.active_shape_key.name == "Fat"
    assert [key.name for key in hand.data.shape_keys.key_blocks] == ["Basis", "Fat", "Thenar Contact"]
    bpy.ops.thenar.clear()
    assert [key.name for key in hand.data.shape_keys.key_blocks] == ["Basis", "Fat"]
    assert hand.active_shape_key.name == "Fat"


def test_failure_while_writing_leaves_the_scene_as_it_was(monkeypatch):
    from thenar_blender.scene import write

    hand, product = stage.scene()
    stage.solve()
    kept = {name: stage.attribute(hand, name) for name in ("pressure_kpa", "contact_displacement_mm")}
    shape = stage.evaluated(hand)
    product.location.z += 0.0005

    def fail(*_):
        raise MemoryError("out of memory")

    monkeypatch.setattr(write, "_write_part", fail)
    with pytest.raises(RuntimeError, match="out of memory"):
        bpy.ops.thenar.solve()
    for name, values in kept.items():
        assert np.array_equal(stage.attribute(hand, name), values)
    assert np.abs(stage.evaluated(hand) - shape).max() < 1e-6
