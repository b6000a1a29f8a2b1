"""What an oracle could answer: against the closed form of a gain that changes, and the properties of a length."""

import numpy as np
import pytest
from trial import cases, protocols
from trial.drawing import make_cases
from trial.scoring import ceiling, following, score

SEALED = score.labels("calibration")


def about(name):
    return cases.index()[name]


def first(test):
    return next((name, label) for name, label in SEALED.items() if test(label))


def test_a_changed_gain_is_seen_as_well_as_its_scatter_allows():
    """Two halves of n presses that differ by a, each press of spread s: a sqrt(n) / (2 s); noise takes off."""
    for name, label in SEALED.items():
        if label["stratum"] == "decoy" and label["distortion"] == "gain":
            bound = label["amplitudes"][1] * np.sqrt(10.0) / 2.0 / make_cases.REPEAT_GAIN
            detect, _ = ceiling.separations(about(name), label)
            assert 0.6 * bound < detect < 1.02 * bound


def test_separation_grows_with_the_amplitude_and_is_none_without():
    name, label = first(lambda one: one["stratum"] == "single" and one["effect"] == "relaxation")
    case, amplitude = ceiling.Case(about(name), label), label["amplitudes"][0]
    none, half, whole = (
        np.linalg.norm(case.signature("relaxation", label["variant"], share * amplitude)) for share in (0.0, 0.5, 1.0)
    )
    assert none == 0.0 and half == pytest.approx(0.5 * whole, rel=0.1)


def test_a_name_is_never_easier_than_its_detection_and_parameters_are_no_cause():
    name, label = first(lambda one: one["stratum"] == "single" and one["effect"] == "drainage")
    detect, told = ceiling.separations(about(name), label)
    assert 0.0 < told <= detect
    case = ceiling.Case(about(name), label)
    stiffer = [1.3 * case.rest[k].force for k in case.kept]
    assert np.linalg.norm(case._free(stiffer)) < 0.02 * np.linalg.norm(case._white(stiffer))


def test_chances_at_the_thresholds_are_even():
    assert ceiling.chance(ceiling.SEEN, 99.0) == pytest.approx(0.5)
    assert ceiling.chance(99.0, ceiling.TOLD) == pytest.approx(0.5)


def test_what_a_pair_adds_to_one_of_both_is_no_more_than_all_it_adds():
    """A pair of which one half is nothing is that single effect, and the other half is not seen beside it."""
    name, label = first(lambda one: one["stratum"] == "pair")
    case = ceiling.Case(about(name), label)
    whole = np.linalg.norm(case.signature(label["effect"], label["variant"], label["amplitudes"]))
    assert all(0.0 < part <= whole + 1e-9 for part in ceiling.beside(about(name), label))
    name, label = first(lambda one: one["stratum"] == "mixed")
    one, other = ceiling.beside(about(name), label | {"amplitudes": [label["amplitudes"][0], 1e-9]})
    assert one < 1e-3 < 1.0 < other and ceiling.chance_of_both(one, other) < 1e-3


def test_what_is_seen_and_has_no_name_that_leads_is_left_open():
    assert ceiling.chance_of_neither(99.0, 1e-6) == pytest.approx(1.0)
    assert ceiling.chance_of_neither(0.0, 1e-6) < 1e-3 and ceiling.chance_of_neither(99.0, 30.0) < 1e-3


def test_more_recordings_never_tell_less():
    name, label = first(lambda one: one["stratum"] == "ambiguous" and one.get("effect") == "relaxation")
    before, best = ceiling.separations(about(name), label), ceiling.settled(name, label)
    held = {one: following.MOST for one in protocols.PROTOCOLS}
    assert before[1] < ceiling.TOLD and before[1] <= best[1] <= ceiling.separations(about(name), label, held)[1] + 1e-9


def test_an_error_that_looks_like_the_skin_is_seen_and_not_told():
    """A fixture that yields takes off as much of the force as tissue that gives up volume: seen, and hard to name."""
    looks = [
        ceiling.separations(about(name), label)
        for name, label in SEALED.items()
        if label.get("distortion") == "fixture_compliance" and label["stratum"] == "decoy"
    ]
    assert any(detect > ceiling.SEEN and told < 0.5 * detect for detect, told in looks)


def test_the_column_has_a_share_for_every_row_that_it_can_be_asked_about():
    strata = ("single", "decoy", "pair", "mixed", "ambiguous")
    some = [[one for one in SEALED.items() if one[1]["stratum"] == stratum][:4] for stratum in strata]
    chances = ceiling.chances(dict(sum(some, [])))
    rows = {row for row, _, _ in ceiling.ASKED.values()}
    assert {"severe", "instrument", "pairs", "mixed", "ambiguous"} <= chances.keys() <= rows | {"followed"}
    found = {row.key: row for row in ceiling.column(chances)}
    assert found["pairs"].of == found["mixed"].of == found["ambiguous"].of == 4
    assert all(0.0 <= row.value <= 1.0 for row in found.values())


def test_rich_are_the_cases_that_are_answered_nearly_always():
    found = ceiling.rich({"severe": {"a": 0.89, "b": 0.9, "c": 1.0}, "pairs": {"d": 0.1}})
    assert found == {"severe": ["b", "c"], "pairs": []}
