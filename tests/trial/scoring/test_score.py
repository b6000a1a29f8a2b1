"""The scorer notices: right verdicts pass every row; shuffled labels, effects that are not there, open gates do not."""

import json
import shutil

import numpy as np
import pytest
from trial.scoring import counts as scored
from trial.scoring import score


@pytest.fixture(scope="module")
def sealed():
    return score.labels("trial")


def right(label):
    """What a diagnosis that knows the label would say."""
    names, stratum = label["names"], label["stratum"]
    verdict = {"verdict": "missing_physics", "findings": [{"effect": name} for name in names], "names_90": [names]}
    verdict["fit"] = {"reducible_error_removed": {"value": 0.9}}
    if stratum == "local":
        verdict["findings"][0]["where"] = {"center_mm": label["center_mm"], "radius_mm": label["radius_mm"]}
    if stratum == "null":
        return {"verdict": "parameters", "findings": []}
    if stratum == "decoy":
        return verdict | {"verdict": "instrument"}
    if stratum == "unlisted":
        return {"verdict": "unlisted", "findings": []}
    if stratum == "ambiguous":
        return {"verdict": "cannot_tell", "findings": [], "cannot_tell": [names]}
    if stratum in ("poor", "faint"):
        return {"verdict": "insufficient_data", "findings": []}
    return verdict


def rows(sealed, said):
    return {row.key: row for row in scored.table(sealed, said)}


@pytest.mark.parametrize(
    ("hits", "of", "low", "high"), [(0, 10, 0.0, 0.2775), (1, 10, 0.0179, 0.4042), (81, 263, 0.2553, 0.3662)]
)
def test_wilson_bounds_are_the_published_ones(hits, of, low, high):
    """Brown, Cai & DasGupta 2001 and Newcombe 1998 (81 of 263, method 3)."""
    assert scored.wilson(hits, of) == pytest.approx((low, high), abs=1e-4)


def test_right_verdicts_meet_every_row(sealed):
    found = rows(sealed, {name: right(label) for name, label in sealed.items()})
    assert all(row.holds() is not False and row.reaches() is not False for row in found.values()), score.shown(
        found.values()
    )
    assert found["severe"].value == 1.0


def test_what_the_contact_model_makes_worse_counts_and_what_is_refused_is_counted_apart(sealed):
    said = {name: right(label) for name, label in sealed.items()}
    exact = [name for name, label in sealed.items() if label["stratum"] == "single" and label["kappa"] >= 1.0]
    for name, share, is_refused in zip(exact[:4], (0.9, 0.4, -0.3, -5.0), (False, False, False, True), strict=True):
        by = {"reducible_error_removed": {"value": share}, "is_worse_than_without": is_refused}
        said[name]["fit"]["by_contact_model"] = by
    found = rows(sealed, said)
    assert found["removed by contact"].value == pytest.approx(0.05)
    assert (found["worse by contact"].value, found["worse by contact"].of) == (0.5, 4)
    assert (found["worse switched on"].value, found["worse switched on"].of) == (pytest.approx(1 / 3), 3)


def test_shuffled_labels_collapse(sealed):
    names = list(sealed)
    turned = np.random.default_rng(1).permutation(len(names))
    said = {name: right(sealed[names[k]]) for name, k in zip(names, turned, strict=True)}
    found = rows(sealed, said)
    assert found["severe"].value < 0.2
    assert found["nulls"].value > 0.3
    assert found["wrong"].value > 0.3
    assert found["unlisted"].value < 0.3


def test_an_effect_of_no_severity_makes_its_name_a_false_alarm(sealed):
    said = {name: right(label) for name, label in sealed.items()}
    mutated = {
        name: label | {"stratum": "null", "names": [], "kappa": 0.0} if label["names"] == ["cycle_softening"] else label
        for name, label in sealed.items()
    }
    changed = sum(label["names"] == ["cycle_softening"] for label in sealed.values())
    found = rows(mutated, said)
    assert not found["nulls"].holds()
    assert found["wrong"].hits == changed > 10


def test_an_open_gate_shows(sealed):
    """A diagnosis that always names the effect that fits best: no refusal, no doubt, no silence."""
    said = {name: right(label) for name, label in sealed.items()}
    for name, label in sealed.items():
        if label["stratum"] in ("null", "unlisted", "ambiguous", "poor"):
            said[name] = {"verdict": "missing_physics", "findings": [{"effect": "relaxation"}]}
    found = rows(sealed, said)
    for name in ("nulls", "unlisted", "wrong"):
        assert not found[name].holds()
    assert found["ambiguous"].value == 0.0


