"""The order of a batch: read the cases, keep what is done, answer the rest, write each as it comes."""

import json
import re
import time
from dataclasses import dataclass

from .. import export
from ..scene.checks import Refusal
from . import cluster, here, rows, sheet
from .jobs import case_hash, read_jobs, stem

SAVED_EVERY_S = 10.0
"""How often the table is written while cases come in, s; the cases themselves are written at once."""
SAVING_SHARE = 0.01
"""Most of the time that this may take: a table of many cases is written less often."""


@dataclass(frozen=True)
class By:
    """Who solves: `workers` processes here (0: as many as fit), or the workers of the Dask `scheduler` at this address.

    `part`, as "2/5", takes every fifth case from the second on and writes no tables: for farms that deal out tasks.
    """

    workers: int = 0
    scheduler: str | None = None
    part: str | None = None


def run(jobs, out, by=None):
    """Run the cases of `jobs`; `NAME.json` for each, tables and a contact sheet go to `out`. Returns the rows.

    Cases whose `NAME.json` is of the same content are kept. Workers of a cluster must see `out` and the cases' files
    under the same paths. Raises `Refusal` for a job file that cannot be read, for a scheduler that stays away, and at
    the end if any case failed.
    """
    by = by or By()
    cases = _part(read_jobs(jobs), by.part)
    out = out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    files = {}
    hashes = {case["name"]: case_hash(case, files) for case in cases}
    table = {case["name"]: _kept(case, out, hashes[case["name"]]) for case in cases}
    left = [case for case in cases if table[case["name"]] is None]
    if len(left) < len(cases):
        print(f"{len(cases) - len(left)} of {len(cases)} cases kept from an earlier run", flush=True)
    try:
        _answer(cases, left, (out, hashes, table), by)
    finally:
        _save(out, cases, table, by)
    if by.part is None:
        sheet.make(
            out, [(case["name"], table[case["name"]]) for case in cases], stems={c["name"]: stem(c) for c in cases}
        )
    failed = [name for name, row in table.items() if row["status"] == "failed"]
    if failed:
        raise Refusal(
            f"{len(failed)} of {len(cases)} cases failed ({', '.join(failed[:5])}); see {out / 'results.csv'}"
        )
    return list(table.values())


def _answer(cases, left, where, by):
    out, hashes, table = where
    by_name = {case["name"]: case for case in left}
    tasks = [{"case": case, "stem": str(out / stem(case)), "hash": hashes[case["name"]]} for case in left]
    if not tasks:
        return
    coming = _by(tasks, by)
    next_save = time.monotonic() + SAVED_EVERY_S
    for name, answer in coming:
        case = by_name[name]
        if "summary" in answer:
            content = {**answer["summary"], "case": case, "case_hash": hashes[name]}
            text = json.dumps(content, indent=1)
            export.replace_file(_json(case, out), lambda path, text=text: path.write_text(text, encoding="utf-8"))
        table[name] = rows.row(case, hashes[name], answer)
        print(f"{name}: {table[name]['status']} {table[name]['message']}".rstrip(), flush=True)
        began = time.monotonic()
        if began > next_save:
            _save(out, cases, table, by)
            span_s = time.monotonic() - began
            next_save = began + max(SAVED_EVERY_S, span_s / SAVING_SHARE)


def _kept(case, out, wanted):
    """The row of a case that an earlier run has done, or None."""
    try:
        summary = json.loads(_json(case, out).read_text(encoding="utf-8"))
    except (OSError, json.JSONDecodeError):
        return None
    if summary.get("case_hash") != wanted or not _has_files(case, out):
        return None
    return rows.row(case, wanted, {"summary": summary})


def _has_files(case, out):
    """Whether the file and picture that the case asks for are still there."""
    wanted = {".blend": case.get("save", True), ".png": case.get("render", False)}
    return all((out / (stem(case) + suffix)).is_file() for suffix, is_wanted in wanted.items() if is_wanted)


def _json(case, out):
    return out / (stem(case) + ".json")


def _by(tasks, by):
    if by.scheduler:
        return cluster.answers(tasks, by.scheduler)
    return here.answers(tasks, here.workers_of(by.workers))


def _part(cases, part):
    if part is None:
        return cases
    found = re.fullmatch(r"(\d+)/(\d+)", part)
    number, parts = (int(text) for text in found.groups()) if found else (0, 0)
    if not 1 <= number <= parts:
        raise Refusal(f"the part '{part}' is none; give it as I/N with I from 1 to N, as 2/5")
    return cases[number - 1 :: parts]


def _save(out, cases, table, by):
    if by.part is None:
        rows.save(out, [table[case["name"]] for case in cases if table[case["name"]] is not None])
