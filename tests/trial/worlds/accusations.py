"""Diagnoses studies of a world and counts what is said, by noise family.

    PYTHONPATH=tests target/venv/bin/python tests/trial/worlds/accusations.py [--world finite_element_pads]
        [--truth nothing] [--motion ramps] [--cases 10] [--seed 1] [--noises white ...] [--workers 1] [--keep DIR]

Prints a row for each family: how many of its cases end in each verdict, and how many name an effect or an instrument
that is not there (where nothing is missing: how many accuse at all), with the 95 % bounds of the share (Clopper and
Pearson). In the world of closed forms that is `is_wrong`; a world with a `judged` of its own says what is right and
what is only missed. With `--keep`, verdicts are kept in DIR, those that lie there are not asked for again, and how
often each effect is suspected only is printed. Exit code 1 if more than 3 % of all are wrong.
"""

import argparse
import collections
import importlib
import json
import os
import shutil
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from scipy.stats import beta
from trial.running import Binary, Fault

WRONG = 0.03
WORLDS = {
    "closed_forms": "trial.worlds.closed_forms",
    "finite_element_pads": "trial.worlds.finite_element_pads",
    "laboratory_fingertips": "trial.fingertips.laboratory_fingertips",
}
RAMPS = "ramps"
STRANGER = "stranger"  # a truth that is on no list of effects


@dataclass(frozen=True)
class Asked:
    """One case of a world, the program that is to diagnose it, and where its verdict is kept (None: nowhere)."""

    world: str
    seed: int
    truth: str
    noise: str
    program: str
    keep: str | None = None
    motion: str = RAMPS

    def kept(self):
        """The file of the verdict."""
        motion = "" if self.motion == RAMPS else f"_{self.motion}"
        return self.keep and Path(self.keep) / f"{self.world}_{self.truth}_{self.noise}{motion}_{self.seed}.json"

    @staticmethod
    def of_kept(stem):
        """The case whose verdict is kept in a file of that name, without its program."""
        world = next(each for each in WORLDS if stem.startswith(each))
        rest, seed = stem.removeprefix(world + "_").rsplit("_", 1)
        motion = next((each for each in motions(world) if rest.endswith("_" + each)), RAMPS)
        rest = rest.removesuffix("_" + motion)
        noise = max((each for each in noises(world) if rest.endswith("_" + each)), key=len)
        return Asked(world, int(seed), rest.removesuffix("_" + noise), noise, "", motion=motion)

    def draw(self):
        """The case."""
        moved = () if self.motion == RAMPS else (self.motion,)
        return module(self.world).draw(self.seed, self.truth, self.noise, *moved)


def module(world):
    """The module of a world."""
    return importlib.import_module(WORLDS[world])


def answer(asked):
    """(verdict, names) of one case, or ("fault", [sentence]); of *cannot tell*, the names that it cannot tell apart."""
    kept = asked.kept()
    if kept and kept.exists():
        return _said(json.loads(kept.read_text()), asked)
    with tempfile.TemporaryDirectory() as place:
        asked.draw().write(Path(place) / "study")
        try:
            Binary(Path(asked.program)).diagnose(Path(place) / "study", Path(place) / "out")
        except Fault as fault:
            return "fault", [str(fault)]
        found = Path(place) / "out" / "findings.json"
        if kept:
            kept.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(found, kept)
        return _said(json.loads(found.read_text()), asked)


def _said(found, asked):
    return found["verdict"], sorted(named(asked, found["findings"]).union(*found["cannot_tell"]))


def named(asked, findings):
    """Names of findings; a world may have its own, by what a finding says besides."""
    world = module(asked.world)
    if hasattr(world, "named"):
        return set(world.named(asked.draw(), findings))
    return {finding["effect"] for finding in findings}


def is_wrong(truth, verdict, names):
    """Whether something is named that is not there, or, where nothing is missing, something is accused at all."""
    accused = verdict in ("fault", "unlisted", "cannot_tell", "missing_physics", "instrument")
    named = [] if verdict == "cannot_tell" else names
    return bool(set(named) - planted(truth)) or verdict == "fault" or (truth.startswith("nothing") and accused)


