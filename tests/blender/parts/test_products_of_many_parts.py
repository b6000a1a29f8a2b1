"""A product of many objects that share a mesh: one sentence says that copies carry the pressure, not one an object."""

import bpy
import pytest

COUNT = 40


@pytest.fixture
def strips():
    """The fingertip sample with its plate cut into strips that share a mesh; their collection."""
    bpy.ops.thenar.add_sample(kind="fingertip_on_plate")
    settings = bpy.context.scene.thenar
    plate = settings.product
    corners = [plate.matrix_world @ vertex.co for vertex in plate.data.vertices]
    low, high = (type(corners[0])([pick(c[k] for c in corners) for k in range(3)]) for pick in (min, max))
    bpy.data.objects.remove(plate)
    bpy.ops.mesh.primitive_cube_add(size=1.0)
    cube = bpy.context.object
    mesh = cube.data
    bpy.data.objects.remove(cube)
    collection = bpy.data.collections.new("Strips")
    bpy.context.scene.collection.children.link(collection)
    width = (high.x - low.x) / COUNT
    for number in range(COUNT):
        strip = bpy.data.objects.new(f"strip {number}", mesh)
        strip.scale = (width, high.y - low.y, high.z - low.z)
        strip.location = (low.x + width * (number + 0.5), (low.y + high.y) / 2, (low.z + high.z) / 2)
        collection.objects.link(strip)
    bpy.context.view_layer.update()
    return collection


def test_copies_of_many_parts_are_one_sentence(strips, capfd):
    settings = bpy.context.scene.thenar
    settings.product_collection = strips
    bpy.ops.thenar.solve()
    said = [line for line in capfd.readouterr().out.splitlines() if "carries the pressure" in line]
    assert len(said) == 1 and f"and {COUNT - 2} others" in said[0]
