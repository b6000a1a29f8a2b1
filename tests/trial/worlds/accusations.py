"""Diagnoses studies of the world of closed forms and counts what is said, by noise family.

    PYTHONPATH=tests target/venv/bin/python tests/trial/worlds/accusations.py [--truth nothing] [--cases 10] [--seed 1]
        [--noises white ...]

Prints a row for each family: how many of its cases end in each verdict, and how many name an effect or an instrument
that is not there (where nothing is missing: how many accuse at all), with the 95 % bounds of the share (Clopper and
Pearson). Exit code 1 if more than 3 % of all do.
"""

import argparse
import collections
import json
import os
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from scipy.stats import beta
from trial.running import Binary, Fault
from trial.worlds import closed_forms

WRONG = 0.03


def answer(case):
    """(verdict, names) of one case, or ("fault", [sentence])."""
    seed, truth, noise, program = case
    with tempfile.TemporaryDirectory() as place:
        closed_forms.draw(seed, truth, noise).write(Path(place) / "study")
        try:
            Binary(Path(program)).diagnose(Path(place) / "study", Path(place) / "out")
        except Fault as fault:
            return "fault", [str(fault)]
        said = json.loads((Path(place) / "out" / "findings.json").read_text())
    return said["verdict"], [finding["effect"] for finding in said["findings"]]


def is_wrong(truth, verdict, names):
    """Whether something is named that is not there, or, where nothing is missing, something is accused at all."""
    accused = verdict in ("fault", "unlisted", "cannot_tell", "missing_physics", "instrument")
    return any(name != truth for name in names) or verdict == "fault" or (truth.startswith("nothing") and accused)


def bounds(count, of):
    """95 % bounds of a share."""
    low = beta.ppf(0.025, count, of - count + 1) if count else 0.0
    high = beta.ppf(0.975, count + 1, of - count) if count < of else 1.0
    return low, high


def main():
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--truth", default="nothing", choices=closed_forms.TRUTHS)
    parser.add_argument("--cases", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--noises", nargs="+", default=closed_forms.NOISES, choices=closed_forms.NOISES)
    parser.add_argument("--program", default=str(Path(__file__).parents[3] / "target/release/thenar"))
    asked = parser.parse_args()
    cases = [(asked.seed + k, asked.truth, noise, asked.program) for noise in asked.noises for k in range(asked.cases)]
    wrong = 0
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        found = list(pool.map(answer, cases))
    for noise in asked.noises:
        own = [(case, said) for case, said in zip(cases, found, strict=True) if case[2] == noise]
        bad = [(case[0], said) for case, said in own if is_wrong(asked.truth, *said)]
        wrong += len(bad)
        verdicts = collections.Counter(said[0] for _, said in own)
        said = ", ".join(f"{count} {verdict}" for verdict, count in verdicts.most_common())
        print(f"{noise:15s} wrong {len(bad):3d} of {len(own)}; {said}", flush=True)
        for seed, (_, names) in bad:
            print(f"    seed {seed}: {', '.join(names)}")
    low, high = bounds(wrong, len(cases))
    print(f"{asked.truth}: a wrong name in {wrong} of {len(cases)} ({100 * low:.1f} to {100 * high:.1f} %)")
    return int(wrong > WRONG * len(cases))


if __name__ == "__main__":
    sys.exit(main())
