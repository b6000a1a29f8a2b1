"""Reports: the latest of comparison and diagnosis, each of its own scene, and only the last few are held in memory."""

import json

import bpy
import letters
import pytest
import small_studies
from thenar_blender import native
from thenar_blender.results import reports


@pytest.fixture
def study(tmp_path, monkeypatch):
    """A study in the list, and a library that diagnoses at once."""
    answer = letters.Answer(letters.FINDINGS["instrument"])
    monkeypatch.setattr(native.module, "diagnose", lambda study, progress=None, cancel=None: answer)
    bpy.ops.thenar.load_recording(filepath=str(small_studies.write(tmp_path, small_studies.flat_skin())))
    return tmp_path / "report.json"


def written(path, **options):
    assert bpy.ops.thenar.report(filepath=str(path), **options) == {"FINISHED"}
    return json.loads(path.read_text())


def test_the_latest_is_written_unless_one_is_asked_for(study):
    bpy.ops.thenar.diagnose()
    assert "verdict" in written(study)
    bpy.ops.thenar.compare()
    assert "recordings" in written(study), "the comparison came last"
    assert "verdict" in written(study, kind="DIAGNOSIS")
    bpy.ops.thenar.diagnose()
    assert "verdict" in written(study) and "recordings" in written(study, kind="COMPARISON")


def test_a_report_is_never_that_of_another_file(study):
    bpy.ops.thenar.compare()
    kept = str(study.with_name("kept.blend"))
    bpy.ops.wm.save_as_mainfile(filepath=kept)
    first = written(study)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with pytest.raises(RuntimeError, match="[Nn]othing was found yet"):
        bpy.ops.thenar.report(filepath=str(study))
    bpy.ops.wm.open_mainfile(filepath=kept)
    assert written(study) == first, "this Blender still holds the comparison that the file remembers"
    reports.forget()
    with pytest.raises(RuntimeError, match="before this file was opened; press Compare again"):
        bpy.ops.thenar.report(filepath=str(study))


def test_only_the_last_few_are_held(study):
    bpy.ops.thenar.compare()
    for _ in range(6):
        reports.keep(letters.Answer({}))
    with pytest.raises(RuntimeError, match="press Compare again"):
        bpy.ops.thenar.report(filepath=str(study))


def test_the_file_keeps_the_findings_themselves(study):
    bpy.ops.thenar.diagnose()
    page = study.with_suffix(".html")
    assert bpy.ops.thenar.report(filepath=str(page)) == {"FINISHED"}
    assert letters.FINDINGS["instrument"]["sentence"] in page.read_text()
    with pytest.raises(RuntimeError, match="nothing to report"):
        bpy.ops.thenar.report(filepath=str(page), kind="COMPARISON")
    reports.forget()
    assert written(study) == letters.FINDINGS["instrument"]
    with pytest.raises(RuntimeError, match="press Diagnose again"):
        bpy.ops.thenar.report(filepath=str(page))
