"""Counts how often what the diagnosis names was right on studies of known truth, by world and kind of finding.

    python -m trial.worlds.track_record --calibration DIR --worlds DIR --grasps DIR [--write]        (in `tests`)

`--calibration`: what `trial.prove --split calibration --out DIR` kept; `--worlds`: what `accusations.py --keep DIR`
kept; `--grasps`: a folder for each sample, of what `grasp_score.py --keep` kept. The split `trial` and the second
trial are refused: a record of what is scored would score itself. With `--write` the counts go to the library
(rust/diagnosis/src/track_record.csv), which shows a frequency by them in place of the posterior.

Prints two tables. The first has the counts. The second leaves one world out: what findings of a world are stated at
by the record of the other worlds alone, and how many of those stated at 90 % or more are right, with 95 % bounds.
"""

import argparse
import json
from collections import Counter, defaultdict
from dataclasses import dataclass
from pathlib import Path

from trial.grasps import drawn
from trial.scoring import score
from trial.scoring.counts import wilson
from trial.worlds import accusations

COUNTS = Path(__file__).parents[3] / "rust/diagnosis/src/track_record.csv"
RANGES = (0.0, 0.9)
FEWEST = 10
Z = 1.645
STATED = 0.9
OVER_BONE = ("finite_element_pads", "laboratory_fingertips")


@dataclass(frozen=True)
class Said:
    """A finding of a study of a world: its kind, the model's posterior, and whether it is right."""

    world: str
    kind: str
    posterior: float
    is_right: bool


def kind_of(finding, findings, world):
    """The kind of a finding, from what it was found in; ValueError where the library has another word for it."""
    kind = _kind(finding, findings, world)
    own = (finding.get("track_record") or {}).get("kind", kind)
    if own != kind:
        raise ValueError(f"{world}: a finding of {finding['effect']} is of kind {own}, not {kind}")
    return kind


def _kind(finding, findings, world):
    is_skin = finding["kind"] == "tissue"
    if world.startswith("grasps"):
        return "grasp_skin" if is_skin else "grasp_instrument"
    if finding["channel"] == "tangential_force":
        return "slide"
    if finding["channel"] == "map":
        return "place" if is_skin else "mat_gain" if finding["effect"] == "gain" else "mat_ceiling"
    form = "form_measured" if world in OVER_BONE else "form_known"
    of_force = [one for one in findings if one["channel"] == "force"]
    return f"{'one_of_two' if len(of_force) > 1 else 'skin' if is_skin else 'instrument'}_{form}"


def of_study(found, world, is_right):
    """What was said of a study; `is_right` judges a finding."""
    findings = found["findings"]
    for finding in findings:
        posterior = finding.get("posterior", finding["confidence"])
        yield Said(world, kind_of(finding, findings, world), posterior, bool(is_right(finding)))


def of_calibration(folder):
    """Findings of the calibration split."""
    for name, label in score.labels("calibration").items():
        path = Path(folder) / name / "findings.json"
        if path.exists():
            names = set(label["names"])
            yield from of_study(json.loads(path.read_text()), "calibration", lambda one, n=names: one["effect"] in n)


def of_worlds(folder):
    """Findings of closed forms, pads and fingertips, in the files of `Asked.kept`."""
    for path in sorted(Path(folder).glob("*.json")):
        asked = accusations.Asked.of_kept(path.stem)

        def is_right(finding, asked=asked):
            word = accusations.judged(asked, "missing_physics", accusations.named(asked, [finding]))
            # One of two that are planted is a miss of the study, and right by itself.
            return word == "right" or (word == "missed" and "_and_" in asked.truth)

        yield from of_study(json.loads(path.read_text()), asked.world, is_right)


def of_grasps(folder):
    """Findings of grasps: `<sample>/<seed>_<kind>.json`."""
    for path in sorted(Path(folder).glob("*/*.json")):
        found, kind = json.loads(path.read_text()), path.stem.split("_", 1)[1]

        def is_right(finding, kind=kind, truth=found["truth"]):
            region = (finding.get("where") or {}).get("region")
            is_there = kind not in drawn.REGIONAL or region == truth["region"]
            return finding["effect"] in drawn.RIGHT[kind] and is_there

        if not found["cannot_tell"]:
            yield from of_study(found, f"grasps_{path.parent.name}", is_right)


def counted(said):
    """Right and stated by kind, range of posteriors and world."""
    table = defaultdict(lambda: [0, 0])
    for one in said:
        cell = table[one.kind, max(low for low in RANGES if low <= one.posterior), one.world]
        cell[0] += one.is_right
        cell[1] += 1
    return dict(table)


def frequency(table, one):
    """The share at which such a finding is right, at least, by these counts; None where they are too few."""
    low = max(low for low in RANGES if low <= one.posterior)
    cells = [cell for (kind, of, _), cell in table.items() if (kind, of) == (one.kind, low)]
    right, stated = (sum(cell[k] for cell in cells) for k in (0, 1))
    if stated < FEWEST:
        return None
    worst = min((cell[0] / cell[1] for cell in cells if cell[1] >= FEWEST), default=1.0)
    return min(wilson(right, stated, Z)[0], worst, one.posterior)


def left_out(said):
    """By world: how many findings, and (right, of) of those stated at 90 % by posterior and by the other worlds."""
    for world in sorted({one.world for one in said}):
        table = counted([one for one in said if one.world != world])
        own = [one for one in said if one.world == world]
        by_posterior = [one.is_right for one in own if one.posterior >= STATED]
        stated = [(one, frequency(table, one)) for one in own]
        by_record = [one.is_right for one, share in stated if share is not None and share >= STATED]
        unknown = sum(share is None for _, share in stated)
        yield world, len(own), by_posterior, by_record, unknown


def as_csv(table, made):
    """The counts as the library reads them; `made`: a line on what made them."""
    lines = [f"# {made}", "# kind, posterior from, world, right, stated"]
    lines += [f"{kind},{low:g},{world},{right},{of}" for (kind, low, world), (right, of) in sorted(table.items())]
    return "\n".join(lines) + "\n"


def _share(hits):
    low, high = wilson(sum(hits), len(hits))
    return f"{sum(hits)} of {len(hits)}" + (f" ({100 * low:.0f} to {100 * high:.0f} %)" if hits else "")


def main():
    """Counts, prints, and writes where that is asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--calibration", type=Path)
    parser.add_argument("--worlds", type=Path)
    parser.add_argument("--grasps", type=Path)
    parser.add_argument("--write", action="store_true")
    given = parser.parse_args()
    sources = ((given.calibration, of_calibration), (given.worlds, of_worlds), (given.grasps, of_grasps))
    said = [one for folder, read in sources if folder for one in read(folder)]
    table = counted(said)
    print(as_csv(table, "counts"), end="")
    for one, often in sorted(Counter((s.world, s.kind) for s in said if not s.is_right).items()):
        print(f"wrong: {' '.join(one)}: {often}")
    print(
        "| world left out | findings | posterior >= 90 %: right | stated at >= 90 % by the others: right | unmeasured |"
    )
    for world, many, by_posterior, by_record, unknown in left_out(said):
        print(f"| {world} | {many} | {_share(by_posterior)} | {_share(by_record)} | {unknown} |")
    if given.write:
        COUNTS.write_text(
            as_csv(table, "Made by `python -m trial.worlds.track_record --write` (tests/trial/worlds/track_record.py)")
        )


if __name__ == "__main__":
    main()
