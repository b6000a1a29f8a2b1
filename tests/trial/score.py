"""Scores the trial: what was said of every case against the sealed labels, as a table with Wilson's 95 % bounds.

    python -m trial.score VERDICTS [--split trial] [--json OUT]        (in `tests`)

VERDICTS is a folder of `<case>/findings.json` or `<case>.json`. The only file that opens the labels; it checks every
label against the salted hash in the public index first. A case without a verdict counts as one that says nothing
(`insufficient_data`) and is counted in the last row.
"""

import argparse
import hashlib
import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
TISSUE = {
    "relaxation",
    "drainage",
    "bone",
    "stiff_skin",
    "inclusion",
    "stiffening_law",
    "region_coupling",
    "friction",
    "adhesion",
    "cycle_softening",
    "compressibility",
    "rate_independent_loss",
}
SILENT = {"verdict": "insufficient_data", "findings": []}
REACHED = 0.9  # of a severity: cases whose truth could not be made so severe count where they are
CONCEALED = 0.98


@dataclass(frozen=True)
class Row:
    """One row of the table: how many of how many, what it must be, and in which direction."""

    name: str
    hits: int
    of: int
    must: float
    is_ceiling: bool = False

    def rate(self):
        """Share, NaN of none."""
        return self.hits / self.of if self.of else float("nan")

    def holds(self):
        """Whether the share itself meets what it must; None where no case is of this kind."""
        if not self.of:
            return None
        return self.rate() <= self.must if self.is_ceiling else self.rate() >= self.must


def wilson(hits, of, z=1.959963984540054):
    """Bounds of a share (Wilson 1927)."""
    if of == 0:
        return float("nan"), float("nan")
    share, spread = hits / of, z * z / of
    middle = (share + spread / 2.0) / (1.0 + spread)
    half = z / (1.0 + spread) * np.sqrt(share * (1.0 - share) / of + spread / (4.0 * of))
    return max(0.0, float(middle - half)), min(1.0, float(middle + half))


def labels(split, folder=HERE):
    """Sealed labels by case. Raises ValueError for one that is not what the index's hash says."""
    found = {}
    for kind in ("", "local_"):
        index = json.loads((folder / f"{kind}cases.json").read_text())["cases"]
        sealed = json.loads((folder / f"{kind}labels.json").read_text())
        for name, label in sealed["labels"].items():
            digest = hashlib.sha256((sealed["salt"] + json.dumps(label, sort_keys=True)).encode()).hexdigest()
            if digest != index[name]["label"]:
                path = folder / f"{kind}labels.json"
                raise ValueError(f"{path}: the label of {name} is not the one sealed; restore the file")
            if index[name]["split"] == split:
                found[name] = label
    return found


def verdicts(folder, names):
    """findings.json by case; those that are not there say nothing."""
    folder, found = Path(folder), {}
    for name in names:
        for path in (folder / name / "findings.json", folder / f"{name}.json"):
            if path.exists():
                found[name] = json.loads(path.read_text())
                break
    return found


def named(verdict):
    """Effects that a verdict names."""
    return {finding["effect"] for finding in verdict.get("findings", [])}


def blames_skin(verdict):
    """Whether it claims that physics of the skin is missing."""
    return verdict["verdict"] in ("missing_physics", "unlisted") or bool(named(verdict) & TISSUE)


def sets_of(verdict):
    """Sets of names kept at 90 %; `cannot_tell` pairs as they stand."""
    return [frozenset(one) if isinstance(one, list) else frozenset([one]) for one in verdict.get("names_90", [])]


def table(sealed, said):
    """Rows of the score, in the order of the README."""
    pairs = [(label, said.get(name, SILENT)) for name, label in sealed.items()]

    def of(*strata):
        return [(label, verdict) for label, verdict in pairs if label["stratum"] in strata]

    def exact(group):
        return sum(named(verdict) == set(label["names"]) for label, verdict in group)

    singles = of("single")
    severe = [pair for pair in singles if pair[0]["kappa"] >= REACHED]
    mild = [pair for pair in singles if 0.5 * REACHED <= pair[0]["kappa"] < REACHED]
    decoys, listed = of("decoy"), of("single", "pair", "mixed", "decoy")
    rows = [
        _count("nulls: a missing effect claimed", of("null"), lambda label, v: blames_skin(v), 0.02, True),
        _count("decoys: blamed on the skin", decoys, lambda label, v: blames_skin(v), 0.05, True),
        _count("decoys: named as the instrument", decoys, lambda label, v: v["verdict"] == "instrument", 0.9),
        Row("one effect, kappa >= 1: exact", exact(severe), len(severe), 0.85),
        Row("one effect, kappa 0.5: exact", exact(mild), len(mild), 0.8),
        _count("a wrong name anywhere", pairs, lambda label, v: bool(named(v) - set(label["names"])), 0.05, True),
        Row("two effects: the exact pair", exact(of("pair")), len(of("pair")), 0.65),
        Row("effect and instrument: both", exact(of("mixed")), len(of("mixed")), 0.65),
        _count("unlisted: refused as a name", of("unlisted"), _refused, 0.7),
        _count("ambiguous: the right set, not one name", of("ambiguous"), _undecided, 0.75),
        _count("too little data: said so", of("poor"), _says_little, 0.75),
        _count("90 % name sets hold the truth", [p for p in listed if sets_of(p[1])], _held, 0.85),
    ]
    return [*rows, *_places(of("local")), *_gains(severe), *_about(pairs, said)]


