"""A user's own shape keys and attributes that bear Thenar's names are neither overwritten, nor removed, nor shown."""

import bpy
import numpy as np
import pytest
import stage
from thenar_blender import names, status


def own_attribute(obj, name, kind, domain):
    made = obj.data.attributes.new(name, kind, domain)
    field = {"FLOAT": "value", "INT": "value", "FLOAT_COLOR": "color", "FLOAT_VECTOR": "vector"}[kind]
    width = {"FLOAT_COLOR": 4, "FLOAT_VECTOR": 3}.get(kind, 1)
    numbers = np.arange(len(made.data) * width) % 97
    made.data.foreach_set(field, numbers.astype(np.int32 if kind == "INT" else np.float32))
    return contents(obj, name)


def contents(obj, name):
    found = obj.data.attributes[name]
    return (
        found.data_type,
        found.domain,
        [
            tuple(row.color)
            if "COLOR" in found.data_type
            else tuple(row.vector)
            if "VECTOR" in found.data_type
            else row.value
            for row in found.data
        ],
    )


def refusals():
    """What every way to write a result answers."""
    for call in (bpy.ops.thenar.solve, lambda: bpy.ops.thenar.bake(frame_start=1, frame_end=2)):
        with pytest.raises(RuntimeError) as error:
            call()
        yield str(error.value)
    settings = bpy.context.scene.thenar
    settings.live = True
    yield status.live[bpy.context.scene.name].problem
    settings.live = False


ATTRIBUTES = [
    ("pressure_kpa", "INT", "FACE"),
    ("pressure_kpa", "FLOAT", "FACE"),
    ("pressure_kpa", "FLOAT", "POINT"),
    ("contact_region", "FLOAT", "POINT"),
    ("Thenar Pressure", "FLOAT_COLOR", "CORNER"),
    ("contact_displacement_mm", "FLOAT_VECTOR", "POINT"),
    ("tissue_thickness_mm", "INT", "POINT"),
]


@pytest.mark.parametrize(("name", "kind", "domain"), ATTRIBUTES)
def test_an_attribute_of_the_users_is_named_and_kept(name, kind, domain):
    hand, _ = stage.scene()
    before = own_attribute(hand, name, kind, domain)
    for text in refusals():
        assert f"'{name}'" in text and f"'{hand.name}'" in text and "rename or remove it" in text
    assert not bpy.ops.thenar.clear.poll()
    assert contents(hand, name) == before and hand.data.shape_keys is None
    hand.data.attributes[name].name = "mine"
    assert stage.solve().force_n > 0.0
    bpy.ops.thenar.clear()
    assert contents(hand, "mine") == before and set(names.HAND_ATTRIBUTES).isdisjoint(hand.data.attributes.keys())


@pytest.mark.parametrize(("name", "kind", "domain"), ATTRIBUTES[:3] + ATTRIBUTES[4:5])
def test_a_product_with_such_an_attribute_keeps_it_and_shows_the_pressure_on_a_copy(name, kind, domain):
    _, product = stage.scene()
    before = own_attribute(product, name, kind, domain)
    assert stage.solve().force_n > 0.0
    assert bpy.ops.thenar.show_pressure() == {"FINISHED"}
    copy = bpy.data.objects[f"{product.name} · pressure"]
    assert stage.attribute(copy, "pressure_kpa").max() > 0.0
    bpy.ops.thenar.clear()
    assert contents(product, name) == before and f"{product.name} · pressure" not in bpy.data.objects


def test_a_shape_key_of_the_users_is_named_and_kept():
    hand, _ = stage.scene()
    hand.shape_key_add(name="Basis")
    key = hand.shape_key_add(name="Thenar Contact")
    key.points[3].co.x += 0.001
    before = [tuple(point.co) for point in key.points]
    for text in refusals():
        assert "shape key 'Thenar Contact'" in text and f"'{hand.name}'" in text and "rename or remove it" in text
    assert not bpy.ops.thenar.clear.poll()
    assert [tuple(point.co) for point in key.points] == before and len(hand.data.shape_keys.key_blocks) == 2
    key.name = "Mine"
    assert stage.solve().force_n > 0.0
    bpy.ops.thenar.clear()
    assert [one.name for one in hand.data.shape_keys.key_blocks] == ["Basis", "Mine"]


def test_results_of_earlier_versions_are_taken_as_thenars(tmp_path):
    """Their files have no mark; they stay solvable and clearable, key and all."""
    hand, product = stage.scene()
    force = stage.solve().force_n
    for obj in (hand, product):
        obj.data.thenar.owned = ""
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "old.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "old.blend"))
    hand, product = bpy.data.objects["Pad"], bpy.data.objects["Plate"]
    assert stage.solve().force_n == pytest.approx(force, rel=1e-6)
    for obj in (hand, product):
        obj.data.thenar.owned = ""
    bpy.ops.thenar.clear()
    assert hand.data.shape_keys is None and set(names.HAND_ATTRIBUTES).isdisjoint(hand.data.attributes.keys())
    assert set(names.PRODUCT_ATTRIBUTES).isdisjoint(product.data.attributes.keys())


def test_what_thenar_made_stays_its_own_after_copying_and_deleting_some_of_it():
    hand, _ = stage.scene()
    stage.solve()
    hand.data.attributes.remove(hand.data.attributes["Thenar Pressure"])
    assert stage.solve().force_n > 0.0
    twin = hand.copy()
    twin.data = hand.data.copy()
    bpy.context.scene.collection.objects.link(twin)
    bpy.context.scene.thenar.hand = twin
    assert stage.solve().force_n > 0.0
    bpy.ops.thenar.clear()
    hand = twin
    own_attribute(hand, "pressure_kpa", "FLOAT", "POINT")
    with pytest.raises(RuntimeError, match="'pressure_kpa'"):
        bpy.ops.thenar.solve()
