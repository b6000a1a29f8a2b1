"""How long a diagnosis takes: studies of the second trial, filled to 13 recordings by what was recorded next.

    python tests/bench/diagnosis.py [STUDIES]        (where Thenar can be imported)

Wall time from files to findings on two threads, and with one thread, which tells what the second core is worth: the
machine must be quiet. Recordings hold 85 to 106 samples.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

TESTS = Path(__file__).parents[1]
RECORDINGS, CORES = 13, 2
WANTED_S, GOAL_S = 180.0, 60.0


def main(count):
    """Measures `count` studies; prints the table. Returns 1 if one takes too long."""
    sys.path.insert(0, str(TESTS))
    import results
    from trial import cases

    able = [case for case in cases.names("second") if cases.goes_on(case)]
    every = len(able) // count
    print("study        recordings samples  wall, s: 2 threads  1 thread  steps of progress")
    both = []
    for case in able[: every * count : every]:
        with tempfile.TemporaryDirectory() as folder:
            cases.follow_up(case, to_fill(cases, case), folder)
            sizes = [len(file.read_text().splitlines()) - 1 for file in Path(folder).glob("press_*.csv")]
            two, one = (timed(folder, threads) for threads in (CORES, 1))
        both.append(two[0])
        print(f"{case:12s} {len(sizes):10d} {sum(sizes):7d} {two[0]:19.1f} {one[0]:9.1f} {two[1]:18d}", flush=True)
    wanted = f"wanted at most {WANTED_S:g} s, goal {GOAL_S:g} s"
    measured = f"median {statistics.median(both):.1f} s, most {max(both):.1f} s"
    print(f"{measured}; {wanted}")
    what = f"a diagnosis of {RECORDINGS} recordings on {CORES} cores"
    figure = results.Figure(what, f"{WANTED_S:g} s", f"{measured} of {count} studies", max(both) <= WANTED_S)
    results.record("bench", f"target/venv/bin/python tests/bench/diagnosis.py {count}", [figure])
    return int(max(both) > WANTED_S)


def to_fill(cases, case):
    """Times by protocol that make a study of `RECORDINGS`."""
    held, there = cases.held_back(case), sum(not one["held_back"] for one in cases.recordings(case))
    often, left = divmod(RECORDINGS - there, len(held))
    return {name: often + (k < left) for k, name in enumerate(held) if often + (k < left)}


def timed(folder, threads):
    """(seconds, steps of progress) of one diagnosis, in a process of its own: the number of threads is fixed there."""
    environment = {**os.environ, "RAYON_NUM_THREADS": str(threads)}
    done = subprocess.run(
        [sys.executable, __file__, "--one", folder], env=environment, capture_output=True, text=True, check=True
    )
    seconds, steps = done.stdout.split()
    return float(seconds), int(steps)


def one(folder):
    """Diagnoses a study; prints seconds and how often progress was told."""
    import thenar

    told = []
    began = time.perf_counter()
    thenar.diagnose(thenar.Study.load(folder), progress=lambda *step: told.append(step))
    print(time.perf_counter() - began, len(told))
    return 0


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        sys.exit(one(sys.argv[2]))
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 8))
