"""Accusations are counted as they are defined, with a program in the place of the diagnosis."""

import json
import sys

import pytest
from trial.worlds import accusations
from trial.worlds.accusations import Asked

PROGRAM = """#!{python}
import json, pathlib, sys
assert sys.argv[1] == "diagnose" and (pathlib.Path(sys.argv[2]) / "study.toml").exists()
out = pathlib.Path(sys.argv[4])
out.mkdir()
(out / "findings.json").write_text({said!r})
"""


def program(folder, verdict, effects=(), cannot_tell=()):
    """A program that always gives this verdict."""
    said = {"verdict": verdict, "findings": [{"effect": e} for e in effects], "cannot_tell": list(cannot_tell)}
    path = folder / "program"
    path.write_text(PROGRAM.format(python=sys.executable, said=json.dumps(said)))
    path.chmod(0o755)
    return str(path)


def asked(program, truth="nothing", world="finite_element_pads", keep=None):
    """One case with white noise."""
    noise = "white" if world == "closed_forms" else "laboratory"
    return Asked(world, 1, truth, noise, program, keep)


def test_a_verdict_is_kept_and_not_asked_for_again(tmp_path):
    first = asked(program(tmp_path, "cannot_tell", cannot_tell=[["bone", "drift"], ["bone", "offset"]]), keep=tmp_path)
    assert accusations.answer(first) == ("cannot_tell", ["bone", "drift", "offset"])
    again = asked(program(tmp_path, "parameters"), keep=tmp_path)
    assert accusations.answer(again) == ("cannot_tell", ["bone", "drift", "offset"])


@pytest.mark.parametrize(
    "case",
    [
        Asked("closed_forms", 12, "nothing", "white", "", "DIR"),
        Asked("closed_forms", 12, "saturation", "depth_jitter", "", "DIR", "kinked"),
        Asked("finite_element_pads", 3, "cycle_softening", "slow", "", "DIR"),
        Asked("laboratory_fingertips", 4, "relaxation_and_mat_ceiling", "remounted", "", "DIR"),
    ],
)
def test_the_file_of_a_verdict_says_which_case_it_is(case):
    found = Asked.of_kept(case.kept().stem)
    assert [getattr(found, of) for of in ("world", "seed", "truth", "noise", "motion")] == [
        getattr(case, of) for of in ("world", "seed", "truth", "noise", "motion")
    ]


def test_a_world_may_have_its_own_names_of_findings(tmp_path):
    ceiling = {"effect": "saturation", "channel": "map"}
    (tmp_path / "laboratory_fingertips_mat_ceiling_laboratory_1.json").write_text(
        json.dumps({"verdict": "instrument", "findings": [ceiling], "cannot_tell": []})
    )
    case = Asked("laboratory_fingertips", 1, "mat_ceiling", "laboratory", "", str(tmp_path))
    assert accusations.answer(case) == ("instrument", ["mat_ceiling"])


def test_what_is_only_suspected_is_counted(tmp_path):
    cases = [Asked("closed_forms", seed, "nothing", "white", "", str(tmp_path)) for seed in (1, 2, 3)]
    for case, names in zip(cases, (["saturation"], ["saturation", "drift"]), strict=False):
        case.kept().write_text(json.dumps({"suspected": names}))
    assert accusations.suspected(cases) == {"saturation": 2, "drift": 1}


def test_a_program_that_fails_is_a_fault_and_is_not_kept(tmp_path):
    found = accusations.answer(asked("/bin/false", keep=tmp_path / "kept"))
    assert found[0] == "fault" and "exit code 1" in found[1][0]
    assert not (tmp_path / "kept").exists()


