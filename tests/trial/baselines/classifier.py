"""A classifier trained on simulations (simulated.npz, by Thenar's own effects) and on the calibration's labelled cases.

Gradient boosting on what the refitted base leaves in stretches of every protocol. It rejects: where its best two
classes hold too little of the probability it says that the cause is on no list. The trial's labels are never read; a
case of the calibration is answered by a model that was trained without its fold.
"""

import functools
import tempfile
from pathlib import Path

import numpy as np
from sklearn.ensemble import HistGradientBoostingClassifier
from trial import cases
from trial.baselines import bic, examples, verdict
from trial.baselines.curves import read
from trial.baselines.stretches import stretches
from trial.scoring import score

SURE, BOTH = 0.5, 0.75  # probability from which one class, or the best two together, are believed
FOLDS = 3
WEIGHT = 3.0  # of a labelled case against a simulated one
NOTHING = "none"


class Classifier:
    """The classifier (see `running`)."""

    rows = verdict.ALL - {
        *("pairs", "mixed", "spots", "miss", "spot sets", "overlap", "followed", "random"),
        *("removed", "worse", "removed by any", "nulls, maps"),
    }

    def __init__(self, case=None):
        self.key = bic.key(__file__, examples.__file__, examples.TABLE, stretches.__code__.co_filename)
        self.fold = fold(case) if case in set(cases.names("calibration")) else None

    def diagnose(self, study, out):
        """Writes out/findings.json."""
        curves = read(Path(study))
        found = verdict.silent("there is no curve of a sphere") if curves is None else said(curves, trained(self.fold))
        verdict.write(out, found)


def said(curves, model):
    """The verdict on a study's curves."""
    chance = model.predict_proba(stretches(curves)[None])[0]
    order = np.argsort(-chance)
    first, second = (str(model.classes_[k]) for k in order[:2])
    most, both = chance[order[0]], chance[order[:2]].sum()
    if most >= SURE:
        found = verdict.of_names([{"effect": first, "confidence": float(most)}] if first != NOTHING else [])
    elif both >= BOTH and NOTHING not in (first, second):
        found = verdict.undecided(first, second)
    else:
        found = verdict.unlisted(f"No class is likely; the best is {first}.")
    count = int(np.searchsorted(np.cumsum(chance[order]), 0.9)) + 1
    kept = [str(model.classes_[k]) for k in order[:count]]
    return found | {"names_90": [[] if name == NOTHING else [name] for name in kept]}


def fold(case):
    """Which part of the calibration a case belongs to."""
    return cases.names("calibration").index(case) % FOLDS


@functools.cache
def trained(without):
    """The model, trained without one fold of the calibration (None: with all)."""
    many, names = examples.drawn()
    more, told, folds = labelled()
    kept = folds != without if without is not None else np.ones(len(told), dtype=bool)
    weights = np.concatenate([np.ones(len(names)), np.full(kept.sum(), WEIGHT)])
    model = HistGradientBoostingClassifier(max_iter=60, learning_rate=0.1, max_leaf_nodes=15, random_state=1)
    return model.fit(np.concatenate([many, more[kept]]), np.concatenate([names, told[kept]]), sample_weight=weights)


@functools.cache
def labelled():
    """(features, class, fold) of the calibration's cases of one cause or none, as curves."""
    found = []
    for case, label in score.labels("calibration").items():
        if label["stratum"] not in ("null", "single", "decoy") or "mat" in cases.index()[case]:
            continue
        with tempfile.TemporaryDirectory() as folder:
            cases.write(case, folder)
            features = stretches(read(Path(folder)))
        found.append((features, label["names"][0] if label["names"] else NOTHING, fold(case)))
    features, names, folds = zip(*found, strict=True)
    return np.stack(features), np.array(names), np.array(folds)
