"""Cases on the workers of a Dask cluster. What was not answered when a connection broke is asked again.

A worker machine needs the package `distributed` and a way to start Thenar: `python -m thenar_blender worker` with the
Python that runs Dask, or what the variable THENAR_WORKER says there, such as `blender -b --command thenar worker`.
"""

import hashlib
import re
import time
from concurrent.futures import CancelledError

from ..scene.checks import Refusal
from . import child
from .here import SPAN_S, threads

FIRST_S = 8.0
"""How long a scheduler may take to answer for the first time, s: a wrong address is to be known soon."""
PATIENCE_S = 300.0
"""How long a scheduler that has answered may stay away before the batch gives up; a later run goes on from there."""
ADDRESS = re.compile(r"(?:(?:tcp|tls|ws|wss|ucx)://)?(?:\[[0-9a-fA-F:.]+\]|[\w.-]+):(\d{1,5})")
"""An address of Dask with its port."""
GROUP_S, LEAST_S = 1.0, 0.1
"""Seconds of solving that are sent at once as a group, and the least at the end of a batch: what Dask takes for a task
is then little beside it, little is lost with a worker, and all end together."""
MOST_AT_ONCE = 100
"""Cases in a group."""
AHEAD = 2
"""Groups under way for each thread of a worker: one that is solved, one that waits there."""
SHARE = 4
"""A thread never takes more at once than one such part of what would be left for it."""
COUNTED_EVERY_S = 5.0
"""How often the threads of the cluster are counted, s: workers come and go."""
CALM_S = 2.0
"""Between attempts to connect, s."""


def answers(tasks, address):
    """Yield (name, answer) for every task, as they come.

    Raises `Refusal` for what is no address, where Dask is missing, where no scheduler answers within `FIRST_S`, and
    where it then stays away for `PATIENCE_S`.
    """
    found = ADDRESS.fullmatch(address)
    if not found or not 0 < int(found[1]) < 65536:
        raise Refusal(
            f"'{address}' is no address of a scheduler; give it as tcp://HOST:PORT, for example tcp://farm:8786"
        )
    try:
        import cloudpickle
        import distributed
    except ImportError:
        raise Refusal(
            "a scheduler needs the package 'distributed' in this Python; install it with "
            "'python -m pip install distributed', or leave --scheduler out to use this machine"
        ) from None
    cloudpickle.register_pickle_by_value(child)
    left = {task["case"]["name"]: task for task in tasks}
    environment = threads(tasks)
    seen, patience_s = time.monotonic(), 0.0
    while left:
        try:
            with distributed.Client(address, timeout=FIRST_S, set_as_default=False, name="thenar batch") as client:
                seen, patience_s = time.monotonic(), PATIENCE_S
                for name, answer in _session(client, left, environment):
                    del left[name]
                    seen = time.monotonic()
                    yield name, answer
        except (OSError, TimeoutError, RuntimeError, ValueError) as error:
            if time.monotonic() - seen > patience_s:
                raise Refusal(
                    f"no scheduler answers at {address} ({error}); {len(left)} cases are left, which the same "
                    "command will run once it does"
                ) from None
        if left:
            time.sleep(CALM_S)


def _session(client, left, environment):
    """Answers until all are there or the connection breaks; a case that kills its workers is an error of its own."""
    import distributed

    sender = _Sender(client, list(left.values()), environment)
    coming = distributed.as_completed(sender.more(), loop=client.loop)
    for future in coming:
        group = sender.futures.pop(future)
        if future.status == "finished":
            try:
                span_s, answered = future.result()
            except CancelledError:  # the connection broke while the answer was on its way
                return
            sender.case_s = span_s / len(group)
            coming.update(sender.more())  # before the answers are written: nobody waits for that
            yield from zip((task["case"]["name"] for task in group), answered, strict=True)
            continue
        if future.status != "error":
            return
        if len(group) > 1:
            coming.update([sender.send([task]) for task in group])  # which of them it was shows alone
            continue
        coming.update(sender.more())
        if "KilledWorker" in type(future.exception()).__name__:
            yield group[0]["case"]["name"], {"error": "every worker that took this case died"}
        else:
            why = " ".join(f"the worker failed: {future.exception()!r}".split())
            yield group[0]["case"]["name"], {"error": why}


class _Sender:
    """Sends `tasks` in order. `futures` are the groups under way, `case_s` the seconds a case of the last answered."""

    def __init__(self, client, tasks, environment):
        self._client, self._tasks, self._environment = client, tasks, environment
        self._sent, self._threads, self._counted = 0, 1, float("-inf")
        self.futures, self.case_s = {}, None

    def more(self):
        """Send groups until every thread has its `AHEAD`. Returns their futures."""
        if time.monotonic() - self._counted > COUNTED_EVERY_S:
            self._threads = max(1, sum(self._client.nthreads().values()))
            self._counted = time.monotonic()
        new = []
        while self._sent < len(self._tasks) and len(self.futures) < AHEAD * self._threads:
            size = _size(len(self._tasks) - self._sent, self._threads, self.case_s)
            new.append(self.send(self._tasks[self._sent : self._sent + size]))
            self._sent += size
        return new

    def send(self, group):
        """Send these tasks as one. Returns the future of (seconds, answers)."""
        digest = hashlib.blake2b(" ".join(task["hash"] for task in group).encode(), digest_size=16).hexdigest()
        more = {"key": f"thenar-{digest}", "pure": True}
        future = self._client.submit(child.solve_on_node, group, self._environment, SPAN_S, **more)
        self.futures[future] = group
        return future


def _size(left, threads, case_s):
    """How many of `left` cases to send to one of `threads` at once. A case takes `case_s` seconds; None: unknown."""
    if case_s is None:
        return 1
    most, least = (max(1, min(MOST_AT_ONCE, int(span_s / max(case_s, 1e-6)))) for span_s in (GROUP_S, LEAST_S))
    return min(left, max(least, min(most, left // (SHARE * threads))))
