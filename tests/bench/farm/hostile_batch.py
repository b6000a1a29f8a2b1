"""A batch of 500 cases, 40 of them bad, under trouble: workers killed at random, the disk full once, started again.

    PYTHONPATH=tests target/venv/bin/python tests/bench/farm/hostile_batch.py [--cases 500] [--seed 1]

Prints for each run how it ended, and whether every sound case is there once, each bad one a row with its reason, and
the tables the same bytes as those of a run without trouble. The full disk is a tmpfs of 24 MiB, for which it must be
allowed to mount; without that the step is left out and said so.
"""

import argparse
import csv
import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "blender"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "blender" / "farms"))

import bpy
import dask_cluster
import hostile_jobs
import results
import stage
import thenar_blender

TABLES = ("results.csv", "results.parquet", "summary.csv")
DISK = "size=24m"


class Trouble(threading.Thread):
    """Kills a worker of the batch now and then."""

    def __init__(self, pid, seed):
        super().__init__(daemon=True)
        self.pid, self.random, self.killed = pid, random.Random(seed), 0
        self.ended = threading.Event()

    def run(self):
        """Until `ended` is set."""
        while not self.ended.wait(self.random.uniform(0.5, 4.0)):
            workers = _children(self.pid)
            if workers:
                try:
                    os.kill(self.random.choice(workers), signal.SIGKILL)
                    self.killed += 1
                except ProcessLookupError:
                    pass


def _children(pid):
    try:
        threads = list(Path(f"/proc/{pid}/task").iterdir())
        return [int(each) for thread in threads for each in (thread / "children").read_text().split()]
    except OSError:
        return []


def _start(jobs, out):
    command = [sys.executable, "-m", "thenar_blender", "batch", str(jobs), "--out", str(out), "--workers", "2"]
    return subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        errors="replace",
        env=dask_cluster.environment(),
    )


def _finish(process, what, on_case=None):
    """Read to the end. Returns the exit code and the lines."""
    began, lines = time.monotonic(), []
    for line in process.stdout:
        lines.append(line)
        if on_case is not None and (": done" in line or ": failed" in line):
            on_case(len(lines))
    code = process.wait()
    traceback = "a traceback" if any("Traceback" in line for line in lines) else "no traceback"
    print(f"{what}: code {code}, {time.monotonic() - began:.0f} s, {traceback}: {lines[-1].strip()[:150]}", flush=True)
    return code, lines


def _fill(disk):
    """Take all room of the disk; returns the file that holds it."""
    ballast = disk / "ballast"
    with ballast.open("wb", buffering=0) as file:
        try:
            while True:
                file.write(b"\0" * 4096)
        except OSError:
            return ballast


def _faults(out, sound, bad):
    """Sentences on what is wrong with the tables of a finished batch."""
    with (out / "results.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    done = [row for row in rows if row["status"] == "done"]
    failed = [row for row in rows if row["status"] == "failed"]
    if len(done) != sound or len({row["case_hash"] for row in done}) != sound:
        yield f"{len(done)} sound cases done, of {len({row['case_hash'] for row in done})} digests; {sound} wanted"
    if len(list(out.glob("*.json"))) != sound:
        yield f"{len(list(out.glob('*.json')))} files of results, {sound} wanted"
    if len(failed) != len(bad):
        yield f"{len(failed)} failed, {len(bad)} wanted: {[row['name'] for row in failed]}"
    for lines, words in bad:
        if not any(words in row["message"] and row["message"] for row in failed):
            yield f"no row says '{words}' of {lines.splitlines()[0]}"
    left = [path.name for path in out.iterdir() if path.name.startswith(".")]
    if left:
        yield f"partial files are left: {left[:5]}"


def main():
    """All runs, then the row."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--cases", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    bad = hostile_jobs.BAD[: max(1, options.cases * 40 // 500)]
    sound = options.cases - len(bad)
    thenar_blender.register()
    faults = []
    with tempfile.TemporaryDirectory() as name:
        folder, disk = Path(name), Path(name) / "disk"
        stage.scene()
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / "ball.blend"))
        hostile_jobs.files(folder)
        jobs = folder / "jobs.toml"
        jobs.write_text(hostile_jobs.job_file(bad, sound), encoding="utf-8")
        disk.mkdir()
        is_small = os.name == "posix" and subprocess.run(
            ["mount", "-t", "tmpfs", "-o", DISK, "none", str(disk)], capture_output=True
        ).returncode == 0  # fmt: skip
        out = disk / "out"
        try:
            process = _start(jobs, out)
            trouble = Trouble(process.pid, options.seed)
            trouble.start()
            ballast = []

            def fill(count):
                if is_small and count > options.cases // 2 and not ballast:
                    ballast.append(_fill(disk))

            _, lines = _finish(process, "workers killed, disk full from the half on", fill)
            trouble.ended.set()
            lost = sum("cannot be written" in line or "No space" in line for line in lines)
            print(f"{trouble.killed} workers killed; {lost} lines say that the disk was full", flush=True)
            for file in ballast:
                file.unlink()
            process = _start(jobs, out)
            threading.Timer(6.0, process.send_signal, (signal.SIGTERM,)).start()
            code, lines = _finish(process, "started again, SIGTERM after 6 s")
            if any("Traceback" in line for line in lines):
                faults.append("a traceback at SIGTERM")
            process = _start(jobs, out)
            trouble = Trouble(process.pid, options.seed + 1)
            trouble.start()
            _finish(process, "started again, workers killed")
            trouble.ended.set()
            code, _ = _finish(_start(jobs, out), "started a last time")
            faults += [] if code == 2 else [f"code {code}, 2 wanted"]
            faults += _faults(out, sound, bad)
            _finish(_start(jobs, folder / "calm"), "without trouble")
            faults += _faults(folder / "calm", sound, bad)
            same = all((out / each).read_bytes() == (folder / "calm" / each).read_bytes() for each in TABLES)
            if not same:
                faults.append("other bytes than without trouble")
            outside = {path.name for path in folder.iterdir()} - {
                "ball.blend", "text.blend", "cut.blend", "folder.blend", "pipe.blend", "jobs.toml", "disk", "calm",
            }  # fmt: skip
            if outside:
                faults.append(f"files outside of --out: {outside}")
        finally:
            if is_small:
                subprocess.run(["umount", "-l", str(disk)], check=False)
    for fault in faults:
        print("FAULT:", fault)
    full = "the disk full once" if is_small else "no disk could be mounted"
    figure = results.Figure(
        f"batch of {options.cases} cases, {len(bad)} bad; workers killed at random, {full}, stopped, started again",
        "every sound case once, each bad one a row, same bytes",
        f"{sound} done once, {len(bad)} rows with their reasons, same bytes" if not faults else "; ".join(faults)[:200],
        not faults,
    )
    print(figure)
    results.record("bench", "PYTHONPATH=tests target/venv/bin/python tests/bench/farm/hostile_batch.py", [figure])
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
