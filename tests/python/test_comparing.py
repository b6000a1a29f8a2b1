"""`thenar.compare`, `place_mat`, `compare_map` and `spread_map`: arrays, texts, cancellation, refusals."""

import json
import threading

import numpy as np
import pytest
import thenar

STUDY = """
[study]
title = "Ball"
[skin]
mesh = "skin.obj"
[skin.materials.default]
g0_mpa = 0.03
g_lim_mpa = 0.05
d_lim_mm = 4.0
thickness_mm = "inf"
[indenters.ball]
shape = "sphere"
radius_mm = 8.0
[sites.middle]
point_mm = [0.0, 0.0, 0.0]
direction = [0.0, 0.0, -1.0]
[[recordings]]
name = "press"
kind = "indentation"
file = "press.csv"
indenter = "ball"
site = "middle"
"""


@pytest.fixture
def study(tmp_path):
    """A ball pressed into a half space; forces by Hertz, E* = 4 G with G = 0.02 MPa."""
    side = np.arange(13) - 6.0
    lines = [f"v {x} {y} 0" for y in side for x in side]
    for corner in (row * 13 + column + 1 for row in range(12) for column in range(12)):
        lines.append(f"f {corner} {corner + 1} {corner + 14} {corner + 13}")
    (tmp_path / "skin.obj").write_text("\n".join(lines) + "\n")
    depth = np.linspace(0.05, 0.8, 30)
    force = 4 / 3 * 4 * 0.02 * np.sqrt(8) * depth**1.5
    rows = (f"{0.1 * k + 0.1},{d},{f}\n" for k, (d, f) in enumerate(zip(depth, force, strict=True)))
    (tmp_path / "press.csv").write_text("time_s,depth_mm,force_n\n" + "".join(rows))
    (tmp_path / "study.toml").write_text(STUDY)
    return thenar.Study.load(tmp_path)


def test_a_study_gives_arrays_json_and_a_page(study):
    told = []
    comparison = thenar.compare(study, lambda stage, share: told.append(share))
    assert told == sorted(told) and told[-1] == 1.0
    force = comparison.recordings[0].series.force_n
    assert force.measured.shape == force.simulated.shape == force.time_s.shape
    hertz = 4 / 3 * 4 * 0.02 * np.sqrt(8) * force.depth_mm**1.5
    assert np.allclose(force.measured, hertz, atol=1e-3 * hertz.max())
    assert np.abs(force.measured - force.simulated).max() < 0.05 * hertz.max()
    numbers = json.loads(comparison.to_json())
    assert numbers["sentence"] == comparison.sentence
    assert numbers["recordings"][0]["series"][0]["measured"] == force.measured.tolist()
    assert comparison.report_html().count("<svg") >= 2
    assert thenar.compare(study, seed=1).to_json() == comparison.to_json()


def test_a_comparison_can_be_cancelled(study):
    event = threading.Event()
    event.set()
    with pytest.raises(thenar.Cancelled):
        thenar.compare(study, cancel=event)


def test_a_frame_is_compared_with_forces_by_place():
    grid = np.array([[x, y, 0.0] for y in (0.0, 5.0) for x in (0.0, 5.0)])
    mat = thenar.Record(
        center_mm=np.vstack([grid, np.full((1, 3), np.nan)]),
        normal=np.vstack([np.tile([0.0, 0.0, 1.0], (4, 1)), np.full((1, 3), np.nan)]),
        area_mm2=np.array([25.0, 25.0, 25.0, 25.0, np.nan]),
        row=np.array([0, 0, 1, 1, 2]),
        column=np.array([0, 1, 0, 1, 0]),
    )
    vertices = np.array([[0.0, 0.0, 0.0], [5.0, 5.0, 0.0], [5.0, 0.0, 3.0]])
    values = [40.0, 0.0, 0.0, 60.0, np.nan]
    comparison = thenar.compare_map(values, mat, vertices, [[0, 2, 1]], [1.0, 2.0, 0.0], threshold=2.0)
    frame = comparison.recordings[0].frames[0]
    # The vertices' own areas reach into the neighbors: force is kept, and most of it falls below.
    assert frame.simulated.sum() * 25e-3 == pytest.approx(3.0, rel=0.02)
    assert np.argsort(frame.simulated)[-2:].tolist() == [0, 3]
    assert np.allclose(frame.measured, values[:4])
    spread = thenar.spread_map([1.0, 2.0, 3.0, 4.0, np.nan], mat, [[2.5, 2.5, 0.0], [40.0, 0.0, 0.0]])
    assert spread[0] == pytest.approx(2.5) and np.isnan(spread[1])


def test_what_cannot_be_placed_is_refused(tmp_path):
    file = tmp_path / "mat.csv"
    file.write_text("time_s,row,col,pressure_kpa\n0.1,0,0,1.0\n0.1,0,1,2.0\n0.2,0,0,1.0\n0.2,0,1,2.0\n")
    where = {"origin_mm": [0, 0, 0], "rows": [0, 0, 1], "columns": [1, 0, 0]}
    with pytest.raises(thenar.RecordingError, match="no pitch"):
        thenar.place_mat(file, "plane", **where)
    with pytest.raises(thenar.RecordingError, match="diameter_mm"):
        thenar.place_mat(file, "cylinder", **where)
    with pytest.raises(thenar.RecordingError, match="points nowhere"):
        thenar.place_mat(file, "plane", origin_mm=[0, 0, 0], rows=[0, 0, 1], columns=[0, 0, 2])
