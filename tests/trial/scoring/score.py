"""Scores verdicts against the sealed labels: the trial's table, with 95 % bounds.

    python -m trial.scoring.score VERDICTS [--split trial] [--json OUT]        (in `tests`)

VERDICTS is a folder of `<case>/findings.json` or `<case>.json`. The only file that opens the labels; it checks every
label against the salted hash in the public index first. A case without a verdict counts as one that says nothing
(`insufficient_data`) and is counted in the last row. What the rows count stands in counts.py.
"""

import argparse
import hashlib
import json
import math
from pathlib import Path

from trial.cases import folders
from trial.scoring import counts
from trial.scoring.counts import Answers

HERE = Path(__file__).parents[1]
MARKS = {True: "met", False: "NOT MET", None: ""}
SPLITS = ("trial", "calibration", "second")


def labels(split, folder=None):
    """Sealed labels by case, of the files in `folder` or where they are.

    Raises ValueError for one that is not what the index's hash says.
    """
    found = {}
    for kind, place in folders().items():
        place = folder or place
        index = json.loads((place / f"{kind}cases.json").read_text())["cases"]
        sealed = json.loads((place / f"{kind}labels.json").read_text())
        for name, label in sealed["labels"].items():
            digest = hashlib.sha256((sealed["salt"] + json.dumps(label, sort_keys=True)).encode()).hexdigest()
            if digest != index[name]["label"]:
                path = place / f"{kind}labels.json"
                raise ValueError(f"{path}: the label of {name} is not the one sealed; restore the file")
            if index[name]["split"] == split:
                found[name] = label
    return found


def verdicts(folder, names, within=""):
    """findings.json by case (in its subfolder `within`); those that are not there say nothing."""
    folder, found = Path(folder), {}
    for name in names:
        for path in (folder / name / within / "findings.json", folder / f"{name}.json"):
            if path.exists() and (path.parent != folder or not within):
                found[name] = json.loads(path.read_text())
                break
    return found


def shown(table, beside=None):
    """The table as text; `beside`: columns of others' rows by their names."""
    beside = beside or {}
    head = f"{'':47s} {'value':>7s} {'95 % bounds':>15s} {'of':>4s}  {'must':>8s} {'':7s} {'goal':>8s} {'':7s}"
    lines = [head + "".join(f" {name:>11s}" for name in beside)]
    for row in table:
        sign = "<=" if row.is_ceiling else ">="
        aims = ((row.must, row.holds()), (row.goal, row.reaches()))
        told = [f"{'' if aim is None else f'{sign} {aim:.2f}':>8s} {MARKS[met]:7s}" for aim, met in aims]
        line = f"{row.name:47s} {number(row):>7s} {interval(row):>15s} {row.of:4d}  {told[0]} {told[1]}"
        lines.append(line + "".join(f" {number(others.get(row.key)):>11s}" for others in beside.values()))
    return "\n".join(lines)


def number(row):
    """The value of a row, a dash where there is none."""
    return f"{row.value:.3f}" if row and row.of else "-"


def interval(row):
    """The bounds of a row."""
    return f"{row.bounds[0]:.3f} - {row.bounds[1]:.3f}" if row.of else ""


def as_json(table):
    """Rows as plain values; what no case is of is null."""
    return [
        {
            "row": row.key,
            "name": row.name,
            "value": row.value if row.of else None,
            "of": row.of,
            "hits": row.hits,
            "bounds": [None if math.isnan(bound) else bound for bound in row.bounds],
            "must": row.must,
            "goal": row.goal,
            "is_ceiling": row.is_ceiling,
            "met": row.holds(),
            "goal_met": row.reaches(),
        }
        for row in table
    ]


def main():
    """Prints the table; exits with 1 if a row falls short of what it must be."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("verdicts")
    parser.add_argument("--split", default="trial", choices=SPLITS)
    parser.add_argument("--json")
    asked = parser.parse_args()
    sealed = labels(asked.split)
    said = verdicts(asked.verdicts, sealed)
    found = counts.table(sealed, Answers(said))
    print(shown(found))
    for stratum, kind, kappa, hits, of in counts.by_stratum(sealed, said):
        print(f"{stratum:10s} {kind:32s} kappa {kappa:3.1f}  {hits:3d} of {of}")
    if asked.json:
        Path(asked.json).write_text(json.dumps(as_json(found), indent=1) + "\n")
    raise SystemExit(any(row.holds() is False for row in found))


if __name__ == "__main__":
    main()
