"""The sample studies open from the panel."""

import bpy
import pytest
from thenar_blender.diagnosis import letter, reading
from thenar_blender.new_study import operators


def test_the_grasp_is_answered_in_a_letter_that_opens():
    bpy.ops.thenar.sample_study(kind="held_handle")
    assert bpy.ops.thenar.diagnose() == {"FINISHED"}
    found = reading.parse(bpy.context.scene.thenar_diagnosis.findings)
    lines = list(letter.lines(letter.write(found)))
    assert lines[0] == "Physics is missing" and lines[1].startswith("Held skin relaxes")
    assert any("posture, against the study's hand" in line.lower() for line in lines)


def test_a_study_of_grasps_is_compared_by_the_diagnosis_alone():
    bpy.ops.thenar.sample_study(kind="held_handle")
    with pytest.raises(RuntimeError, match="diagnose the study"):
        bpy.ops.thenar.compare()


@pytest.mark.parametrize("kind", [kind for kind, _, _ in operators.KINDS])
def test_a_sample_opens_and_can_be_diagnosed(kind):
    assert bpy.ops.thenar.sample_study(kind=kind) == {"FINISHED"}
    item = bpy.context.scene.thenar_recordings.items[0]
    count = 3 if kind == "held_handle" else 8
    assert item.kind == "STUDY" and item.about.startswith(f"study of {count} recordings")
    assert kind.split("_")[0] not in item.name.lower()
    assert bpy.ops.thenar.diagnose.poll()
