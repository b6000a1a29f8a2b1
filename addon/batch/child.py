"""A process that solves cases, seen from outside. Stands alone: it is also sent to machines of a cluster.

A worker first says which version it is, `{"thenar": "0.1.0", "ready": true}`, then answers each task by one line,
`{"summary": {...}}` or `{"error": "..."}`. Other lines before the first are no answers.
"""

import json
import os
import platform
import queue
import re
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import contextmanager, suppress
from math import isfinite

TIMES_TRIED = 2
"""A case whose process dies is given to a fresh one once; then it counts as what killed it."""
MOST_CASES = 200
"""A process is replaced after so many cases: what Blender keeps of files that were open does not pile up."""
NONSENSE_S = 30.0
"""How long a process that answered what is no answer may still say that it is a worker, s."""
START_S = 300.0
"""How long a process may take until it says so, s: Blender starts in seconds, from a slow network in a minute."""
LONGEST_LINE = 1 << 24
"""Most letters of a line; what is longer is no answer. One of a case with all regions has 30,000."""
NUMBERS = ("force_n", "contact_area_mm2", "peak_pressure_kpa", "patch_peak_kpa", "mean_pressure_kpa")
"""What every summary holds as finite numbers."""

PROCESSORS = "THENAR_PROCESSORS"
"""Variable of a worker process. As "one" it is to start with one processor, which Blender then counts for its threads;
what the process finds in its place are the numbers of the processors, with commas, for `processors.Own`."""


class ChildDied(Exception):
    """The process ended or was stopped before it answered; the text says how."""


class OtherVersion(Exception):
    """The process is a worker of another version; the text says of which."""


class Child:
    """A worker process. `solve(task)` gives the answer to one task, in turn; `close()` ends it."""

    def __init__(self, command, environment):
        self.start = self._command, self._environment = command, environment
        self._process = None
        self._solved = 0

    def solve(self, task, limit_s):
        """The answer to `task`, both plain values.

        Raises `ChildDied` if the process died, took over `limit_s` or answered nonsense; `OtherVersion`.
        """
        if self._process is None or self._process.poll() is not None or self._solved >= MOST_CASES:
            self.close()
            self._start()
        try:
            self._process.stdin.write(json.dumps(task) + "\n")
            self._process.stdin.flush()
            answer = self._await(task.get("thenar"), limit_s)
        except OSError:
            raise ChildDied(self._end("", task)) from None
        except ChildDied as died:
            raise ChildDied(self._end(str(died), task)) from None
        except OtherVersion:
            self.close()
            raise
        self._solved += 1
        return answer

    def kill(self):
        """End the process at once; may be called from any thread, `solve` then raises `ChildDied`."""
        process = self._process
        if process is not None:
            process.kill()

    def close(self):
        """End the process; by the thread that uses it."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            with suppress(OSError):  # a task that the dead process never took
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
                encoding="utf-8",
                errors="replace",
                env=environment,
            )
        self._lines, self._solved, self._is_ready = queue.Queue(maxsize=1000), 0, False
        threading.Thread(target=_hear, args=(self._process.stdout, self._lines), daemon=True).start()

    def _await(self, version, limit_s):
        """The next answer. Lines of other programs before the worker says that it is one are passed over."""
        until = time.monotonic() + (limit_s if self._is_ready else min(limit_s, START_S))
        why = f"it took longer than {limit_s:g} s"
        while True:
            try:
                line = self._lines.get(timeout=max(0.0, until - time.monotonic()))
            except queue.Empty:
                raise ChildDied(why) from None
            if not line:
                raise ChildDied("")
            value = _json(line)
            if self._is_ready and is_answer(value):
                return value
            if not self._is_ready and isinstance(value, dict) and value.get("ready") is True:
                if version is None or value.get("thenar") != version:
                    raise OtherVersion(_of_another(value.get("thenar"), version))
                self._is_ready, until = True, time.monotonic() + limit_s
            elif not self._is_ready and isinstance(value, dict) and {"summary", "error"} & value.keys():
                summary = value.get("summary")
                made_with = summary.get("made_with", "") if isinstance(summary, dict) else ""
                raise OtherVersion(_of_another(f"{made_with}, but of an older build".lstrip(", "), version))
            elif value is not None:
                why = f"it answered nonsense ({line.strip()[:60]!r})"
                if self._is_ready:
                    raise ChildDied(why)
                until = min(until, time.monotonic() + NONSENSE_S)

    def _end(self, why, task):
        if why:
            self._process.kill()
        code = self._process.wait()
        self._complaints.seek(0)
        lines = [line for line in self._complaints.read().decode(errors="replace").splitlines() if line.strip()]
        _sweep(task.get("stem"), self._process.pid)
        self.close()
        return why or f"the process ended with code {code}" + (f": {lines[-1].strip()}" if lines else "")


class Children:
    """A worker process for each thread that asks."""

    def __init__(self):
        self._children = {}
        self._is_stopped = False

    def solve(self, start, task, limit_s):
        """The answer to `task`; `start` is the command and the environment of a process.

        A death is one more try; after `TIMES_TRIED` the answer is `{"error": ...}`. A worker of another version is no
        error of the case: `{"refused": ...}`.
        """
        why = ""
        for _ in range(TIMES_TRIED):
            if self._is_stopped:
                break
            child = self._children.get(threading.get_ident())
            if child is None or child.start != start:  # of another batch
                if child is not None:
                    child.close()
                child = self._children[threading.get_ident()] = Child(*start)
            try:
                return child.solve(task, limit_s)
            except ChildDied as died:
                why = str(died)
                del self._children[threading.get_ident()]
            except OtherVersion as other:
                return {"refused": str(other)}
            except OSError as error:
                return {"refused": f"no worker starts on '{platform.node()}' by {start[0]!r}: {error}"}
        return {"error": "stopped"} if self._is_stopped else {"error": f"{why}, {TIMES_TRIED} times"}

    def stop(self):
        """End all processes at once, and start none again; from any thread, more than once."""
        self._is_stopped = True
        for child in list(self._children.values()):
            child.kill()

    def close(self):
        """End all processes, once no thread asks any more."""
        for child in self._children.values():
            child.close()
        self._children.clear()


def is_answer(value):
    """Whether a value is what a worker may answer: an error in words, or a summary with its `NUMBERS`."""
    if not isinstance(value, dict):
        return False
    if isinstance(value.get("error"), str) and value["error"]:
        return "summary" not in value
    summary = value.get("summary")
    if not isinstance(summary, dict):
        return False
    numbers = [summary.get(name) for name in NUMBERS]
    return all(isinstance(each, int | float) and not isinstance(each, bool) and isfinite(each) for each in numbers)


def words(text):
    """The words of a command line; quotes join them, and a backslash is a letter as any other, as in Windows' paths."""
    return [double or single or plain for double, single, plain in re.findall(r"\"([^\"]*)\"|'([^']*)'|(\S+)", text)]


