"""Cases on this machine: a few worker processes, each solving one case after the other."""

import os
import sys
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

import bpy

from .child import PROCESSORS, solve

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
    try:
        pages, size = os.sysconf("SC_AVPHYS_PAGES"), os.sysconf("SC_PAGE_SIZE")
    except (ValueError, OSError):
        pages, size = 1 << 40, 1
    return max(1, min(os.cpu_count() or 1, pages * size // (2 << 30)))


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
    children = {}
    start = command(), environment(tasks)

    def answer(task):
        return solve(children, start, task, SPAN_S)

    pool = ThreadPoolExecutor(max_workers=workers)
    try:
        under_way = {pool.submit(answer, task): task["case"]["name"] for task in tasks}
        for future in as_completed(under_way):
            yield under_way[future], future.result()
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for child in list(children.values()):
            child.close()
        pool.shutdown()