def _count(name, group, test, must, is_ceiling=False):  # noqa: PLR0913 - a row and its test
    return Row(name, sum(bool(test(*pair)) for pair in group), len(group), must, is_ceiling)


def _refused(label, verdict):
    return verdict["verdict"] == "unlisted" and not named(verdict)


def _undecided(label, verdict):
    told = [set(one) for one in verdict.get("cannot_tell", [])]
    return verdict["verdict"] == "cannot_tell" and set(label["names"]) in told and len(named(verdict)) != 1


def _says_little(label, verdict):
    return verdict["verdict"] in ("insufficient_data", "cannot_tell") and not named(verdict)


def _held(label, verdict):
    return frozenset(label["names"]) in sets_of(verdict)


def _places(local):
    """Spots: whether they are named, and of those, how many are placed within one sensel's pitch on the skin."""
    found = [(label, finding) for label, verdict in local for finding in verdict.get("findings", [])]
    found = [(label, finding) for label, finding in found if finding["effect"] == "inclusion" and "where" in finding]
    near = sum(
        math.dist(finding["where"]["center_mm"], label["center_mm"]) <= label["pitch_mm"] for label, finding in found
    )
    exact = sum(named(verdict) == {"inclusion"} for _, verdict in local)
    return [
        Row("spots: named, and nothing else", exact, len(local), 0.85),
        Row("spots: placed within one pitch (median)", near, len(found), 0.5),
    ]


def _gains(severe):
    """Held-out error removed where the right name was given; the median is 75 % where half of the cases have that."""
    shares = []
    for label, verdict in severe:
        removed = verdict.get("fit", {}).get("reducible_error_removed", {}).get("value")
        if named(verdict) == set(label["names"]) and removed is not None:
            shares.append(removed)
    good, worse = sum(share >= 0.75 for share in shares), sum(share < 0.0 for share in shares)
    return [
        Row("named: 75 % of the reducible error removed", good, len(shares), 0.5),
        Row("named: held-out error made worse", worse, len(shares), 0.03, True),
    ]


def _about(pairs, said):
    """What the trial itself is: how well its truths hide, and how much of it was answered."""
    hidden = [label for label, _ in pairs if label["stratum"] not in ("null", "poor", "local", "faint")]
    concealed = sum(label["r2"] >= CONCEALED for label in hidden)
    return [
        Row("concealed: R2 >= 0.98 after refitting the base", concealed, len(hidden), 0.6),
        Row("answered", len(said), len(pairs), 1.0),
    ]


def by_stratum(sealed, said):
    """Lines (kind, severity asked for, exactly right, of) for every stratum."""
    found = {}
    for name, label in sealed.items():
        verdict = said.get(name, SILENT)
        kind = (label["stratum"], label.get("effect") or label.get("distortion") or label.get("scatter", ""))
        right = named(verdict) == set(label["names"])
        if label["stratum"] == "ambiguous":
            right = _undecided(label, verdict)
        elif label["stratum"] == "null":
            right = not blames_skin(verdict)
        elif label["stratum"] == "unlisted":
            right = _refused(label, verdict)
        hits, of = found.get((*kind, label.get("wanted_kappa", 0.0)), (0, 0))
        found[(*kind, label.get("wanted_kappa", 0.0))] = (hits + right, of + 1)
    return sorted((*kind, *counts) for kind, counts in found.items())


def shown(rows):
    """The table as text."""
    lines = [f"{'':45s} {'share':>7s}  {'95 % bounds':>15s} {'of':>4s}  must"]
    for row in rows:
        low, high = wilson(row.hits, row.of)
        sign, mark = ("<=" if row.is_ceiling else ">="), {True: "met", False: "NOT MET", None: "no case"}[row.holds()]
        lines.append(
            f"{row.name:45s} {row.rate():7.3f}  {low:7.3f}-{high:6.3f} {row.of:5d}  {sign} {row.must:.2f}  {mark}"
        )
    return "\n".join(lines)


def main():
    """Prints the table; exits with 1 if a row falls short."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("verdicts")
    parser.add_argument("--split", default="trial", choices=("trial", "calibration"))
    parser.add_argument("--json")
    asked = parser.parse_args()
    sealed = labels(asked.split)
    said = verdicts(asked.verdicts, sealed)
    rows = table(sealed, said)
    print(shown(rows))
    for stratum, kind, kappa, hits, of in by_stratum(sealed, said):
        print(f"{stratum:10s} {kind:32s} kappa {kappa:3.1f}  {hits:3d} of {of}")
    if asked.json:
        plain = [{"row": row.name, "hits": row.hits, "of": row.of, "bounds": wilson(row.hits, row.of)} for row in rows]
        Path(asked.json).write_text(json.dumps(plain, indent=1) + "\n")
    raise SystemExit(any(row.holds() is False for row in rows))


if __name__ == "__main__":
    main()
