"""A recording keeps the tool that was said of it, however recordings are grouped and grouped again."""

import tomllib

import bpy
import laboratory
import pytest
from thenar_blender.new_study import drafting


def draft():
    return bpy.context.scene.thenar_new_study


@pytest.fixture
def four(tmp_path):
    """Two slow and two fast presses, of a ball of 12 mm and one of 5 mm."""
    for number, speed in enumerate((1.0, 1.0, 5.0, 5.0), 1):
        laboratory.write(tmp_path / f"p{number}.csv", laboratory.press(number, speed_mm_s=speed))
    bpy.ops.thenar.new_study(directory=f"{tmp_path}/", files=[{"name": f"p{k}.csv"} for k in (1, 2, 3, 4)])
    assert [item.protocol for item in draft().files] == [1, 1, 2, 2]
    assert [protocol.diameter_mm for protocol in draft().protocols] == [0.0, 0.0]
    draft().protocols[0].diameter_mm, draft().protocols[1].diameter_mm = 12.0, 5.0
    return tmp_path


def sizes():
    return [draft().protocols[item.protocol - 1].diameter_mm for item in draft().files]


def radii(folder):
    """Radius by file, as it is written."""
    written = tomllib.loads((folder / "study.toml").read_text())
    return {each["file"]: written["indenters"][each["indenter"]]["radius_mm"] for each in written["recordings"]}


def test_a_recording_of_its_own_number_keeps_its_tool(four):
    draft().files[3].protocol = 3
    assert sizes() == [12.0, 12.0, 5.0, 5.0]
    assert bpy.ops.thenar.write_study() == {"FINISHED"}
    assert radii(four) == {"p1.csv": 6.0, "p2.csv": 6.0, "p3.csv": 2.5, "p4.csv": 2.5}


def test_a_recording_that_passes_through_another_protocol_keeps_its_tool(four):
    """The arrows of the number lead from 1 to 3 over 2."""
    draft().files[0].protocol = 2
    assert sizes() == [5.0, 12.0, 5.0, 5.0]
    draft().files[0].protocol = 3
    assert sizes() == [12.0, 12.0, 5.0, 5.0]


def test_recordings_that_change_places_keep_their_tools(four):
    draft().files[0].protocol = draft().files[1].protocol = 3
    draft().files[2].protocol = draft().files[3].protocol = 1
    draft().files[0].protocol = draft().files[1].protocol = 2
    assert sizes() == [12.0, 12.0, 5.0, 5.0]


def test_a_recording_moved_to_a_tool_without_a_size_does_not_bring_its_own(four):
    draft().protocols[1].diameter_mm = 0.0
    draft().files[0].protocol = 2
    assert sizes() == [0.0, 12.0, 0.0, 0.0]
    assert "diameter of protocol 2 is not given" in drafting.problem(bpy.context)


def test_a_proposal_that_changes_with_the_answers_leaves_each_recording_its_tool(tmp_path):
    """A file without units is alone until they are chosen; then it repeats the second, and the third moves up."""
    bare = ("Time", "Depth", "Force")
    laboratory.write(tmp_path / "a.csv", laboratory.press(1))
    laboratory.write(tmp_path / "b.csv", laboratory.press(2), head=bare)
    laboratory.write(tmp_path / "c.csv", laboratory.press(3, speed_mm_s=5.0))
    bpy.ops.thenar.new_study(directory=f"{tmp_path}/", files=[{"name": f"{k}.csv"} for k in "abc"])
    assert [item.protocol for item in draft().files] == [1, 2, 3]
    for protocol, size in zip(draft().protocols, (12.0, 8.0, 5.0), strict=True):
        protocol.diameter_mm = size
    for role, unit in (("time", "S"), ("depth", "MM"), ("force", "N")):
        setattr(draft().columns[0], f"{role}_unit", unit)
    assert [item.protocol for item in draft().files] == [1, 1, 2]
    assert sizes() == [0.0, 0.0, 5.0]
    assert "diameter of protocol 1 is not given" in drafting.problem(bpy.context)


def test_writing_leaves_the_groups_when_a_file_changed_meanwhile(four):
    laboratory.write(four / "p4.csv", laboratory.press(4, speed_mm_s=1.0))
    assert bpy.ops.thenar.write_study() == {"FINISHED"}
    assert radii(four) == {"p1.csv": 6.0, "p2.csv": 6.0, "p3.csv": 2.5, "p4.csv": 2.5}
