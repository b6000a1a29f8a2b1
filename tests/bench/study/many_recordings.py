"""Loads studies of N recordings: `target/venv/bin/python tests/bench/study/many_recordings.py [N ...]`; 30,000."""

import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

WANTED_S = 10.0
HEAD = """[study]
title = "many"

[skin]
mesh = "skin.obj"

[skin.materials.default]
g0_mpa = 0.005
g_lim_mpa = 0.09
d_lim_mm = 4.0
thickness_mm = 7.0

[indenters.plate]
shape = "plane"

[sites.pad]
point_mm = [0.5, 0.25, 0.0]
direction = [0.0, 0.0, -1.0]
"""
RECORDING = """
[[recordings]]
name = "press {k}"
kind = "indentation"
file = "{k}.csv"
indenter = "plate"
site = "pad"
protocol = "protocol {protocol}"
subject = "{subject}"
rest_s = 30
"""
SAMPLES = 20


def main(counts):
    """Writes and loads a study of each size, each in a process of its own; exits with 1 if one takes too long."""
    is_met = True
    for count in counts:
        with tempfile.TemporaryDirectory() as folder:
            write(Path(folder), count)
            loader = subprocess.run(
                [sys.executable, __file__, "--load", folder], capture_output=True, text=True, check=True
            )
        loaded, seconds, megabytes = loader.stdout.split()
        assert int(loaded) == count, loader.stdout
        is_met &= float(seconds) <= WANTED_S
        print(
            f"{count} recordings: {seconds} s, {megabytes} MB more ({1e3 * float(megabytes) / count:.1f} kB each)",
            flush=True,
        )
    return 0 if is_met else 1


def write(folder, count):
    """A study of `count` indentations of 20 samples, each with a file of its own."""
    (folder / "skin.obj").write_text("v 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\n")
    recordings = [RECORDING.format(k=k, protocol=k // 3, subject=k % 40) for k in range(count)]
    (folder / "study.toml").write_text(HEAD + "".join(recordings))
    for k in range(count):
        rows = [f"{0.1 * i:.1f},{0.05 * i:.2f},{0.01 * i * i + 1e-4 * (k % 97):.4f}" for i in range(SAMPLES)]
        (folder / f"{k}.csv").write_text("time_s,depth_mm,force_n\n" + "\n".join(rows) + "\n")


def load(folder):
    """Loads the study; prints its recordings, the time, and the memory it took beyond that of the module."""
    import thenar

    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    started = time.perf_counter()
    study = thenar.Study.load(folder)
    seconds = time.perf_counter() - started
    megabytes = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    assert all(len(each["curve"]["channels"]["force_n"]) == SAMPLES for each in study.recordings)
    print(len(study.recordings), f"{seconds:.2f}", f"{megabytes:.0f}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--load"]:
        load(sys.argv[2])
    else:
        sys.exit(main([int(word) for word in sys.argv[1:]] or [30_000]))
