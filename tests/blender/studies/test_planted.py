"""The library's own diagnosis by the operator: what was planted is named, switched on and reported; else nothing is."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
import small_studies
import stage
from thenar_blender import native
from thenar_blender.diagnosis import curves, diagnosing, letter, reading


def told():
    """The letter of the scene as lines."""
    return list(letter.lines(letter.write(reading.parse(bpy.context.scene.thenar_diagnosis.findings))))


def diagnosed(path):
    """The library's own diagnosis of a study, by the operator. Returns its findings."""
    bpy.ops.thenar.load_recording(filepath=str(path))
    assert bpy.ops.thenar.diagnose() == {"FINISHED"}
    return reading.parse(bpy.context.scene.thenar_diagnosis.findings)


def test_planted_relaxation_is_found_switched_on_and_reported(tmp_path):
    stage.scene()
    found = diagnosed(small_studies.write_relaxing(tmp_path, share=0.35))
    assert found["verdict"] == "missing_physics", found["sentence"]
    assert [finding["effect"] for finding in found["findings"]] == ["relaxation"]
    lines = told()
    assert lines[0] == "Physics is missing" and lines[1] == found["sentence"]
    assert any(line.startswith("1. Relaxation, ") for line in lines)
    assert any("of the reducible error is removed" in line for line in lines)
    assert not any("None" in line or "nan" in line.split() for line in lines), lines
    assert bpy.ops.thenar.apply_finding(index=0) == {"FINISHED"}
    (effect,) = bpy.context.scene.thenar.hand.thenar.effects
    amplitude, region = effect.amplitude, effect.region
    numbers = {number.name: number.value for number in effect.numbers}
    parameters = found["findings"][0]["parameters"]
    assert amplitude == pytest.approx(parameters["amplitude"]["value"], rel=1e-5) and region == ""
    curve = curves.read(bpy.context.scene.thenar_diagnosis.curves)[0]
    off = {name: np.square(np.subtract(curve["measured_n"], curve[name])).mean() for name in ("before_n", "after_n")}
    assert off["after_n"] < 0.5 * off["before_n"], "the picture shows the gain"
    for name in set(parameters) - {"amplitude"}:
        assert numbers[name] == pytest.approx(parameters[name]["value"], rel=1e-5)
    assert stage.solve().force_n > 0.0
    page = tmp_path / "page.html"
    assert bpy.ops.thenar.report(filepath=str(page), kind="DIAGNOSIS") == {"FINISHED"}
    assert "<svg" in page.read_text() and "relaxation" in page.read_text()


def test_where_nothing_is_missing_nothing_can_be_switched_on(tmp_path):
    stage.scene()
    found = diagnosed(small_studies.write_relaxing(tmp_path, share=0.0))
    assert found["verdict"] in {"nothing_missing", "parameters"} and not found["findings"]
    assert told()[0] in {"Nothing is missing", "Only parameters were off"}
    assert not any(line.startswith("At 90 %") for line in told())
    with pytest.raises(RuntimeError, match="lists no finding"):
        bpy.ops.thenar.apply_finding(index=0)


def test_one_press_is_too_little_and_esc_stops_the_library(tmp_path):
    path = small_studies.write(tmp_path, small_studies.flat_skin())
    assert diagnosed(path)["verdict"] == "insufficient_data"
    steps = diagnosing.steps(bpy.context)
    stages = []
    cancel = SimpleNamespace(is_set=lambda: len(stages) > 3)
    with pytest.raises(native.module.Cancelled):
        next(steps)(cancel, lambda stage, share: stages.append((stage, share)))
    assert len(stages) > 3 and all(0.0 <= share <= 1.0 for _, share in stages)
