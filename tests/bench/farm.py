"""A batch of 1,000 cases on two Dask workers, one killed half-way, the scheduler restarted, against one process.

    target/venv/bin/python tests/bench/farm.py [--cases 1000]

Prints the throughput as a ratio of the two runs, and whether the tables are the same bytes.
"""

import argparse
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "blender"))

import bpy
import dask_cluster
import results
import stage
import thenar_blender

FORCES, STIFFNESSES = 20, 50
WANTED = 1.8
"""Throughput of two workers over one process."""
PATIENCE_S = 180.0
"""Without a line for as long, a batch hangs and is ended: longer than a cluster takes to begin again."""


def run(folder, out, *more):
    """Start the batch as a process whose lines can be read."""
    command = [sys.executable, "-m", "thenar_blender", "batch", folder / "jobs.toml", "--out", folder / out, *more]
    return subprocess.Popen(
        [str(part) for part in command], stdout=subprocess.PIPE, text=True, env=dask_cluster.environment()
    )


def patience(process):
    """A clock that ends the process when it runs out."""
    watch = threading.Timer(PATIENCE_S, process.kill)
    watch.daemon = True
    watch.start()
    return watch


def drain(process, on_case=None):
    """Read to the end; `on_case(count)` after each case. Returns the seconds between the first and the last case."""
    count, first = 0, None
    watch = patience(process)
    for line in process.stdout:
        watch.cancel()
        watch = patience(process)
        if line.startswith("push-"):
            count += 1
            first = first or time.monotonic()
            if on_case is not None:
                on_case(count)
    code = process.wait()
    watch.cancel()
    if code != 0:
        raise SystemExit(f"the batch ended with code {code} after {count} cases")
    return count, time.monotonic() - first


def main():
    """Both runs, then the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--cases", type=int, default=FORCES * STIFFNESSES)
    cases = parser.parse_args().cases
    stiffnesses = max(1, cases // FORCES)
    thenar_blender.register()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        stage.scene()
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / "grip.blend"))
        forces = [round(0.5 + 0.1 * k, 3) for k in range(FORCES)]
        factors = [round(0.8 + 0.01 * k, 3) for k in range(stiffnesses)]
        (folder / "jobs.toml").write_text(
            f'blend = "grip.blend"\nsave = false\n[[sweep]]\nname = "push"\nforce_n = {forces}\nstiffness = {factors}\n'
        )
        count, alone_s = drain(run(folder, "alone", "--workers", 1))
        cluster = dask_cluster.Cluster(folder)
        try:
            cluster.begin()
            _, two_s = drain(run(folder, "two", "--scheduler", cluster.address))

            def trouble(answered):
                if answered == count // 2:
                    cluster.workers[0].kill()
                if answered == count // 2 + count // 10:
                    cluster.end()
                    cluster.begin()

            answered, _ = drain(run(folder, "troubled", "--scheduler", cluster.address), trouble)
        finally:
            cluster.end()
        same = {
            out: all(
                (folder / "alone" / table).read_bytes() == (folder / out / table).read_bytes()
                for table in ("results.csv", "results.parquet", "summary.csv")
            )
            for out in ("two", "troubled")
        }
    print(f"{count} cases: one process {count / alone_s:.1f} cases/s, two Dask workers {count / two_s:.1f} cases/s")
    throughput = alone_s / two_s
    print(f"throughput: {throughput:.2f}x")
    print(f"tables of two workers are the same bytes: {same['two']}")
    print(
        f"one killed half-way and the scheduler restarted: {answered} answers for {count} cases, "
        f"the same bytes: {same['troubled']}"
    )
    bytes_of = "same bytes" if all(same.values()) else "other bytes"
    figure = results.Figure(
        f"{count:,} cases on two Dask workers, one killed, the scheduler restarted, over one process",
        f"{WANTED:g}x, same bytes",
        f"{throughput:.2f}x, {bytes_of}, {answered} answers",
        throughput >= WANTED and all(same.values()) and answered == count,
    )
    results.record("bench", "target/venv/bin/python tests/bench/farm.py", [figure])


if __name__ == "__main__":
    main()
