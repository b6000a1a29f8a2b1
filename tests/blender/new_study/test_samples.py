"""The sample studies open from the panel."""

import bpy
import pytest
from thenar_blender.new_study import operators


@pytest.mark.parametrize("kind", [kind for kind, _, _ in operators.KINDS])
def test_a_sample_opens_and_can_be_diagnosed(kind):
    assert bpy.ops.thenar.sample_study(kind=kind) == {"FINISHED"}
    item = bpy.context.scene.thenar_recordings.items[0]
    assert item.kind == "STUDY" and item.about.startswith("study of 8 recordings")
    assert kind.split("_")[0] not in item.name.lower()
    assert bpy.ops.thenar.diagnose.poll()
