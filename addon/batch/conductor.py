"""The order of a batch: read the cases, keep what is done, answer the rest, write each as it comes."""

import json
import re
import threading
import time
from contextlib import contextmanager
from dataclasses import dataclass

from .. import names
from ..results import export
from ..scene.checks import Refusal
from . import cluster, depends, here, rows, sheet
from .case_files import file_of
from .child import is_answer
from .jobs import case_hash, read_entries
from .stopping import Signalled, Stopped

SAVED_EVERY_S = 10.0
"""How often the table is written while cases come in, s; the cases themselves are written at once."""
SAVING_SHARE = 0.01
"""Most of the time that this may take: a table of many cases is written less often."""
BEAT_S = 30.0
"""Where no case ends for as long, a line says that the batch goes on, s."""


@dataclass(frozen=True)
class By:
    """Who solves: `workers` processes here (0: as many as fit), or the workers of the Dask `scheduler` at this address.

    `part`, as "2/5", takes every fifth case from the second on and writes no tables: for farms that deal out tasks.
    """

    workers: int = 0
    scheduler: str | None = None
    part: str | None = None


class Table:
    """The entries of a batch in order, each with its digest and its row, None while it has none."""

    def __init__(self, entries, out):
        self.entries, self.out = entries, out
        self.known = {}
        self.hashes = [None if each.refusal else case_hash(each.case, self.known) for each in entries]
        pairs = zip(entries, self.hashes, strict=True)
        self.rows = [self._refused(each) or self._kept(each, digest) for each, digest in pairs]

    def left(self):
        """Places of the entries that have no row yet."""
        return [place for place, row in enumerate(self.rows) if row is None]

    def task(self, place):
        """What a worker is given for an entry."""
        entry = self.entries[place]
        stem = str(self.out / entry.stem)
        return {"case": entry.case, "stem": stem, "hash": self.hashes[place], "thenar": names.VERSION}

    def take(self, place, answer):
        """Write what a worker answered for an entry; what cannot be written is an error of this entry alone."""
        entry, digest = self.entries[place], self.hashes[place]
        if not is_answer(answer):
            answer = {"error": "the worker's answer holds no result"}
        if "summary" in answer:
            text = json.dumps({**answer["summary"], "case": entry.case, "case_hash": digest}, indent=1)
            path = file_of(self.out / entry.stem, ".json")
            try:
                export.replace_file(path, lambda partial: partial.write_text(text, encoding="utf-8"))
            except OSError as error:
                answer = {"error": f"'{path.name}' cannot be written: {error.strerror}"}
        self.rows[place] = rows.row(entry.case, digest, answer)
        return self.rows[place]

    def save(self):
        """Write the tables of the entries that have a row."""
        rows.save(self.out, [row for row in self.rows if row is not None])

    def _refused(self, entry):
        return rows.row({"name": entry.case["name"]}, "", {"error": entry.refusal}) if entry.refusal else None

    def _kept(self, entry, wanted):
        """The row of a case that an earlier run has done and whose files are what they were, or None."""
        try:
            summary = json.loads(file_of(self.out / entry.stem, ".json").read_text(encoding="utf-8"))
        except (OSError, ValueError, RecursionError):
            return None
        if not is_answer({"summary": summary}) or summary.get("case_hash") != wanted or not self._has_files(entry):
            return None
        if not depends.are_unchanged(summary.get("files"), self.known):
            return None
        return rows.row(entry.case, wanted, {"summary": summary})

    def _has_files(self, entry):
        """Whether the file and picture that the case asks for are still there."""
        wanted = {".blend": entry.case.get("save", True), ".png": entry.case.get("render", False)}
        return all(file_of(self.out / entry.stem, each).is_file() for each, is_wanted in wanted.items() if is_wanted)


