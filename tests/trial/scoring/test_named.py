"""`thenar.diagnose` on the calibration's finite elements: silence, names, instruments, clocks, what has no name."""

import json
import os
import subprocess
import sys
import tomllib

import numpy as np
import pytest
import thenar
from trial import cases, protocols
from trial.frozen_verdicts import frozen

# Cases of the calibration split by what they hold; their labels are opened by score.py alone.
SILENT = ("case_462", "case_157", "case_189", "case_447")
NAMED = {
    "case_132": "relaxation",
    "case_061": "cycle_softening",
    "case_274": "rate_independent_loss",
    "case_278": "stiff_skin",
}
WEAK = {"case_147": "stiff_skin", "case_331": "stiff_skin"}  # half as large as the noise; of 9 and 6 nats
SKINS = {"case_278": (0.7, 0.348)}  # planted: thickness in mm, Young's modulus in MPa
POCKETS, PULSES = ("case_317", "case_162"), ("case_056",)
READ = {"case_015": "saturation", "case_020": "timing", "case_294": "threshold"}
FLOORS = {"case_073": 0.0455, "case_419": 0.0229}  # planted, N


def found(case, folder):
    cases.write(case, folder)
    return frozen.said(case)


@pytest.mark.parametrize("case", SILENT)
def test_where_nothing_is_planted_nothing_is_claimed(case, tmp_path):
    said = found(case, tmp_path)
    assert said["verdict"] in ("nothing_missing", "parameters") and said["findings"] == []
    assert said["smallest_seen"]["relaxation"]["value"] > 0.0


@pytest.mark.parametrize("case", NAMED)
def test_an_effect_of_the_skin_is_named_and_predicts_what_was_held_out(case, tmp_path):
    said = found(case, tmp_path)
    assert [one["effect"] for one in said["findings"]] == [NAMED[case]]
    assert said["verdict"] == "missing_physics" and [NAMED[case]] in said["names_90"]
    fit = said["fit"]
    assert fit["held_out_by"] == "protocol" and fit["reducible_error_removed"]["value"] > 0.5
    assert fit["log_score"]["value"] > fit["log_score"]["placebo"]


@pytest.mark.parametrize("case", WEAK)
def test_an_effect_below_the_noise_is_named_if_held_out_recordings_confirm_it(case, tmp_path):
    """Squared errors hardly show it, since the noise is slow and larger; held-out recordings are likelier with it."""
    said = found(case, tmp_path)
    assert [one["effect"] for one in said["findings"]] == [WEAK[case]]
    assert "100 %" not in said["sentence"] and "small against the noise" in said["sentence"]
    worse = said["fit"]["by_contact_model"]["is_worse_than_without"]
    assert worse == ("Do not simulate with it" in said["sentence"])
    score = said["fit"]["log_score"]
    assert score["value"] > max(4.0, 2.0 * score["placebo"])


def test_a_name_that_held_out_recordings_hardly_confirm_is_only_suspected(tmp_path):
    """A pocket that collapses: softening by use explains 7.5 nats of it, of which half are confirmed."""
    said = found("case_312", tmp_path)
    assert said["findings"] == [] and said["suspected"] == ["cycle_softening"]


def test_a_ceiling_that_one_protocol_alone_reaches_is_confirmed_by_its_repeats(tmp_path):
    """No other protocol can predict it. A case of the second trial."""
    said = found("second_377", tmp_path)
    assert [one["effect"] for one in said["findings"]] == ["saturation"] and said["verdict"] == "instrument"
    score = said["fit"]["log_score"]
    assert said["fit"]["held_out_by"] == "repeat" and score["value"] > max(40.0, score["placebo"])


@pytest.mark.parametrize("case", SKINS)
def test_a_stiff_skin_bends_as_the_one_that_was_planted(case, tmp_path):
    """What is seen first is its stiffness against bending, E t^3 / 9; thickness and modulus by themselves less."""
    (finding,) = found(case, tmp_path)["findings"]
    told, (thickness_mm, modulus_mpa) = finding["parameters"], SKINS[case]
    bending = told["modulus_mpa"]["value"] * told["thickness_mm"]["value"] ** 3
    assert 0.6 < bending / (modulus_mpa * thickness_mm**3) < 1.6
    low, high = (finding["parameters"]["thickness_mm"][end] for end in ("low", "high"))
    assert (low is None or low < thickness_mm) and (high is None or thickness_mm < high)


@pytest.mark.parametrize("case", READ)
def test_an_instrument_is_not_blamed_on_the_skin(case, tmp_path):
    said = found(case, tmp_path)
    assert said["verdict"] == "instrument" and [one["effect"] for one in said["findings"]] == [READ[case]]


@pytest.mark.parametrize("case", FLOORS)
def test_a_floor_is_told_where_it_was_planted(case, tmp_path):
    """Where a sensor begins to read depends on first touch: it is stated as the trial judges it, to 17 um."""
    cases.write(case, tmp_path)
    with (tmp_path / "study.toml").open("a") as study:
        study.write("[instrument]\nfirst_touch_mm = 0.017\n")
    (finding,) = json.loads(thenar.diagnose(thenar.Study.load(tmp_path)).to_json())["findings"]
    assert finding["effect"] == "threshold"
    assert finding["parameters"]["floor_n"]["value"] == pytest.approx(FLOORS[case], rel=0.12)


