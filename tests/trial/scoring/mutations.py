"""Shows that the table notices: the same verdicts with a gate open, labels shuffled, or recordings without the effect.

All in memory; nothing that was kept is changed. A mutation counts as noticed if each of its rows leaves the 95 % bounds
that it had before, to the worse.
"""

import numpy as np
from trial.scoring import counts
from trial.scoring.counts import Answers
from trial.scoring.findings import TISSUE

NOTICE = {"gates": ("nulls", "wrong"), "labels": ("severe", "wrong"), "severity": ("severe",)}


def leading(verdict):
    """The effect that a verdict holds for the most likely although it does not name it; None if it tells of none."""
    told = [name for one in verdict.get("rivals", []) for name in one["effects"]]
    told += [name for names in verdict.get("names_90", []) + verdict.get("cannot_tell", []) for name in names]
    return next((name for name in told if name), None)


def gates(sealed, said):
    """Every verdict names the effect that leads, whatever its gates said."""
    found = {}
    for name, verdict in said.items():
        effect = leading(verdict)
        if not counts.named(verdict) and effect:
            kind = "missing_physics" if effect in TISSUE else "instrument"
            verdict = verdict | {"verdict": kind, "findings": [{"effect": effect}]}
        found[name] = verdict
    return sealed, found


def labels(sealed, said):
    """Every label on another case."""
    names = list(sealed)
    turned = np.random.default_rng(1).permutation(len(names))
    return {name: sealed[names[k]] for name, k in zip(names, turned, strict=True)}, said


def severity(sealed, said):
    """Cases of one effect get what was said of recordings in which nothing is missing."""
    nulls = [said[name] for name, label in sealed.items() if label["stratum"] == "null" and name in said]
    found, number = dict(said), 0
    for name, label in sealed.items():
        if label["stratum"] == "single" and nulls:
            found[name] = nulls[number % len(nulls)]
            number += 1
    return sealed, found


MUTATIONS = {one.__name__: one for one in (gates, labels, severity)}


def mutated(how, sealed, answers):
    """The table after a mutation."""
    sealed, said = MUTATIONS[how](sealed, answers.said)
    return counts.table(sealed, Answers(said))


def is_noticed(how, before, after):
    """Whether each row that the mutation must spoil is worse than its bounds before."""
    first, second = ({row.key: row for row in table} for table in (before, after))
    return all(_is_worse(first[key], second[key]) for key in NOTICE[how])


def _is_worse(before, after):
    low, high = before.bounds
    return after.value > high if before.is_ceiling else after.value < low
