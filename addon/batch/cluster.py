"""Cases on the workers of a Dask cluster. What was not answered when a connection broke is asked again.

A worker machine needs the package `distributed` and a way to start Thenar: `python -m thenar_blender worker` with the
Python that runs Dask, or what the variable THENAR_WORKER says there, such as `blender -b --command thenar worker`.
"""

import hashlib
import time
from concurrent.futures import CancelledError

from ..scene.checks import Refusal
from . import child
from .here import ONE_THREAD, SPAN_S

PATIENCE_S = 300.0
"""How long a scheduler may stay away before the batch gives up; a later run goes on from there."""
MOST_AT_ONCE = 8
"""Cases sent to a worker at once: what Dask takes for a task is then little beside a case of some hundredths of a
second, and little is lost with a worker."""
GROUPS_EACH = 8
"""Such lists that each thread of a worker gets at least, so that all end together."""
CALM_S = 2.0
"""Between attempts to connect, s."""


def answers(tasks, address):
    """Yield (name, answer) for every task, as they come.

    Raises `Refusal` where Dask is missing, or the scheduler stays away for `PATIENCE_S`.
    """
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
    seen = time.monotonic()
    while left:
        try:
            with distributed.Client(address, timeout=10, set_as_default=False, name="thenar batch") as client:
                seen = time.monotonic()
                for name, answer in _session(client, left):
                    del left[name]
                    seen = time.monotonic()
                    yield name, answer
        except (OSError, TimeoutError, RuntimeError) as error:
            if time.monotonic() - seen > PATIENCE_S:
                raise Refusal(
                    f"no scheduler answers at {address} ({error}); {len(left)} cases are left, which the same "
                    "command will run once it does"
                ) from None
        if left:
            time.sleep(CALM_S)


def _session(client, left):
    """Answers until all are there or the connection breaks; a case that kills its workers is an error of its own."""
    import distributed

    groups = _grouped(list(left.values()), sum(client.nthreads().values()))
    futures = {_submitted(client, group): group for group in groups}
    coming = distributed.as_completed(list(futures), loop=client.loop)
    for future in coming:
        group = futures.pop(future)
        if future.status == "finished":
            try:
                answered = future.result()
            except CancelledError:  # the connection broke while the answer was on its way
                return
            yield from zip((task["case"]["name"] for task in group), answered, strict=True)
        elif future.status == "error" and len(group) > 1:
            for task in group:  # which of them it was shows alone
                alone = _submitted(client, [task])
                futures[alone] = [task]
                coming.add(alone)
        elif future.status == "error" and "KilledWorker" in type(future.exception()).__name__:
            yield group[0]["case"]["name"], {"error": "every worker that took this case died"}
        elif future.status == "error":
            why = " ".join(f"the worker failed: {future.exception()!r}".split())
            yield group[0]["case"]["name"], {"error": why}
        else:
            return


def _grouped(tasks, threads):
    """Lists of tasks that are sent at once: few where each worker has few."""
    size = max(1, min(MOST_AT_ONCE, len(tasks) // (GROUPS_EACH * max(threads, 1))))
    return [tasks[first : first + size] for first in range(0, len(tasks), size)]


def _submitted(client, group):
    digest = hashlib.blake2b(" ".join(task["hash"] for task in group).encode(), digest_size=16).hexdigest()
    return client.submit(child.solve_on_node, group, ONE_THREAD, SPAN_S, key=f"thenar-{digest}", pure=True)
