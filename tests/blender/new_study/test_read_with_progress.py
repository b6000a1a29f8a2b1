"""Choosing files of a new study reads them next to the window: progress by file, Esc leaves the scene as it was."""

import bpy
import laboratory
import pytest
from thenar_blender.new_study import drafting, looking


@pytest.fixture
def names(tmp_path):
    return [laboratory.write(tmp_path / f"press_{k}.csv", laboratory.press(k)) for k in (1, 2, 3)]


def draft():
    return bpy.context.scene.thenar_new_study


class CancelAfter:
    """A cancel that is set once it was asked `count` times."""

    def __init__(self, count):
        self.count = count

    def is_set(self):
        self.count -= 1
        return self.count < 0


def test_progress_counts_files_and_the_scene_changes_at_the_end_alone(tmp_path, names):
    steps, said = drafting.steps(bpy.context, tmp_path, names), []
    work = next(steps)
    found = work(None, lambda stage, fraction: said.append((stage, round(fraction, 3))))
    assert said == [("read", 0.0), ("read", 0.333), ("read", 0.667)]
    assert not draft().is_open and len(found) == 3
    with pytest.raises(StopIteration) as end:
        steps.send(found)
    assert end.value.value == 3 and draft().is_open


def test_a_cancelled_reading_stops_at_the_next_file_and_keeps_the_proposal_that_was_open(tmp_path, names):
    bpy.ops.thenar.new_study(directory=f"{tmp_path}/", files=[{"name": names[0]}])
    draft().protocols[0].diameter_mm = 7.0
    steps = drafting.steps(bpy.context, tmp_path, names)
    found = next(steps)(CancelAfter(1), None)
    steps.close()
    assert [each.path.rpartition("/")[2] for each in found] == ["press_1.csv"]
    assert draft().is_open and len(draft().files) == 1 and draft().protocols[0].diameter_mm == 7.0


@pytest.mark.parametrize("ends_by", ["esc", "refusal"])
def test_a_proposal_that_stays_open_is_not_read_from_its_files_again(tmp_path, names, monkeypatch, ends_by):
    bpy.ops.thenar.new_study(directory=f"{tmp_path}/", files=[{"name": name} for name in names[:2]])
    if ends_by == "esc":
        steps = drafting.steps(bpy.context, tmp_path, names[2:])
        next(steps)(CancelAfter(1), None)
        steps.close()
    else:
        (tmp_path / "other.csv").write_bytes(b"")
        with pytest.raises(RuntimeError, match=r"other\.csv"):
            bpy.ops.thenar.new_study(directory=f"{tmp_path}/", files=[{"name": "press_3.csv"}, {"name": "other.csv"}])
    assert {key[0].rpartition("/")[2] for key in looking._read} == {"press_1.csv", "press_2.csv"}
    monkeypatch.setattr(looking, "_track", lambda *_: pytest.fail("read a second time, in the window's thread"))
    drafting.refresh(bpy.context)
    assert [item.problem for item in draft().files] == ["", ""]


def test_a_discarded_proposal_lets_go_of_what_was_read(tmp_path, names):
    bpy.ops.thenar.new_study(directory=f"{tmp_path}/", files=[{"name": name} for name in names])
    assert len(looking._read) == 3
    bpy.ops.thenar.discard_study()
    assert not looking._read


def test_files_that_say_everything_are_read_once(tmp_path, names, monkeypatch):
    steps = drafting.steps(bpy.context, tmp_path, names)
    found = next(steps)(None, None)
    assert not any(each.headers for each in found)
    monkeypatch.setattr(looking, "_track", lambda *_: pytest.fail("read a second time, in the window's thread"))
    with pytest.raises(StopIteration):
        steps.send(found)
    assert not any(item.problem for item in draft().files)


def test_what_the_window_reads_is_what_a_script_reads(tmp_path, names):
    chosen = [{"name": name} for name in names]
    assert bpy.ops.thenar.read_study_files(directory=f"{tmp_path}/", files=chosen) == {"FINISHED"}
    by_window = [(item.name, item.protocol, item.about) for item in draft().files]
    bpy.ops.thenar.discard_study()
    assert bpy.ops.thenar.new_study(directory=f"{tmp_path}/", files=chosen) == {"FINISHED"}
    assert by_window == [(item.name, item.protocol, item.about) for item in draft().files] and len(by_window) == 3
