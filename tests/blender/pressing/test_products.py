"""Products of every kind: curves, nodes, instances, metaballs, several parts, large, open, shared."""

import bpy
import numpy as np
import pytest
import stage


def finish(product):
    hand = stage.pad()
    settings = bpy.context.scene.thenar
    settings.hand, settings.product = hand, product
    bpy.context.view_layer.update()
    return hand


def bar():
    bpy.ops.curve.primitive_bezier_curve_add()
    curve = bpy.context.object
    curve.name = "Bar"
    for spline in curve.data.splines:
        for point, x in zip(spline.bezier_points, (-0.03, 0.03), strict=True):
            point.co = (x, 0, 0)
            point.handle_left, point.handle_right = (x - 0.01, 0, 0), (x + 0.01, 0, 0)
    curve.data.bevel_depth, curve.data.bevel_resolution, curve.data.resolution_u = 0.01, 16, 64
    curve.location.z = -0.0168
    return curve


def instances():
    source = stage.plate("Source")
    source.location = (0, 0, 0)
    holder = bpy.data.objects.new("Holder", bpy.data.meshes.new("Holder"))
    bpy.context.scene.collection.objects.link(holder)
    tree = bpy.data.node_groups.new("Instance", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    info = tree.nodes.new("GeometryNodeObjectInfo")
    info.inputs["Object"].default_value = source
    info.inputs["As Instance"].default_value = True
    tree.links.new(info.outputs["Geometry"], tree.nodes.new("NodeGroupOutput").inputs[0])
    holder.modifiers.new("Nodes", "NODES").node_group = tree
    holder.location.z = -0.0218
    return holder


def metaball():
    bpy.ops.object.metaball_add(type="BALL", radius=0.02)
    ball = bpy.context.object
    ball.data.resolution = 0.001
    bpy.context.view_layer.update()
    ball.location.z = -0.0068 - max(corner[2] for corner in ball.bound_box)
    return ball


def text():
    curve = bpy.data.curves.new("Text", "FONT")
    curve.body, curve.size, curve.extrude = "I", 0.06, 0.01
    product = bpy.data.objects.new("Text", curve)
    bpy.context.scene.collection.objects.link(product)
    bpy.context.view_layer.update()
    box = np.array(product.bound_box)
    product.location = (-box[:, 0].mean(), -box[:, 1].mean(), -0.0168)
    return product


@pytest.mark.parametrize("make", [bar, instances, metaball, text], ids=lambda make: make.__name__)
def test_surface_that_is_no_plain_mesh(make):
    product = make()
    finish(product)
    result = stage.solve()
    assert result.force_n > 0.02
    copy = next(obj for obj in bpy.data.objects if obj.thenar.copy_of == product.name)
    pressure = stage.attribute(copy, "pressure_kpa")
    assert pressure.max() > (0.0 if product.type == "FONT" else 0.3 * result.peak_kpa), "letters have large triangles"
    assert any(product.name in text.name for text in result.warnings)
    assert copy.hide_viewport
    bpy.ops.thenar.show_pressure()
    assert not copy.hide_viewport and product.hide_get()
    bpy.ops.thenar.show_pressure(show=False)
    assert copy.hide_viewport and not product.hide_get() and not product.hide_render
    bpy.ops.thenar.clear()
    assert not [obj for obj in bpy.data.objects if obj.thenar.copy_of]
    assert "Thenar Results" not in bpy.data.collections


def test_shared_mesh_of_a_product_is_left_alone():
    product = stage.plate()
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Twin", product.data))
    finish(product)
    stage.solve()
    assert "pressure_kpa" not in product.data.attributes
    assert [obj.thenar.copy_of for obj in bpy.data.objects if obj.thenar.copy_of] == ["Plate"]


def test_parts_in_a_collection_make_one_product():
    hand, whole = stage.scene()
    expected = stage.solve().force_n
    bpy.ops.thenar.clear()
    parts = bpy.data.collections.new("Parts")
    bpy.context.scene.collection.children.link(parts)
    far = stage.plate("Far")
    far.location.x = 0.05
    for part in (whole, far):
        parts.objects.link(part)
    settings = bpy.context.scene.thenar
    settings.product, settings.product_collection = None, parts
    bpy.context.view_layer.update()
    assert stage.solve().force_n == pytest.approx(expected, rel=1e-3)
    assert stage.attribute(whole, "pressure_kpa").max() > 0 and stage.attribute(far, "pressure_kpa").max() == 0


def test_force_moves_all_parts_once():
    hand, whole = stage.scene()
    child = stage.plate("Child", size=5.0)
    child.location.x = 0.05
    child.parent = whole
    parts = bpy.data.collections.new("Parts")
    bpy.context.scene.collection.children.link(parts)
    for part in (whole, child):
        parts.objects.link(part)
    settings = bpy.context.scene.thenar
    settings.product, settings.product_collection = None, parts
    settings.use_force, settings.force_n = True, 2.0
    before = [stage.evaluated(part) for part in (whole, child)]
    result = stage.solve()
    wanted = result.offset_mm * np.array(result.direction)
    for part, place in zip((whole, child), before, strict=True):
        assert np.abs(stage.evaluated(part) - place - wanted).max() < 1e-3


def test_subdivided_product_carries_pressure_on_its_own_vertices():
    hand, product = stage.scene(cuts=12)
    product.modifiers.new("Subdivision", "SUBSURF").levels = 2
    bpy.context.view_layer.update()
    stage.raise_under(hand, product)
    stage.solve()
    assert len(stage.attribute(product, "pressure_kpa")) == len(product.data.vertices)


def test_open_product_is_pressed():
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=60, y_subdivisions=60, size=0.03, location=(0, 0, -0.0068))
    product = bpy.context.object
    finish(product)
    result = stage.solve()
    assert result.force_n > 0.1
    assert any("open" in text.name for text in result.warnings)


def test_half_a_million_triangles():
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=500, y_subdivisions=500, size=0.05, location=(0, 0, -0.0068))
    product = bpy.context.object
    product.modifiers.new("Thick", "SOLIDIFY").thickness = 0.01
    finish(product)
    result = stage.solve()
    assert result.force_n > 0.1
    assert sum(stage.seconds for stage in result.stages if not stage.name.startswith("press:")) < 30