@pytest.mark.parametrize(
    ("world", "truth", "verdict", "names", "wanted"),
    [
        ("closed_forms", "nothing", "parameters", [], "right"),
        ("closed_forms", "nothing", "cannot_tell", ["bone", "drift"], "wrong"),
        ("closed_forms", "relaxation", "cannot_tell", ["drainage", "relaxation"], "missed"),
        ("closed_forms", "relaxation", "missing_physics", ["relaxation"], "right"),
        ("closed_forms", "relaxation", "missing_physics", ["bone", "relaxation"], "wrong"),
        ("closed_forms", "relaxation", "parameters", [], "missed"),
        ("closed_forms", "relaxation_and_saturation", "missing_physics", ["relaxation", "saturation"], "right"),
        ("closed_forms", "relaxation_and_saturation", "missing_physics", ["relaxation"], "missed"),
        ("closed_forms", "relaxation_and_saturation", "missing_physics", ["drift", "relaxation"], "wrong"),
        ("closed_forms", "stranger", "unlisted", [], "right"),
        ("closed_forms", "stranger", "parameters", [], "missed"),
        ("closed_forms", "stranger", "cannot_tell", ["bone", "drift"], "missed"),
        ("closed_forms", "stranger", "missing_physics", ["bone"], "wrong"),
        ("finite_element_pads", "exponential", "missing_physics", ["stiffening_law"], "right"),
        ("finite_element_pads", "nothing", "missing_physics", ["stiffening_law"], "wrong"),
        ("finite_element_pads", "stranger", "unlisted", [], "right"),
        ("finite_element_pads", "stranger", "parameters", [], "missed"),
        ("finite_element_pads", "stranger", "cannot_tell", ["drift", "relaxation"], "missed"),
        ("finite_element_pads", "stranger", "instrument", ["drift"], "wrong"),
        ("finite_element_pads", "relaxation_and_saturation", "missing_physics", ["relaxation", "saturation"], "right"),
        ("finite_element_pads", "relaxation_and_saturation", "cannot_tell", ["drainage", "relaxation"], "missed"),
        ("finite_element_pads", "relaxation_and_saturation", "instrument", ["drift"], "wrong"),
        ("laboratory_fingertips", "exponential", "missing_physics", ["stiffening_law"], "right"),
        ("laboratory_fingertips", "nothing", "missing_physics", ["stiffening_law"], "wrong"),
    ],
)
def test_each_world_judges_by_its_own_rules(world, truth, verdict, names, wanted):
    assert accusations.judged(asked("none", truth, world), verdict, names) == wanted


def test_bounds_are_those_of_clopper_and_pearson():
    # With none of n, (1 - p)^n = 0.025; with all, p^n = 0.025.
    low, high = accusations.bounds(0, 60)
    assert low == 0.0 and (1.0 - high) ** 60 == pytest.approx(0.025)
    low, high = accusations.bounds(12, 12)
    assert high == 1.0 and low**12 == pytest.approx(0.025)


def test_a_table_of_accusations_ends_with_1(tmp_path, monkeypatch, capsys):
    line = ["accusations.py", "--world", "finite_element_pads", "--cases", "2", "--noises", "slow", "--workers", "1"]
    monkeypatch.setattr(sys, "argv", [*line, "--program", program(tmp_path, "unlisted")])
    assert accusations.main() == 1
    assert "nothing: wrong in 2 of 2" in capsys.readouterr().out
    monkeypatch.setattr(sys, "argv", [*line, "--program", program(tmp_path, "parameters")])
    assert accusations.main() == 0
    assert "nothing: right in 2 of 2" in capsys.readouterr().out


def test_a_truth_that_a_world_has_not_is_refused(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["accusations.py", "--truth", "bone"])
    with pytest.raises(SystemExit):
        accusations.arguments()
    assert "closed_forms has the truths nothing, relaxation" in capsys.readouterr().err
    monkeypatch.setattr(sys, "argv", ["accusations.py", "--truth", "relaxation", "--motion", "sine"])
    with pytest.raises(SystemExit):
        accusations.arguments()
    assert "closed_forms has no relaxation with the motion sine" in capsys.readouterr().err
