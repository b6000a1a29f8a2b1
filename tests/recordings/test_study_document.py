"""addon/docs/study_format.md: its example loads, with every key that it shows."""

from pathlib import Path

import pytest
import thenar

DOCUMENT = Path(__file__).parents[2] / "addon/docs/study_format.md"
FILES = {
    "skin.ply": "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n2 0 0\n0 2 0\n3 0 1 2\n",
    "regions.csv": "vertex,region\n0,pad\n1,pad\n2,pad\n",
    "slow_1.csv": "time_s,depth_mm,force_n\n0,0,0\n0.5,1,2\n",
    "mat.csv": "time_s,row,col,pressure_kpa\n0,0,0,3\n0,0,1,4\n1,0,0,\n1,0,1,5\n",
    "sensels.csv": "row,col,x_mm,y_mm,z_mm,area_mm2\n0,1,1.27,0,0,1.6\n0,0,0,0,0,1.6\n",
}


@pytest.fixture
def folder(tmp_path):
    example = DOCUMENT.read_text().split("```toml\n")[1].split("```")[0]
    for name, text in {**FILES, "scan_2mm.ply": FILES["skin.ply"], "study.toml": example}.items():
        (tmp_path / name).write_text(text)
    return tmp_path


def test_the_example_loads(folder):
    study = thenar.Study.load(folder)
    assert study.title == "Index fingertip, subject 3"
    assert [recording["kind"] for recording in study.recordings] == ["indentation", "pressure_map", "scan"]
    assert study.instrument["saturation_kpa"] == 200.0


def test_a_key_that_the_document_does_not_show_is_refused(folder):
    text = (folder / "study.toml").read_text()
    (folder / "study.toml").write_text(text.replace("gain_percent", "gain_percents"))
    with pytest.raises(thenar.RecordingError, match="gain_percents"):
        thenar.Study.load(folder)