def judged(asked, verdict, names):
    """`right`, `missed` or `wrong`."""
    world = module(asked.world)
    if hasattr(world, "judged"):
        return world.judged(asked.truth, asked.draw().pad.stiffening, verdict, names)
    if is_wrong(asked.truth, verdict, names):
        return "wrong"
    if asked.truth == STRANGER:
        return "right" if verdict == "unlisted" else "missed"
    is_right = verdict != "cannot_tell" and (asked.truth.startswith("nothing") or planted(asked.truth) == set(names))
    return "right" if is_right else "missed"


def planted(truth):
    """Names that are right: of two together both, of what is on no list none."""
    return set() if truth == STRANGER else set(truth.split("_and_"))


def noises(world):
    """Noise families of a world."""
    return module(world).NOISES


def motions(world):
    """Motions of a world."""
    return getattr(module(world), "MOTIONS", (RAMPS,))


def suspected(cases):
    """How often each effect is suspected only, in verdicts that are kept."""
    kept = [case.kept() for case in cases]
    said = [json.loads(path.read_text()) for path in kept if path and path.exists()]
    return collections.Counter(name for one in said for name in one.get("suspected", []))


def bounds(count, of):
    """95 % bounds of a share."""
    low = beta.ppf(0.025, count, of - count + 1) if count else 0.0
    high = beta.ppf(0.975, count + 1, of - count) if count < of else 1.0
    return low, high


def arguments():
    """As they were asked for; ends with a sentence where a world has no such truth or noise."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--world", default="closed_forms", choices=WORLDS)
    parser.add_argument("--truth", default="nothing")
    parser.add_argument("--motion", default=RAMPS)
    parser.add_argument("--cases", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--noises", nargs="+")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--keep")
    parser.add_argument("--program", default=str(Path(__file__).parents[3] / "target/release/thenar"))
    given = parser.parse_args()
    world = module(given.world)
    given.noises = given.noises or list(noises(given.world))
    if given.truth not in world.TRUTHS or set(given.noises) - set(world.NOISES):
        parser.error(f"{given.world} has the truths {', '.join(world.TRUTHS)} and the noises {', '.join(world.NOISES)}")
    if given.motion != RAMPS and (given.motion not in motions(given.world) or given.truth not in world.MOVED):
        parser.error(f"{given.world} has no {given.truth} with the motion {given.motion}")
    return given


def main():
    """Prints the table."""
    given = arguments()
    seeds = range(given.seed, given.seed + given.cases)
    cases = [
        Asked(given.world, seed, given.truth, noise, given.program, given.keep, given.motion)
        for noise in given.noises
        for seed in seeds
    ]
    with ProcessPoolExecutor(given.workers) as pool:
        found = list(zip(cases, pool.map(answer, cases), strict=True))
    total = collections.Counter()
    for noise in given.noises:
        own = [(case, said, judged(case, *said)) for case, said in found if case.noise == noise]
        words = collections.Counter(word for _, _, word in own)
        total += words
        verdicts = collections.Counter(said[0] for _, said, _ in own)
        text = ", ".join(f"{count} {verdict}" for verdict, count in verdicts.most_common())
        print(f"{noise:15s} wrong {words['wrong']:3d}, right {words['right']:3d} of {len(own)}; {text}", flush=True)
        for name, count in suspected(case for case, _, _ in own).most_common():
            print(f"    suspected only: {name} in {count}")
        for case, (verdict, names), word in own:
            if word == "wrong":
                print(f"    seed {case.seed}: {verdict}: {', '.join(names)}")
    for word in ("wrong", "right"):
        low, high = bounds(total[word], len(cases))
        share = f"{total[word]} of {len(cases)} ({100 * low:.1f} to {100 * high:.1f} %)"
        print(f"{given.truth}: {word} in {share}")
    return int(total["wrong"] > WRONG * len(cases))


if __name__ == "__main__":
    sys.exit(main())