def test_endings_of_ambiguous_cases_tell_a_truth_from_its_look_alike_and_from_neither(sealed):
    doubtful = {name: label for name, label in sealed.items() if label["stratum"] == "ambiguous"}
    said = {name: right(label) for name, label in doubtful.items()}
    first, second, third, fourth, fifth = list(doubtful)[:5]

    def name(case, effect):
        said[case] = {"verdict": "missing_physics", "findings": [{"effect": effect}]}

    (other,) = set(doubtful[second]["names"]) - {doubtful[second]["effect"]}
    name(first, doubtful[first]["effect"])
    name(second, other)
    name(third, "adhesion")
    said[fourth] = {"verdict": "nothing_missing", "findings": []}
    del said[fifth]
    assert dict(scored.endings(sealed, said)) == {
        "the right set": len(doubtful) - 5,
        "named what is true": 1,
        "named what imitates it": 1,
        "named something else": 1,
        "nothing missing": 1,
        "insufficient data": 1,
    }


def test_a_place_off_by_more_than_a_pitch_is_no_place(sealed):
    said = {name: right(label) for name, label in sealed.items()}
    for name, label in sealed.items():
        if label["stratum"] == "local":
            x, y, z = label["center_mm"]
            said[name]["findings"][0]["where"]["center_mm"] = [x + 1.01 * label["pitch_mm"], y, z]
    found = rows(sealed, said)
    assert found["spots"].value == 1.0
    assert not found["miss"].holds() and found["miss"].value > 1.0


def test_silence_is_scored_as_such(sealed):
    found = rows(sealed, {})
    assert found["answered"].value == 0.0 and found["severe"].value == 0.0
    assert found["nulls"].value == 0.0


def test_a_label_that_was_changed_is_refused(tmp_path):
    for name in ("cases.json", "labels.json", "local_cases.json", "local_labels.json"):
        shutil.copy(score.HERE / name, tmp_path / name)
    sealed = json.loads((tmp_path / "labels.json").read_text())
    first = next(iter(sealed["labels"]))
    sealed["labels"][first]["names"] = ["friction"]
    (tmp_path / "labels.json").write_text(json.dumps(sealed))
    with pytest.raises(ValueError, match=f"the label of {first} is not the one sealed"):
        score.labels("trial", tmp_path)


def test_verdicts_are_read_by_case(tmp_path, sealed):
    one, two, *_ = sealed
    (tmp_path / one).mkdir()
    (tmp_path / one / "findings.json").write_text('{"verdict": "instrument", "findings": [{"effect": "gain"}]}')
    (tmp_path / f"{two}.json").write_text('{"verdict": "unlisted", "findings": []}')
    said = score.verdicts(tmp_path, sealed)
    assert set(said) == {one, two} and scored.named(said[one]) == {"gain"}


def test_a_choice_between_effects_of_the_skin_blames_the_skin():
    def undecided(*names):
        return {"verdict": "cannot_tell", "findings": [], "cannot_tell": [list(names)]}

    assert scored.blames_skin(undecided("relaxation", "drainage"))
    assert not scored.blames_skin(undecided("relaxation", "drift"))


def test_wrong_names_are_told_with_what_they_stand_beside(sealed):
    said = {name: right(label) for name, label in sealed.items()}
    assert scored.wrong_names(sealed, said) == []
    assert all(hits == of for _, hits, of in scored.exact_by_effect(sealed, said))
    severe = [name for name, label in sealed.items() if label["stratum"] == "single" and label["kappa"] >= 1.0]
    first, second = [name for name in severe if sealed[name]["effect"] == "adhesion"][:2]
    said[first] = said[first] | {"findings": [{"effect": "adhesion"}, {"effect": "drift"}]}
    said[second] = said[second] | {"findings": [{"effect": "drift"}]}
    assert scored.wrong_names(sealed, said) == [("adhesion", "drift", False, 1), ("adhesion", "drift", True, 1)]
    by_effect = {effect: (hits, of) for effect, hits, of in scored.exact_by_effect(sealed, said)}
    hits, of = by_effect["adhesion"]
    assert hits == of - 2 and sum(of for _, of in by_effect.values()) == rows(sealed, said)["severe"].of
