"""Names with signs that mean something elsewhere: they come through a solve unchanged, and nothing is left behind."""

import json

import bpy
import pytest
import stage
import thenar
from test_sentences import job
from thenar_blender.results import sentences
from thenar_blender.results.result import as_dict

NAMES = [
    r"C:\cup",
    r"cup \1 big \g<0> \n",
    "$HOME ${x} %s %(a)d {0} {name!r} {",
    "it's a 'mug' \"quoted\" `x`",
    "region 0 of the hand of the product",
    "Kaffeetasse äöü 咖啡杯 ☕ \u202eabc",
    "咖啡杯" * 7,
    "line\nbreak\ttab",
    "../..//mug?.npy",
    "[a](b)*+^|.",
    " ",
    "a" * 63,
]


@pytest.mark.parametrize("name", NAMES)
def test_an_error_holds_the_name_as_it_is(name):
    told = sentences.named(thenar.SolveError("the hand's region 0 meets the product"), job(name, name))
    assert str(told) == f"'{name}' on '{name}': the hand's region 0 meets the product"


def data_blocks():
    kinds = ("objects", "meshes", "materials", "collections", "node_groups")
    return {(kind, block.name) for kind in kinds for block in getattr(bpy.data, kind)}


@pytest.mark.parametrize("name", NAMES)
def test_objects_of_that_name_are_solved_shown_and_cleared(name, tmp_path):
    hand, product = stage.scene()
    bar = bpy.data.curves.new("Bar", "CURVE")
    bar.bevel_depth, bar.dimensions = 0.002, "3D"
    bar.splines.new("POLY").points.add(1)
    bar.splines[0].points[0].co, bar.splines[0].points[1].co = (-0.02, 0, 0, 1), (0.02, 0, 0, 1)
    bar = bpy.data.objects.new(f"{name[:-1]}b", bar)
    parts = bpy.data.collections.new("Parts")
    bpy.context.scene.collection.children.link(parts)
    parts.objects.link(bar)
    bar.location.z = -0.0095
    bpy.context.scene.thenar.product_collection = parts
    hand.name = product.name = name
    for obj in (hand, product):
        obj.data.materials.append(bpy.data.materials.new(name))
    group = hand.vertex_groups.new(name=name)
    group.add(range(len(hand.data.vertices)), 1.0, "REPLACE")
    hand.thenar.materials.add().name = group.name
    before = data_blocks()
    result = stage.solve()
    assert result.force_n > 0.0
    assert result.hand_name == hand.name and result.product_name == f"{product.name}, {bar.name}"
    assert bpy.ops.thenar.show_pressure() == {"FINISHED"}
    assert stage.solve().regions[0].name == group.name
    assert bpy.ops.thenar.export(filepath=str(tmp_path / "out.csv")) == {"FINISHED"}
    summary = json.loads(json.dumps(as_dict(bpy.context.scene.thenar.result)))
    assert summary["hand"] == hand.name and summary["product"] == f"{product.name}, {bar.name}"
    bpy.ops.thenar.clear()
    left = {block for block in data_blocks() - before if block[0] != "node_groups"}
    assert not left
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    assert bpy.ops.thenar.bake(frame_start=1, frame_end=2) == {"FINISHED"}
    bpy.context.scene.frame_set(2)
    assert stage.attribute(hand, "pressure_kpa").max() > 0.0 and stage.attribute(product, "pressure_kpa").max() > 0.0