def run(jobs, out, by=None):
    """Run the cases of `jobs`; `NAME.json` for each, tables and a contact sheet go to `out`. Returns the rows.

    Cases whose `NAME.json` is of the same content are kept. Workers of a cluster must see `out` and the cases' files
    under the same paths. Raises `Refusal` for a job file that cannot be read, a folder that cannot be written, a
    scheduler that stays away, a worker of another version, and at the end if any case failed; `Stopped` after a signal.
    """
    by = by or By()
    entries = _part(read_entries(jobs), by.part)
    out = out.resolve()
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Refusal(f"no results can be written to '{out}': {error.strerror}; give another folder") from None
    table = Table(entries, out)
    count, left = len(entries), table.left()
    kept = count - len(left) - sum(bool(each.refusal) for each in entries)
    if kept:
        print(f"{kept} of {count} cases kept from an earlier run", flush=True)
    for row in table.rows:
        if row is not None and row["status"] == "failed":
            _tell(row)
    try:
        _answer(table, left, by)
    except Signalled as signalled:
        _save(table, by)
        done = sum(row is not None and row["status"] == "done" for row in table.rows)
        text = f"stopped by {signalled}; {done} of {count} cases are done, the same command goes on from there"
        raise Stopped(text, 128 + signalled.number) from None
    except BaseException:
        _save(table, by)
        raise
    _save(table, by)
    if by.part is None:
        sheet.make(out, [(each.stem, row) for each, row in zip(entries, table.rows, strict=True)])
    failed = [row["name"] for row in table.rows if row["status"] == "failed"]
    if failed:
        listed = printable(", ".join(failed[:5]))
        raise Refusal(f"{len(failed)} of {count} cases failed ({listed}); see {out / 'results.csv'}")
    return table.rows


def printable(text):
    """A text without what moves a terminal's cursor or colors it."""
    return "".join(letter if letter.isprintable() else ascii(letter)[1:-1] for letter in text)


def _answer(table, left, by):
    if not left:
        return
    places = {table.entries[place].case["name"]: place for place in left}
    next_save = time.monotonic() + SAVED_EVERY_S
    with _beat(len(left)) as beat:
        for name, answer in _by([table.task(place) for place in left], by):
            if "refused" in answer:
                raise Refusal(f"{answer['refused']}; {len(places)} cases are left, which the same command will run")
            _tell(table.take(places.pop(name), answer))
            beat()
            began = time.monotonic()
            if began > next_save:
                _save(table, by, is_last=False)
                span_s = time.monotonic() - began
                next_save = began + max(SAVED_EVERY_S, span_s / SAVING_SHARE)


def _tell(row):
    print(printable(f"{row['name']}: {row['status']} {row['message']}".rstrip()), flush=True)


@contextmanager
def _beat(total):
    """Gives a function to call after each case; where none ends for `BEAT_S`, a line says how far the batch is."""
    ended, state = threading.Event(), {"done": 0, "at": time.monotonic()}
    began = time.monotonic()

    def more():
        state["done"] += 1
        state["at"] = time.monotonic()

    def watch():
        while not ended.wait(BEAT_S):
            now = time.monotonic()
            if now - state["at"] >= BEAT_S:
                print(f"{state['done']} of {total} cases solved, {now - began:.0f} s", flush=True)

    threading.Thread(target=watch, daemon=True).start()
    try:
        yield more
    finally:
        ended.set()


def _by(tasks, by):
    if by.scheduler:
        return cluster.answers(tasks, by.scheduler)
    return here.answers(tasks, here.workers_of(by.workers))


def _part(entries, part):
    if part is None:
        return entries
    found = re.fullmatch(r"(\d+)/(\d+)", part)
    number, parts = (int(text) for text in found.groups()) if found else (0, 0)
    if not 1 <= number <= parts:
        raise Refusal(f"the part '{printable(part)}' is none; give it as I/N with I from 1 to N, as 2/5")
    return entries[number - 1 :: parts]


def _save(table, by, is_last=True):
    """Write the tables. What cannot be written while cases come in is tried again later; then it is refused."""
    if by is not None and by.part is not None:
        return
    try:
        table.save()
    except OSError as error:
        if is_last:
            raise Refusal(
                f"the tables cannot be written to '{table.out}': {error.strerror}; what is solved is kept in its own "
                "files, and the same command goes on from there"
            ) from None
