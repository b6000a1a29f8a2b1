"""Grasps of a cylinder by the reference solve, drawn and diagnosed: what is concealed is named, and nothing else is."""

import json
import shutil

import numpy as np
import pytest
import thenar
from trial.grasps import drawn, mat, sample, solved

LARGEST_BYTES = 300_000


def diagnosed(kind, seed, folder):
    """Findings and truth of a study of three holds of the 60 mm cylinder."""
    case = drawn.Case(kind, seed, "cylinder_60", 3)
    drawn.write(case, folder)
    return json.loads(thenar.diagnose(thenar.Study.load(folder)).to_json()), case.truth


@pytest.mark.parametrize("kind", ["null", "loosening", "tightening"])
def test_posture_that_moves_is_no_cause(kind, tmp_path):
    found, _ = diagnosed(kind, 71, tmp_path)
    assert (found["verdict"], found["findings"]) == ("nothing_missing", []), found["sentence"]


@pytest.mark.parametrize("kind", ["relaxation", "gain", "dead", "ceiling", "floor"])
def test_one_concealed_effect_is_named_and_no_other(kind, tmp_path):
    found, truth = diagnosed(kind, 72, tmp_path)
    assert [each["effect"] for each in found["findings"]] == drawn.RIGHT[kind], (found["sentence"], truth)
    assert found["cannot_tell"] == []


def test_without_a_force_trace_relaxation_cannot_be_distinguished_from_drift(tmp_path):
    found, _ = diagnosed("relaxation_without_trace", 73, tmp_path)
    assert found["verdict"] == "cannot_tell" and set(found["cannot_tell"][0]) == {"relaxation", "drift"}
    assert "load cell" in found["record_next"][0]["text"]


def test_the_force_that_relaxes_is_removed_by_the_named_effect(tmp_path):
    case = drawn.Case("relaxation", 74, "cylinder_60", 3)
    drawn.write(case, tmp_path)
    found = thenar.diagnose(thenar.Study.load(tmp_path))
    for curve in found.curves:
        before, after = (np.std(curve.measured_n - each) for each in (curve.before_n, curve.after_n))
        assert after < 0.6 * before, (curve.recording, before, after)


def test_a_study_of_grasps_and_presses_is_refused_with_the_remedy(tmp_path):
    drawn.write(drawn.Case("null", 75, "cylinder_60", 2), tmp_path)
    study = tmp_path / "study.toml"
    study.write_text(
        study.read_text()
        + '[indenters.ball]\nshape = "sphere"\nradius_mm = 5.0\n[sites.pad]\npoint_mm = '
        + json.dumps(np.asarray(thenar.Study.load(tmp_path).skin.vertices_mm)[0].tolist())
        + '\ndirection = [0.0, 0.0, -1.0]\n[[recordings]]\nname = "press"\nkind = "indentation"\n'
        + 'file = "press.csv"\nindenter = "ball"\nsite = "pad"\n'
    )
    (tmp_path / "press.csv").write_text("time_s,depth_mm,force_n\n0,0,0\n1,1,1\n")
    with pytest.raises(thenar.RecordingError, match="'press' is no grasp; a study holds grasps or presses of a tool"):
        thenar.diagnose(thenar.Study.load(tmp_path))


def test_moduli_are_not_fitted_to_grasps(tmp_path):
    drawn.write(drawn.Case("null", 76, "cylinder_60", 2), tmp_path)
    with pytest.raises(thenar.RecordingError, match="diagnose the study"):
        thenar.compare(thenar.Study.load(tmp_path))


def test_the_mat_of_the_trial_reads_all_force_where_it_falls():
    layout = mat.Wrapped(np.zeros(3), np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), 30.0, 10, 38, 5.0)
    angle = (3.5 / 38) * 2 * np.pi
    place = np.array([[30.0 * np.cos(angle), 30.0 * np.sin(angle), 22.5]])
    read = layout.read(place, np.array([2.0]), np.array([4.0]))
    assert read.argmax() == 4 * 38 + 3
    np.testing.assert_allclose(read.sum() * layout.cell_mm2 / 1e3, 2.0)


def test_grasps_are_those_of_the_reference_solve():
    grasp = drawn.Grasp("cylinder_60")
    for kind in solved.TISSUES:
        forces = grasp.force[kind].sum(axis=1)
        assert (np.diff(forces) > 0.0).all(), "deeper postures bear more"
    given = grasp.force["as_given"].sum()
    assert grasp.force["softer"].sum() < given < grasp.force["stiffer"].sum()


def test_the_sample_is_what_its_command_makes_small_and_answered_as_drawn(tmp_path):
    truth = sample.make(tmp_path / "made")
    made, shipped = ({each.name: each for each in folder.iterdir()} for folder in (tmp_path / "made", sample.FOLDER))
    assert made.keys() == shipped.keys()
    assert made["study.toml"].read_text() == shipped["study.toml"].read_text()
    assert made["skin.ply"].read_bytes() == shipped["skin.ply"].read_bytes()
    assert sum(each.stat().st_size for each in shipped.values()) < LARGEST_BYTES
    shutil.copytree(sample.FOLDER, tmp_path / "copy")
    found = json.loads(thenar.diagnose(thenar.Study.load(tmp_path / "copy")).to_json())
    assert [each["effect"] for each in found["findings"]] == drawn.RIGHT[truth["kind"]], found["sentence"]
