"""A fresh file with the add-on registered, for the tests that need Blender's own bones."""

import pytest


@pytest.fixture
def blender():
    """An empty file with the add-on registered; unregistered afterwards."""
    bpy = pytest.importorskip("bpy")
    pytest.importorskip("thenar")
    addon = pytest.importorskip("thenar_blender")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.register()
    yield bpy
    addon.unregister()
