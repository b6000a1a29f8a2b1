"""`cargo xtask prove`: every case of the blind trial through the diagnosis and the baselines, then the table.

    cargo xtask prove [-- --split second --subset fixed --only thenar,bic --workers N --mutate labels]

Splits: `trial` (as drawn, whatever its recordings hold), `second` (other pads, tools, speeds and seeds; asked for what
its recordings hold: make_second.py), `calibration`, `larger` (the calibration drawn thrice, anew: make_larger.py).

Verdicts are kept in `target/prove/<case>`, those of the baselines in `target/prove/<baseline>/<case>`, and are not
asked for twice (running.py), so a run that was cut goes on. Where the diagnosis cannot tell and asks for a recording
that the case holds back, the study with that recording, made as often as was asked, is kept in `<case>/followed`, and
one with a recording drawn by lot in `<case>/at_random`. A wrong exit counts as saying nothing and is listed. Prints
the table and writes `table.json` and `page.html`. Exits with 1 if a row of the diagnosis falls short of what it must
be.

The thresholds of the diagnosis (in rust/diagnosis/src/gates and rust/inference/src: checks,
parameters/priors.rs) were set on `--split calibration` and on larger draws of it, and what they rest on is
printed with both (thresholds.py).
"""

import argparse
import functools
import json
import os
import shutil
from pathlib import Path

import results
from trial import cases, running, subset
from trial.baselines.peers import BASELINES
from trial.drawing import make_larger
from trial.scoring import ceiling, counts, findings, following, mutations, page, score, thresholds

ROOT = Path(__file__).parents[2]
THENAR = "thenar"


def job(who, out, case):
    """Asks one diagnosis about one case, and about what it asked to be recorded next."""
    diagnosis = _made(who, case)
    told = running.answer(diagnosis, functools.partial(cases.write, case), out / case)
    verdict = json.loads(told.read_text()) if told else {}
    advised = following.asked_for(case, verdict) if who.name == THENAR else None
    is_open = who.name == THENAR and verdict.get("verdict") == "cannot_tell"
    by_lot = following.at_random(case, max((advised or {"": 2}).values())) if is_open else None
    for way, wanted in (("followed", advised), ("at_random", by_lot)):
        if wanted:
            running.answer(diagnosis, functools.partial(cases.follow_up, case, wanted), out / case / way)
        else:
            shutil.rmtree(out / case / way, ignore_errors=True)


class Who:
    """A diagnosis that takes part: its name and, for `thenar`, the program."""

    def __init__(self, name, program=None):
        self.name, self.program = name, program

    def reads(self, names):
        """The cases that it can be asked about: the baselines know nothing of mats."""
        return [name for name in names if self.name == THENAR or "mat" not in cases.index()[name]]

    def folder(self, out):
        """Where its verdicts are kept."""
        return out if self.name == THENAR else out / self.name


def _made(who, case):
    """The diagnosis itself; a baseline that learns is told which case it must not have seen."""
    return running.Binary(who.program) if who.name == THENAR else BASELINES[who.name](case)


def answers(who, out, names):
    """What it said of these cases, and of those to which a recording was added."""
    folder = who.folder(out)
    said, followed, by_lot = (score.verdicts(folder, names, way) for way in ("", "followed", "at_random"))
    open_ones = {name for name, verdict in said.items() if following.is_open(name, verdict)}
    advice = {name: following.met(name, said[name]) for name in followed}
    foretold = {name: one["probability"] for name, one in advice.items() if one and one.get("probability") is not None}
    return counts.Answers(said, followed, by_lot, frozenset(open_ones), foretold)


def wrong_endings(who, out, names):
    """Sentences: wrong exits, and verdicts that are not as they must be."""
    found = []
    for name in names:
        folder = who.folder(out) / name
        for fault in sorted(folder.glob("**/fault.txt")):
            found.append(f"{fault.parent.relative_to(who.folder(out))}: {fault.read_text().strip()}")
        for told in sorted(folder.glob("**/findings.json")):
            where = told.parent.relative_to(who.folder(out))
            found += [f"{where}: {text}" for text in findings.faults(json.loads(told.read_text()))]
    return found


def arguments():
    parser = argparse.ArgumentParser(prog="cargo xtask prove --", description=__doc__.splitlines()[0])
    everyone = [THENAR, *BASELINES]
    parser.add_argument("--split", default="trial", choices=(*score.SPLITS, "larger"))
    parser.add_argument("--subset", default="all", choices=("all", "fixed"), help="fixed: what CI runs")
    parser.add_argument("--only", default=",".join(everyone), help=f"of {', '.join(everyone)}")
    parser.add_argument("--workers", type=int, default=os.cpu_count(), help="cases side by side")
    parser.add_argument("--mutate", choices=mutations.MUTATIONS, help="also score a spoiled copy of the verdicts")
    parser.add_argument("--binary", type=Path, default=ROOT / "target/release/thenar")
    parser.add_argument("--out", type=Path, default=ROOT / "target/prove")
    asked = parser.parse_args()
    asked.only = asked.only.split(",")
    unknown = sorted(set(asked.only) - set(everyone))
    if unknown:
        parser.error(f"--only: there is no {', '.join(unknown)}; there are {', '.join(everyone)}")
    return asked


