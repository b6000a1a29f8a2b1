"""What stands in the folder of a new study survives every way in which writing fails."""

import os
import tomllib
from pathlib import Path

import bpy
import laboratory
import pytest
import thenar
from thenar_blender.new_study import writing
from thenar_blender.scene.checks import Refusal

MINE = {"study.toml": "mine", "study_skin.ply": "my skin"}
NEW = {"study.toml": "[study]\n", "study_skin.ply": "ply\n", "study_regions.csv": "vertex,region\n"}


def state(folder):
    """Every file's text, and None for a folder."""
    return {each.name: None if each.is_dir() else each.read_text() for each in folder.iterdir()}


def test_a_target_that_cannot_be_read_leaves_the_others(tmp_path):
    (tmp_path / "study.toml").write_text("mine")
    (tmp_path / "study_skin.ply").mkdir()
    with pytest.raises(Refusal, match=r"'study_skin\.ply' in .* cannot be read .*not replaced; move it elsewhere"):
        writing.write(tmp_path, NEW, replaces=True)
    assert state(tmp_path) == {"study.toml": "mine", "study_skin.ply": None}


@pytest.mark.parametrize("failing", [1, 2, 3])
def test_a_rename_that_fails_puts_back_what_was_replaced(tmp_path, monkeypatch, failing):
    """The disk refuses one rename, and later the first one that would put something back."""
    for name, text in MINE.items():
        (tmp_path / name).write_text(text)
    whole, calls = os.replace, []

    def replace(source, target):
        calls.append(target)
        if len(calls) == failing:
            raise OSError(28, "No space left on device")
        whole(source, target)

    monkeypatch.setattr(os, "replace", replace)
    with pytest.raises(Refusal, match="No space left on device"):
        writing.write(tmp_path, NEW, replaces=True)
    assert state(tmp_path) == MINE


def test_putting_back_goes_on_after_an_error_and_names_what_is_lost(tmp_path, monkeypatch):
    for name, text in MINE.items():
        (tmp_path / name).write_text(text)
    whole, calls = os.replace, []

    def replace(source, target):
        calls.append(target)
        if len(calls) in {3, 4}:
            raise OSError(5, "Input/output error")
        whole(source, target)

    monkeypatch.setattr(os, "replace", replace)
    with pytest.raises(Refusal, match=r"'study\.toml' could not be put back as before"):
        writing.write(tmp_path, NEW, replaces=True)
    assert (tmp_path / "study_skin.ply").read_text() == "my skin"
    assert not list(tmp_path.glob("*.part"))


def test_a_second_study_takes_the_first_ones_files_for_no_recordings(tmp_path):
    """`A` in the file browser chooses all that the filter shows, the table of regions as well."""
    laboratory.write(tmp_path / "p1.csv", laboratory.press(1))
    (tmp_path / "study_regions.csv").write_text("vertex,region\n0,palm\n")
    names = [{"name": each.name} for each in tmp_path.iterdir()]
    assert bpy.ops.thenar.new_study(directory=f"{tmp_path}/", files=names) == {"FINISHED"}
    assert [Path(item.path).name for item in bpy.context.scene.thenar_new_study.files] == ["p1.csv"]
    with pytest.raises(RuntimeError, match=r"'study_regions\.csv' is a file of a study and no recording"):
        bpy.ops.thenar.new_study(directory=f"{tmp_path}/", files=[{"name": "study_regions.csv"}])


@pytest.mark.parametrize("name", ["index, distal", "none", "-1"])
def test_a_region_that_its_table_cannot_name_is_refused(tmp_path, name):
    bpy.ops.thenar.make_hand()
    laboratory.write(tmp_path / "p1.csv", laboratory.press(1))
    bpy.ops.thenar.new_study(directory=f"{tmp_path}/", files=[{"name": "p1.csv"}])
    draft, hand = bpy.context.scene.thenar_new_study, bpy.context.scene.thenar.hand
    draft.protocols[0].diameter_mm = 12.0
    region = next(each for each in hand.thenar.materials if "distal" in each.name.lower())
    hand.vertex_groups[region.name].name = name
    region.name = draft.site_region = name
    with pytest.raises(RuntimeError, match=f"region '{name}' cannot be written .* rename the region under Materials"):
        bpy.ops.thenar.write_study()
    assert [each.name for each in tmp_path.iterdir()] == ["p1.csv"]


def test_a_protocol_that_no_recording_follows_has_no_tool_in_the_study(tmp_path):
    for number in (1, 2):
        laboratory.write(tmp_path / f"p{number}.csv", laboratory.press(number))
    bpy.ops.thenar.new_study(directory=f"{tmp_path}/", files=[{"name": "p1.csv"}, {"name": "p2.csv"}])
    draft = bpy.context.scene.thenar_new_study
    draft.protocols[0].diameter_mm = 12.0
    draft.files[1].protocol = 3
    assert bpy.ops.thenar.write_study() == {"FINISHED"}
    written = tomllib.loads((tmp_path / "study.toml").read_text())
    assert list(written["indenters"].values()) == [{"shape": "sphere", "radius_mm": 6.0}]
    assert len(thenar.Study.load(tmp_path).recordings) == 2
