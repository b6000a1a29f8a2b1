"""A process that solves cases, seen from outside. Stands alone: it is also sent to machines of a cluster."""

import json
import os
import queue
import shlex
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import contextmanager, suppress

TIMES_TRIED = 2
"""A case whose process dies is given to a fresh one once; then it counts as what killed it."""
MOST_CASES = 200
"""A process is replaced after so many cases: what Blender keeps of files that were open does not pile up."""

PROCESSORS = "THENAR_PROCESSORS"
"""Variable of a worker process. As "one" it is to start with one processor, which Blender then counts for its threads;
what the process finds in its place are the numbers of the processors, with commas, for `processors.Own`."""


class ChildDied(Exception):
    """The process ended or was stopped before it answered; the text says how."""


class Child:
    """A worker process. `solve(task)` gives the answer to one task, in turn; `close()` ends it."""

    def __init__(self, command, environment):
        self.start = self._command, self._environment = command, environment
        self._process = None
        self._solved = 0

    def solve(self, task, limit_s):
        """The answer to `task`, both plain values. Raises `ChildDied` if the process died or took over `limit_s`."""
        if self._process is None or self._process.poll() is not None or self._solved >= MOST_CASES:
            self.close()
            self._start()
        try:
            self._process.stdin.write(json.dumps(task) + "\n")
            self._process.stdin.flush()
            line = self._answers.get(timeout=limit_s)
        except (OSError, queue.Empty) as error:
            line, why = "", f"it took longer than {limit_s:g} s" if isinstance(error, queue.Empty) else ""
        else:
            why = ""
        if not line:
            raise ChildDied(self._end(why))
        self._solved += 1
        return json.loads(line)

    def close(self):
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            with suppress(BrokenPipeError):  # a task that the dead process never took
                self._process.stdin.close()
            self._complaints.close()
            self._process = None

    def _start(self):
        self._complaints = tempfile.TemporaryFile()  # noqa: SIM115  (closed with the process)
        with _narrowed({**os.environ, **self._environment}) as environment:
            self._process = subprocess.Popen(
                self._command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._complaints,
                text=True,
                env=environment,
            )
        self._answers, self._solved = queue.Queue(), 0
        threading.Thread(target=_hear, args=(self._process.stdout, self._answers), daemon=True).start()

    def _end(self, why):
        if why:
            self._process.kill()
        code = self._process.wait()
        self._complaints.seek(0)
        lines = [line for line in self._complaints.read().decode(errors="replace").splitlines() if line.strip()]
        self.close()
        return why or f"the process ended with code {code}" + (f": {lines[-1].strip()}" if lines else "")


def solve(children, start, task, limit_s):
    """The answer to `task` by the child that `children` keeps for this thread; `start` is its command and environment.

    A death is one more try; after `TIMES_TRIED` the answer is `{"error": ...}`.
    """
    told = ""
    for _ in range(TIMES_TRIED):
        child = children.get(threading.get_ident())
        if child is None or child.start != start:  # of another batch
            if child is not None:
                child.close()
            child = children[threading.get_ident()] = Child(*start)
        try:
            return child.solve(task, limit_s)
        except ChildDied as died:
            told = str(died)
            del children[threading.get_ident()]
    return {"error": f"{told}, {TIMES_TRIED} times"}


def solve_on_node(tasks, environment, limit_s):
    """Seconds and the answers to `tasks` on a worker of a Dask cluster, by a process that stays with the worker."""
    from distributed import get_worker

    command = shlex.split(os.environ.get("THENAR_WORKER", "")) or [sys.executable, "-m", "thenar_blender", "worker"]
    # This function comes anew with every task; the first one's stays, so that its errors are known to it.
    answer, children = get_worker().__dict__.setdefault("thenar_children", (solve, {}))
    began = time.monotonic()
    answers = [answer(children, (command, environment), task, limit_s) for task in tasks]
    return time.monotonic() - began, answers


@contextmanager
def _narrowed(environment):
    """Variables for a process that is started here, where this thread keeps one processor if they say so (on Linux)."""
    one = environment.pop(PROCESSORS, "") == "one" and sys.platform == "linux"
    if not one:
        yield environment
        return
    allowed = sorted(os.sched_getaffinity(0))
    with open("/proc/thread-self/stat") as told:
        now_on = int(told.read().rpartition(")")[2].split()[36])
    os.sched_setaffinity(0, {now_on})
    try:
        yield {**environment, PROCESSORS: ",".join(map(str, allowed))}
    finally:
        os.sched_setaffinity(0, allowed)


def _hear(stream, answers):
    """Passes lines on as they come; an empty one says that the process is gone."""
    with stream:
        for line in stream:
            answers.put(line)
    answers.put("")
