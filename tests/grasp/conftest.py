"""A fresh file with the add-on registered, and a made hand with a handle in it."""

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")
pytest.importorskip("thenar")
addon = pytest.importorskip("thenar_blender")


@pytest.fixture
def blender():
    """An empty file with the add-on registered; unregistered afterwards, or bpy 4.5 never exits."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.register()
    yield bpy
    addon.unregister()


@pytest.fixture
def scene(blender):
    """A function that puts a hand of a size and a handle, turned by degrees and moved, in metres, into the file."""

    def put(mesh, turn=(0, 0, 0), shift=(0.0, 0.0, 0.0), percentile=50.0):
        from handles import grasping

        blender.ops.thenar.make_hand(percentile=percentile)
        product = grasping._add(mesh, turn)
        product.location = shift
        blender.context.view_layer.update()
        blender.context.scene.thenar.product = product
        return blender.context.scene.thenar.hand, product

    return put


@pytest.fixture
def bar():
    """A round bar of 32 mm between two disks of 60 mm, 100 mm apart: vertices (n, 3), mm, and triangles (m, 3)."""
    from handles import shapes

    along = np.array([-58.0, -58.0, -50.0, -48.0, 48.0, 50.0, 58.0, 58.0])
    across = np.array([0.0, 30.0, 30.0, 16.0, 16.0, 30.0, 30.0, 0.0])
    return shapes.revolved(across, along, 48)
