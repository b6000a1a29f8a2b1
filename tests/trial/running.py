"""Runs a diagnosis over the trial's cases, each in a folder that is kept, and goes on where a run was cut.

A diagnosis is told by `Binary` (`thenar diagnose`) or by an object with the same two: `key`, which changes whenever
its answers may, and `diagnose(study, out)`, which writes `out/findings.json` or raises `Fault`. A verdict that bears
the key of its diagnosis and of its study's files is not asked for again.
"""

import functools
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

from threadpoolctl import threadpool_limits

LIMIT_S = 1800.0  # of one case; the goal is below 180
OFTEN_S = 20.0  # between lines of progress where there is no terminal


class Fault(Exception):
    """A diagnosis ended wrongly; `is_lasting` says whether it would again."""

    def __init__(self, sentence, is_lasting=True):
        super().__init__(sentence)
        self.is_lasting = is_lasting


@dataclass(frozen=True)
class Binary:
    """`thenar diagnose` with one thread, as a program."""

    program: Path

    @functools.cached_property
    def key(self):
        return hashlib.sha256(Path(self.program).read_bytes()).hexdigest()

    def diagnose(self, study, out):
        """Runs it; raises `Fault` with the exit code and its sentence."""
        command = [str(self.program), "diagnose", str(study), "--out", str(out), "--threads", "1"]
        try:
            ended = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S, stdin=subprocess.DEVNULL)
        except subprocess.TimeoutExpired:
            raise Fault(f"it ran for more than {LIMIT_S:.0f} s", is_lasting=False) from None
        if ended.returncode != 0:
            said = ended.stderr.strip().splitlines()
            raise Fault(
                f"exit code {ended.returncode}: {said[-1] if said else 'no sentence'}",
                is_lasting=ended.returncode > 0,
            )

    def is_able(self):
        """Whether this binary diagnoses at all."""
        asked = subprocess.run([str(self.program), "diagnose", "--help"], capture_output=True, stdin=subprocess.DEVNULL)
        return asked.returncode == 0


def answer(diagnosis, write, place):
    """The verdict's file in folder `place`, None where it ended wrongly (`place/fault.txt` says how)."""
    place.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=place, prefix="now_") as now:
        study, out = Path(now) / "study", Path(now) / "out"
        write(study)
        key = _key(diagnosis, study)
        stamp, told, fault = place / "key.txt", place / "findings.json", place / "fault.txt"
        if stamp.exists() and stamp.read_text() == key:
            return told if told.exists() else None
        for old in (stamp, told, fault):
            old.unlink(missing_ok=True)
        try:
            diagnosis.diagnose(study, out)
            if not (out / "findings.json").exists():
                raise Fault("it ended well and wrote no findings.json")
            os.replace(out / "findings.json", told)
        except Fault as error:
            fault.write_text(f"{error}\n")
            if not error.is_lasting:
                return None
        stamp.write_text(key)
        return told if told.exists() else None


def _key(diagnosis, study):
    """Of the diagnosis and of every byte it is given."""
    digest = hashlib.sha256(diagnosis.key.encode())
    for path in sorted(study.iterdir()):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def each(job, cases, workers, what):
    """`job(case)` for every case, side by side, with progress; a job that breaks ends the run with its error.

    A worker's linear algebra has one thread: on cores that are busy anyway, more of them only wait for each other.
    """
    shown = Progress(len(cases), what)
    pool = ProcessPoolExecutor(workers, initializer=_started, initargs=(os.getpid(),))
    try:
        for done in as_completed([pool.submit(job, case) for case in cases]):
            done.result()
            shown.another()
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
        shown.end()


def _started(parent):
    threadpool_limits(1)
    _end_with(parent)


def _end_with(parent):
    """Ends this worker when the run that started it was killed."""

    def watch():
        while os.getppid() == parent:
            time.sleep(1.0)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def clear(root):
    """Removes what a killed run left."""
    for left in root.glob("**/now_*"):
        shutil.rmtree(left, ignore_errors=True)


class Progress:
    """How many are done and how long the rest will take, on one line of a terminal or on a line now and then."""

    def __init__(self, total, what):
        self.total, self.what, self.done = total, what, 0
        self.start = self.told = time.monotonic()

    def another(self):
        self.done += 1
        now = time.monotonic()
        left = (now - self.start) / self.done * (self.total - self.done)
        text = f"{self.what}: {self.done} of {self.total}, {left / 60.0:.0f} min left"
        if sys.stderr.isatty():
            print(f"\r{text}   ", end="", file=sys.stderr, flush=True)
        elif now - self.told > OFTEN_S:
            self.told = now
            print(text, file=sys.stderr, flush=True)

    def end(self):
        seconds = time.monotonic() - self.start
        line = f"{self.what}: {self.done} of {self.total} in {seconds:.0f} s"
        print(f"\r{line}          " if sys.stderr.isatty() else line, file=sys.stderr, flush=True)
