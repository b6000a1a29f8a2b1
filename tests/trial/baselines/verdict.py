"""Writes what a baseline says as findings.json, and the gain on what was held out."""

import json

import numpy as np
from trial.scoring.findings import TISSUE

ALL = {
    *("nulls", "decoys", "instrument", "severe", "mild", "wrong", "pairs", "mixed", "unlisted", "ambiguous", "poor"),
    *("nulls, normal", "nulls, outliers", "nulls, slow", "nulls, wide", "nulls, maps"),
    *("followed", "random", "sets", "sizes", "spots", "miss", "spot sets", "overlap"),
    *("removed", "worse", "removed by any", "answered"),
}
PARTS = ("before", "after", "noise_floor")


def silent(reason):
    """Says nothing."""
    return _whole("insufficient_data", reason, [])


def of_names(names):
    """The verdict that goes with findings (name and confidence each)."""
    found = [{**one, "kind": "tissue" if one["effect"] in TISSUE else "instrument"} for one in names]
    if not found:
        return _whole("parameters", "Nothing on the list improves the fit.", [])
    told = "missing_physics" if any(one["kind"] == "tissue" for one in found) else "instrument"
    return _whole(told, "Named: " + ", ".join(one["effect"] for one in found) + ".", found)


def unlisted(reason):
    """Something is missing that it has no name for."""
    return _whole("unlisted", reason, [])


def undecided(first, second):
    """Two that cannot be told apart."""
    found = _whole("cannot_tell", f"It cannot tell {first} from {second}.", [])
    return found | {"cannot_tell": [[first, second]]}


def _whole(verdict, sentence, findings):
    whole = {"schema": 1, "verdict": verdict, "sentence": sentence, "findings": findings}
    return whole | {"names_90": [], "cannot_tell": [], "record_next": []}


def errors(problem, before, after):
    """Sums of squares over held-out recordings: before, after, and of one repeat against another (halved)."""
    here, scale = problem.there, problem.scale
    left = [(((problem.measured - model) / scale)[here] ** 2).sum() for model in (before, after)]
    protocols, floor = np.array(problem.curves.protocols), 0.0
    for protocol in set(protocols):
        rows = np.flatnonzero(protocols == protocol)
        both = here[rows].all(axis=0)
        spread = (problem.measured[rows] / scale[rows])[:, both]
        floor += ((spread - spread.mean(axis=0)) ** 2).sum() * len(rows) / max(len(rows) - 1, 1)
    return np.array([*left, floor])


def gain(sums, held):
    """`fit` of findings.json from sums of squares (shares of each recording's largest force)."""
    before, after, floor = (float(value) for value in sums)
    fit = {"held_out": held}
    fit |= {name: {"rms": value**0.5, "unit": "share"} for name, value in zip(PARTS, sums, strict=True)}
    if before > floor > 0.0:
        fit["reducible_error_removed"] = {"value": (before - after) / (before - floor)}
    return fit


def write(out, found):
    """out/findings.json."""
    out.mkdir(parents=True, exist_ok=True)
    (out / "findings.json").write_text(json.dumps(found, default=float, indent=1) + "\n")
