"""Verdicts of calibration and trial cases are those that were frozen (see frozen.py)."""

import copy

import pytest
from trial import cases
from trial.frozen_verdicts import frozen


@pytest.fixture(scope="module", autouse=True)
def rewritten():
    """THENAR_FREEZE writes the table anew before it is compared."""
    if (wanted := frozen.asked()) is not None:
        frozen.write({case: frozen.names(frozen.said(case)) for case in wanted})


@pytest.mark.parametrize("case", frozen.table())
def test_verdict_is_the_frozen_one(case):
    assert frozen.names(frozen.said(case)) == frozen.table()[case]


def test_both_splits_and_every_kind_of_verdict_are_held():
    held = frozen.table()
    splits = {cases.index()[case]["split"] for case in held}
    assert {"trial", "calibration"} <= splits
    kinds = {one["verdict"] for one in held.values()}
    assert {"parameters", "missing_physics", "instrument", "cannot_tell", "unlisted", "insufficient_data"} <= kinds


def test_another_name_is_another_verdict():
    verdict = {"verdict": "missing_physics", "findings": [{"effect": "drift"}], "cannot_tell": [], "sentence": "x"}
    for key, other in (("verdict", "unlisted"), ("findings", []), ("cannot_tell", [["relaxation", "drainage"]])):
        changed = copy.deepcopy(verdict) | {key: other}
        assert frozen.names(changed) != frozen.names(verdict)
    assert frozen.names(verdict | {"sentence": "y"}) == frozen.names(verdict)


@pytest.mark.parametrize(
    ("case", "effect"), [("case_228", "stiffening_law"), ("case_291", "drainage"), ("case_051", "drift")]
)
def test_contact_model_removes_what_the_fit_does(case, effect):
    """Before: -3.3 of 0.5 (no numbers sought), 0.58 of 1.00 (a half space's drainage), 0.13 of 0.99 (an even drift)."""
    said = frozen.said(case)
    assert [one["effect"] for one in said["findings"]] == [effect]
    tried = said["fit"]["by_contact_model"]
    assert tried["reducible_error_removed"]["value"] > 0.8 * tried["removed_by_the_fit"] > 0.0
    assert not tried["is_behind_the_fit"]