def takes_part(asked):
    """Those asked for that can run."""
    everyone = []
    for name in asked.only:
        if name == THENAR and not asked.binary.exists():
            print(f"thenar is left out: {asked.binary} is not there; run `cargo xtask setup`")
        elif name == THENAR and not running.Binary(asked.binary).is_able():
            print(f"thenar is left out: {asked.binary} has no command `diagnose`")
        else:
            everyone.append(Who(name, asked.binary))
    return everyone


def main():
    """Runs, scores, tells; the exit code says whether the diagnosis met what it must."""
    asked = arguments()
    asked.out.mkdir(parents=True, exist_ok=True)
    if asked.split == "larger":
        os.environ[cases.LARGER] = str(asked.out / "drawn")
        make_larger.make(asked.out / "drawn")
    names = subset.fixed(asked.split) if asked.subset == "fixed" else cases.names(asked.split)
    running.clear(asked.out)
    everyone = takes_part(asked)
    for who in everyone:
        ask = functools.partial(job, who, who.folder(asked.out))
        running.each(ask, who.reads(names), asked.workers, who.name)
    sealed = {name: label for name, label in score.labels(asked.split).items() if name in set(names)}
    told = {who.name: answers(who, asked.out, names) for who in everyone}
    tables = {}
    for who in everyone:
        tables[who.name] = counts.table({name: sealed[name] for name in who.reads(sealed)}, told[who.name])
    raise SystemExit(_tell(asked, everyone, sealed, told, tables))


def _tell(asked, everyone, sealed, told, tables):
    """Prints and writes; returns the exit code."""
    chances = ceiling.chances(sealed)
    columns = {name: _able(name, table) for name, table in tables.items()} | {"oracle": ceiling.column(chances)}
    first, *others = columns
    beside = {name: {row.key: row for row in columns[name]} for name in others}
    print(f"{first}, {asked.split}, {len(everyone[0].reads(sealed))} cases\n{score.shown(columns[first], beside)}")
    print("one effect, kappa >= 1, exact:")
    for effect, hits, of in counts.exact_by_effect(sealed, told[first].said):
        print(f"  {effect}: {hits} of {of}")
    print("of those that the oracle answers in 9 of 10 draws:")
    for key, hits, of in counts.among(sealed, told[first].said, ceiling.rich(chances)):
        print(f"  {key}: {hits} of {of}")
    print("ambiguous:")
    for ending, often in counts.endings(sealed, told[first].said):
        print(f"  {ending}: {often}")
    print("wrong names:")
    for truth, false, is_beside, often in counts.wrong_names(sealed, told[first].said):
        print(f"  {false} {'beside' if is_beside else 'instead of'} {truth}: {often}")
    if asked.split in ("calibration", "larger"):
        print("\n".join(thresholds.lines(sealed, told[first].said)))
    faults = {who.name: wrong_endings(who, asked.out, sealed) for who in everyone}
    for name, sentences in faults.items():
        print("\n".join(f"{name}: {sentence}" for sentence in sentences))
    plain = {name: score.as_json(table) for name, table in columns.items()}
    (asked.out / "table.json").write_text(
        json.dumps({"split": asked.split, "tables": plain}, indent=1, allow_nan=False) + "\n"
    )
    strata = counts.by_stratum(sealed, told[first].said)
    (asked.out / "page.html").write_text(page.page(asked.split, columns, strata, faults))
    if asked.subset == "all":
        asked_for = "" if asked.split == "trial" else f" -- --split {asked.split}"
        results.write_block("trial", f"cargo xtask prove{asked_for}", score.shown(columns[first], beside))
    print(f"written: {asked.out / 'table.json'}, {asked.out / 'page.html'}")
    if asked.mutate:
        own = {name: sealed[name] for name in everyone[0].reads(sealed)}
        return _mutate(asked.mutate, own, told[first], tables[first])
    return int(any(row.holds() is False for row in tables[first]))


def _able(name, table):
    """The rows that it can be scored on."""
    return table if name == THENAR else [row for row in table if row.key in BASELINES[name].rows]


def _mutate(how, sealed, said, before):
    """Prints the spoiled table; 0 if it is worse where it must be."""
    after = mutations.mutated(how, sealed, said)
    noticed = mutations.is_noticed(how, before, after)
    print(f"\nmutated: {how} ({'noticed' if noticed else 'NOT NOTICED'} in {', '.join(mutations.NOTICE[how])})")
    print(score.shown(after))
    return int(not noticed)


if __name__ == "__main__":
    main()
