"""Draws grasp studies, has each diagnosed, and counts what came out against truths that no diagnosis sees.

PYTHONPATH=tests target/venv/bin/python tests/trial/grasps/grasp_score.py --sample cylinder_100 --seed 501
"""

import argparse
import json
import shutil
import tempfile
from collections import defaultdict
from pathlib import Path

import thenar
from trial.grasps import drawn

ALIKE = {"region_stiffness", "bone"}
"""Causes of one region that a hold does not tell apart: to say so is right, to name the other one is not."""


def main():
    """Draws, diagnoses, prints a line for each study and a table by kind."""
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--sample", default="cylinder_60")
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--each", type=int, default=3)
    arguments.add_argument("--nulls", type=int, default=8)
    arguments.add_argument("--kinds", nargs="*", default=list(drawn.RIGHT))
    arguments.add_argument("--keep", type=Path, help="folder to keep findings.json of each study in")
    given = arguments.parse_args()
    counts = {kind: given.nulls if not drawn.RIGHT[kind] else given.each for kind in given.kinds}
    table = defaultdict(list)
    for case in drawn.cases(given.seed, given.sample, counts):
        folder = Path(tempfile.mkdtemp(prefix="grasp-"))
        try:
            drawn.write(case, folder)
            found = json.loads(thenar.diagnose(thenar.Study.load(folder)).to_json())
        finally:
            shutil.rmtree(folder)
        outcome = judged(case.kind, case.truth, found)
        table[case.kind].append(outcome)
        names = [(each["effect"], (each.get("where") or {}).get("region", "")) for each in found["findings"]]
        print(
            f"{case.seed} {case.kind} {case.truth.get('region', '')}: {outcome}; "
            f"{found['verdict']} {names} {found['cannot_tell']}",
            flush=True,
        )
        if given.keep:
            given.keep.mkdir(parents=True, exist_ok=True)
            (given.keep / f"{case.seed}_{case.kind}.json").write_text(
                json.dumps(found | {"truth": case.truth}, indent=1)
            )
    print(as_table(table))


def judged(kind, truth, found):
    """`right`, `right, and more`, `nothing said` or `wrong`, of a study's findings against its truth."""
    named = {each["effect"] for each in found["findings"]}
    right = set(drawn.RIGHT[kind])
    if not right:
        return "right" if not named and found["verdict"] == "nothing_missing" else "wrong"
    if not named:
        return "nothing said"
    if kind == "relaxation_without_trace":
        return "right" if any(set(pair) == right for pair in found["cannot_tell"]) else "wrong"
    if kind in drawn.REGIONAL:
        regions = {(each.get("where") or {}).get("region") for each in found["findings"]}
        is_alike = any(set(pair) == ALIKE for pair in found["cannot_tell"])
        if regions == {truth["region"]} and len(named) == 1 and (named == right or is_alike):
            return "right"
        return "right, and more" if truth["region"] in regions and (named & right or is_alike) else "wrong"
    if named == right and not found["cannot_tell"]:
        return "right"
    return "right, and more" if right <= named else "wrong"


def as_table(table):
    """A table by kind, and the two rows that count: effects with their region, and nulls accused."""
    words = ("right", "right, and more", "nothing said", "wrong")
    lines = ["| what is concealed | studies | " + " | ".join(words) + " |", "| --- " * (len(words) + 2) + "|"]
    for kind, outcomes in table.items():
        lines.append(
            f"| {kind.replace('_', ' ')} | {len(outcomes)} | "
            + " | ".join(str(outcomes.count(word)) for word in words)
            + " |"
        )
    effects = [each for kind, outcomes in table.items() if drawn.RIGHT[kind] for each in outcomes]
    nulls = [each for kind, outcomes in table.items() if not drawn.RIGHT[kind] for each in outcomes]
    lines.append(
        f"effects: {effects.count('right')} of {len(effects)} right; "
        f"nulls: {len(nulls) - nulls.count('right')} of {len(nulls)} accused"
    )
    return "\n".join(lines)


if __name__ == "__main__":
    main()
