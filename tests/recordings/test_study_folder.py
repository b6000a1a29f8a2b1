"""`thenar.Study`: the arrays and names of a study folder, and its refusals."""

import numpy as np
import pytest
import thenar

STUDY = """
[study]
title = "Index fingertip"
[skin]
mesh = "skin.obj"
[skin.materials.default]
g0_mpa = 0.005
thickness_mm = 7.0
[indenters.rod]
shape = "cylinder"
radius_mm = 24.0
axis = [0.0, 2.0, 0.0]
[sites.pad]
point_mm = [0.5, 0.25, 0.0]
direction = [0.0, 0.0, -1.0]
[[recordings]]
name = "press"
kind = "indentation"
file = "press.csv"
indenter = "rod"
site = "pad"
protocol = "slow"
[[recordings]]
name = "mat"
kind = "pressure_map"
file = "mat.csv"
sensels = "sensels.csv"
motion = "press.csv"
indenter = "rod"
site = "pad"
[[recordings]]
name = "scan"
kind = "scan"
mesh = "skin.obj"
at_time_s = 3
indenter = "rod"
site = "pad"
[instrument]
pitch_mm = 1.27
first_touch_mm = 0.005
"""
FILES = {
    "study.toml": STUDY,
    "skin.obj": "v 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\n",
    "press.csv": "time_s,depth_mm,force_n\n0,0,0\n0.5,1,2\n",
    "mat.csv": "time_s,row,col,pressure_kpa\n0,0,0,3\n0,0,1,4\n1,0,0,\n1,0,1,5\n",
    "sensels.csv": "row,col,x_mm,y_mm,z_mm,area_mm2\n0,1,1.27,0,0,1.6\n0,0,0,0,0,1.6\n",
}


@pytest.fixture
def folder(tmp_path):
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    return tmp_path


def test_skin_tools_and_sites_are_arrays(folder):
    study = thenar.Study.load(folder)
    assert (study.title, study.folder, study.warnings) == ("Index fingertip", folder, [])
    assert study.skin.vertices_mm.shape == (3, 3) and study.skin.triangles.tolist() == [[0, 1, 2]]
    assert study.skin.regions is None and study.skin.materials.default.thickness_mm == 7.0
    assert study.indenters.rod.axis.tolist() == [0.0, 1.0, 0.0] and study.indenters.rod.radius_mm == 24.0
    assert study.sites.pad.direction.tolist() == [0.0, 0.0, -1.0]
    assert study.instrument.pitch_mm == 1.27 and study.instrument.noise_n is None
    assert study.instrument.first_touch_mm == 0.005 and study.instrument.position_mm is None


def test_recordings_are_arrays(folder):
    study = thenar.Study.load(str(folder))
    assert [(each.name, each.kind) for each in study.recordings] == [
        ("press", "indentation"),
        ("mat", "pressure_map"),
        ("scan", "scan"),
    ]
    press, mat, scan = study.recordings
    assert press.curve.channels.depth_mm.tolist() == [0.0, 1.0] and press.protocol == "slow"
    assert np.array_equal(mat.map.pressure_kpa, [[3.0, 4.0], [np.nan, 5.0]], equal_nan=True)
    assert mat.sensels.center_mm[:, 0].tolist() == [0.0, 1.27] and mat.sensels.area_mm2.tolist() == [1.6, 1.6]
    assert mat.motion.channels.force_n.tolist() == [0.0, 2.0]
    assert scan.vertices_mm.shape == (3, 3) and scan.at_time_s == 3.0
    assert study.recording("mat").name == "mat"
    with pytest.raises(KeyError):
        study.recording("nothing")


def test_refusals_name_file_line_and_remedy(folder):
    (folder / "study.toml").write_text(STUDY.replace("radius_mm", "radios_mm"))
    with pytest.raises(thenar.RecordingError, match=r"study\.toml, line 9: \[indenters\.rod\] has no radius_mm; give"):
        thenar.Study.load(folder)
    (folder / "study.toml").write_text(STUDY.replace("pitch_mm", "pich_mm"))
    with pytest.raises(
        thenar.RecordingError, match=r"'pich_mm' is no key of \[instrument\]; did you mean 'pitch_mm'\?"
    ):
        thenar.Study.load(folder)
    (folder / "study.toml").write_text(STUDY.replace("first_touch_mm = 0.005", "first_touch_mm = -0.005"))
    with pytest.raises(thenar.RecordingError, match=r"study\.toml, line \d+: .*first_touch_mm"):
        thenar.Study.load(folder)
    with pytest.raises(thenar.RecordingError, match="it is no folder; name the folder that holds study.toml"):
        thenar.Study.load(folder / "elsewhere")
    with pytest.raises(thenar.RecordingError, match="folder: expected a path, got int; give a text"):
        thenar.Study.load(3)
