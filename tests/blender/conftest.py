"""A fresh, empty file with Thenar registered for every test, and nothing left registered after it."""

import sys
from pathlib import Path

import bpy
import pytest
import thenar_blender

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(autouse=True)
def scene():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    thenar_blender.register()
    yield bpy.context.scene
    thenar_blender.unregister()