def solve_on_node(tasks, environment, limit_s):
    """Seconds and the answers to `tasks` on a worker of a Dask cluster, by a process that stays with the worker."""
    from distributed import get_worker

    command = words(os.environ.get("THENAR_WORKER", "")) or [sys.executable, "-m", "thenar_blender", "worker"]
    # This function comes again with every task; the first one's object stays, so that its errors are known to it.
    children = get_worker().__dict__.setdefault("thenar_children", Children())
    began = time.monotonic()
    answers = [children.solve((command, environment), task, limit_s) for task in tasks]
    return time.monotonic() - began, answers


def _of_another(found, wanted):
    """The sentence that refuses a worker of the version `found`."""
    where = f"the worker on '{platform.node()}' is of Thenar {found}".replace("Thenar Thenar", "Thenar")
    return f"{where}, this batch of Thenar {wanted}; install the same version there"


def _json(line):
    """The value of a line, or None where it is no JSON (or null)."""
    try:
        return json.loads(line)
    except (ValueError, RecursionError):
        return None


def _sweep(stem, pid):
    """Remove what a dead process had begun to write for a case."""
    if not stem:
        return
    folder, name = os.path.split(stem)
    with suppress(OSError):
        for each in os.listdir(folder or "."):
            if each.startswith(f".{name}.{pid}."):
                with suppress(OSError):
                    os.remove(os.path.join(folder, each))


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


def _hear(stream, lines):
    """Passes lines on as they come; an empty one says that the process is gone."""
    with stream:
        while line := stream.readline(LONGEST_LINE):
            try:
                lines.put(line, timeout=NONSENSE_S)
            except queue.Full:  # nobody listens any more, and the process goes on
                return
    with suppress(queue.Full):
        lines.put("", timeout=NONSENSE_S)
