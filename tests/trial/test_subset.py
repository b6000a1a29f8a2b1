"""Scores the fixed subset of the trial with the built binary, as CI does; skipped where none is that diagnoses."""

import functools
import os
from pathlib import Path

import pytest
from trial import cases, prove, running, subset
from trial.scoring import counts, score

ROOT = Path(__file__).parents[2]
PROGRAM = ROOT / "target/release/thenar"
OUT = ROOT / "target/prove"
THENAR = prove.Who(prove.THENAR, PROGRAM)


def reason():
    """Why the subset cannot be run; empty if it can."""
    if not PROGRAM.exists():
        return f"{PROGRAM} is not there; run `cargo xtask setup`"
    return "" if running.Binary(PROGRAM).is_able() else f"{PROGRAM} has no command `diagnose`"


WHY = reason()
pytestmark = pytest.mark.skipif(bool(WHY), reason=WHY)


@pytest.fixture(scope="module")
def names():
    """The subset, every case of it answered; what was answered before is kept (target/prove)."""
    OUT.mkdir(parents=True, exist_ok=True)
    chosen = subset.fixed("trial")
    running.each(functools.partial(prove.job, THENAR, OUT), chosen, os.cpu_count(), "subset")
    return chosen


@pytest.fixture(scope="module")
def table(names):
    sealed = {name: label for name, label in score.labels("trial").items() if name in set(names)}
    found = counts.table(sealed, prove.answers(THENAR, OUT, names))
    print(score.shown(found))
    return {row.key: row for row in found}


def test_every_case_ends_well_and_writes_what_it_must(names):
    assert prove.wrong_endings(THENAR, OUT, names) == []


def test_one_recording_without_repeats_names_nothing(names):
    """The public index alone tells which these are."""
    said = prove.answers(THENAR, OUT, names).said
    poor = [name for name in names if cases.index()[name].get("repeats") == 1]
    assert poor and not any(counts.named(said[name]) for name in poor)


def test_nothing_is_blamed_on_skin_that_lacks_nothing(table):
    assert table["nulls"].of >= 5 and table["nulls"].hits == 0


def test_the_table_is_whole(table):
    assert table["answered"].value == 1.0
    assert all(row.of for key, row in table.items() if key in ("severe", "wrong", "ambiguous", "sets"))
