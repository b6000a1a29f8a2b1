"""Cases on this machine: a few worker processes, each solving one case after the other."""

import os
import sys
from concurrent.futures import ThreadPoolExecutor, as_completed, wait
from contextlib import suppress
from pathlib import Path

import bpy

from .child import PROCESSORS, Children

SPAN_S = 3600.0
"""Longest time for one case, s: a grasp takes seconds and its picture a minute; what takes an hour hangs."""
ONE_THREAD = {"RAYON_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
"""Cases side by side use the processors better than threads within one; the results are the same."""


def threads(tasks):
    """Variables that say how many threads a worker process takes: one, but for pictures as many as Blender wants.

    In a small scene Blender's threads cost more than they do: 3 to 7 ms a case.
    """
    if any(task["case"].get("render", False) for task in tasks):
        return ONE_THREAD
    return {**ONE_THREAD, PROCESSORS: "one"}


def workers_of(wanted):
    """How many processes: as wanted, or for 0 one for each processor, with room for 2 GiB each."""
    if wanted > 0:
        return wanted
    return max(1, min(os.cpu_count() or 1, free_bytes() // (2 << 30)))


def free_bytes():
    """Memory that processes may take, bytes; as good as endless where the system does not say (macOS)."""
    if sys.platform == "win32":
        return _free_bytes_of_windows()
    with suppress(OSError, ValueError, IndexError):
        for line in Path("/proc/meminfo").read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return int(line.split()[1]) << 10
    return 1 << 60


def _free_bytes_of_windows():
    """`ullAvailPhys` of the structure MEMORYSTATUSEX: two numbers of 32 bits, then seven of 64."""
    import ctypes

    status = (ctypes.c_uint64 * 8)()
    ctypes.cast(status, ctypes.POINTER(ctypes.c_uint32))[0] = ctypes.sizeof(status)
    is_known = ctypes.windll.kernel32.GlobalMemoryStatusEx(ctypes.byref(status))
    return status[2] if is_known else 1 << 60


def command():
    """How a worker process is started on this machine."""
    package = __package__.rpartition(".")[0]
    if package == "thenar_blender" or not bpy.app.binary_path:
        return [sys.executable, "-m", package, "worker"]
    return [bpy.app.binary_path, "-b", "--command", "thenar", "worker"]


def environment(tasks):
    """Variables of a worker process for `tasks` besides our own."""
    paths = [str(Path(__file__).parent.parent.parent), os.environ.get("PYTHONPATH", "")]
    return {"PYTHONPATH": os.pathsep.join(path for path in paths if path), **threads(tasks)}


def answers(tasks, workers):
    """Yield (name, answer) for every task, as they come."""
    children = Children()
    start = command(), environment(tasks)

    def answer(task):
        return children.solve(start, task, SPAN_S)

    pool = ThreadPoolExecutor(max_workers=min(workers, len(tasks)))
    under_way = {}
    try:
        under_way = {pool.submit(answer, task): task["case"]["name"] for task in tasks}
        for future in as_completed(under_way):
            yield under_way[future], future.result()
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        waiting = [future for future in under_way if not future.done()]
        while waiting:  # a thread may have started a process meanwhile
            children.stop()
            waiting = wait(waiting, timeout=0.2).not_done
        pool.shutdown()
        children.close()
