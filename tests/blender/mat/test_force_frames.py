"""Force frames and the demo's table: one grasp at several forces through a mat, and why there is no mat elsewhere."""

from pathlib import Path

import bpy
import pytest
import stage
from thenar_blender.recordings import table_6
from thenar_blender.terminal import demo

SAMPLE = Path(__file__).parents[3] / "blend-samples" / "cylinder_100.blend"


def test_the_force_frames_are_one_grasp_at_other_forces(monkeypatch):
    monkeypatch.setattr(table_6, "FRAMES_N", {"least": 105.0, "mean": 122.0})
    frames = table_6.read_frames(bpy.context, SAMPLE)
    assert list(frames) == ["least", "mean"]
    for name, reading in frames.items():
        assert reading["skin"]["force_n"] == pytest.approx(table_6.FRAMES_N[name], rel=0.025), name
    least, mean = (reading["rows"][1]["area_mm2"][1] for reading in frames.values())
    assert least < mean
    lines = list(table_6.frame_lines(frames))
    assert lines[1].startswith("least, 105 N wanted") and lines[-1].startswith("Assumed:")


def test_the_demo_prints_why_there_is_no_mat(capsys):
    stage.scene()
    stage.solve()
    assert demo._read_mat(bpy.context) is None
    assert "no virtual mat: the product 'Plate' is no cylinder where it is touched" in capsys.readouterr().out


def test_the_demo_prints_the_mat_next_to_table_6(monkeypatch, capsys):
    monkeypatch.setattr(table_6, "read_scene", lambda context: READING)
    assert demo._read_mat(bpy.context) is READING
    printed = capsys.readouterr().out
    assert "over all thresholds" in printed and "measured (Xie Table 6)" in printed


ONE = {"area_mm2": (8000.0, 8500.0, 9000.0), "mean_kpa": (30.0, 35.0, 40.0), "peak_kpa": (100.0,), "force_n": (330.0,)}
READING = {"diameter_mm": 48.0, "pitch_mm": (4.88, 4.86), "placements": 24, "rows": [], "range": ONE, "skin": {}}
READING["skin"] = {name: values[0] for name, values in ONE.items()}