@pytest.mark.parametrize("case", ["case_189", "case_462"])
def test_a_floor_is_seen_from_the_size_that_is_told_and_not_far_below(case, tmp_path):
    least = found(case, tmp_path)["smallest_seen"]["threshold"]["value"]
    for size, is_seen in ((1.2, True), (0.3, False)):
        study = tmp_path / str(size)
        cases.write(case, study)
        for path in study.glob("press_*.csv"):
            head, *rows = path.read_text().splitlines()
            cells = (row.rsplit(",", 1) for row in rows)
            read = [f"{way},{force if abs(float(force)) >= size * least else 0.0}" for way, force in cells]
            path.write_text("\n".join([head, *read]) + "\n")
        said = json.loads(thenar.diagnose(thenar.Study.load(study)).to_json())
        assert ([one["effect"] for one in said["findings"]] == ["threshold"]) == is_seen


def test_one_sphere_does_not_tell_drainage_from_relaxation_and_another_is_asked_for(tmp_path):
    """Only the contact's size tells the clocks apart: the next recording is with a tool that was not used."""
    said = found("case_478", tmp_path)
    assert said["verdict"] == "cannot_tell" and ["relaxation", "drainage"] in said["cannot_tell"]
    used = {one["indenter"] for one in _recordings(tmp_path)}
    asked = said["record_next"][0]["protocol"]
    assert asked["indenter"] is not None and asked["indenter"] not in used
    assert said["record_next"][0]["settles"] == ["relaxation", "drainage"]
    # Each press takes its rest of 5 minutes; where a tool in use is pressed in turn, twice as many are made.
    presses = asked["presses"] * (2 if asked["in_turn_with"] else 1)
    assert presses >= 2 and said["record_next"][0]["minutes"] > 5.0 * presses
    assert "% of cases" in said["sentence"]
    assert 0.0 < said["record_next"][0]["probability"] < 1.0 and asked["in_turn_with"] in {None, *used}


def test_what_every_explanation_holds_is_told(tmp_path):
    """A sensor that drifts beside what fades, by one clock or the other."""
    said = found("case_181", tmp_path)
    assert said["verdict"] == "cannot_tell" and said["cannot_tell"] == [["relaxation", "drainage"]]
    assert "each of them together with drift of the sensor" in said["sentence"]


@pytest.mark.parametrize("case", POCKETS)
def test_a_pocket_that_gives_way_has_no_name_and_goes_with_depth(case, tmp_path):
    """It gives way at 0.55 of the depth: there an empirical correction falls most."""
    said = found(case, tmp_path)
    assert said["verdict"] == "unlisted" and said["findings"] == []
    correction = said["unlisted"]["correction"]
    assert said["unlisted"]["depends_on"][0]["on"] == correction["by"] == "depth"
    assert correction["kind"] == "empirical" and correction["removed"] > 0.5
    falls = np.diff(correction["factor_in"])
    steepest = falls.argmin()
    at = 0.55 * protocols.depth(cases.index()[case]["pad"])
    assert correction["at"][max(steepest - 1, 0)] < at < correction["at"][min(steepest + 2, len(falls))]


@pytest.mark.parametrize("case", [*PULSES, "case_400"])
def test_a_pulse_has_no_name(case, tmp_path):
    said = found(case, tmp_path)
    assert said["verdict"] == "unlisted" and said["findings"] == [] and said["unlisted"]["correction"] is None


@pytest.mark.parametrize("case", PULSES)
def test_a_pulse_is_told_by_its_rhythm(case, tmp_path):
    said = found(case, tmp_path)
    assert said["unlisted"]["rhythm"]["hz"] == pytest.approx(1.2, abs=0.08)
    assert said["unlisted"]["rhythm"]["chance"] < 0.005 and "a minute" in said["sentence"]


def test_slight_evidence_that_predicts_nothing_is_no_name(tmp_path):
    """A load cell that hums: softening would explain a little, and held-out recordings worse than nothing does."""
    said = found("case_312", tmp_path)
    assert said["findings"] == [] and said["verdict"] != "missing_physics"
    alone = {one["effects"][0]: one["evidence"] for one in said["rivals"] if len(one["effects"]) == 1}
    assert 5.0 < alone["cycle_softening"] < 8.0 and "hardly better than without" in said["notes"][0]


def test_one_recording_is_too_little(tmp_path):
    assert found("case_479", tmp_path)["verdict"] == "insufficient_data"


def _recordings(folder):
    return tomllib.loads((folder / "study.toml").read_text())["recordings"]


def test_a_diagnosis_is_the_same_to_the_byte_with_any_number_of_threads(tmp_path):
    cases.write("case_340", tmp_path)
    code = "import sys, thenar; print(thenar.diagnose(thenar.Study.load(sys.argv[1])).to_json())"
    told = []
    for threads in ("1", "3"):
        ask = [sys.executable, "-c", code, str(tmp_path)]
        ended = subprocess.run(ask, capture_output=True, check=True, env={**os.environ, "RAYON_NUM_THREADS": threads})
        told.append(ended.stdout)
    assert told[0] == told[1] and json.loads(told[0])["rivals"]
