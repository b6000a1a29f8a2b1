"""A small scene, and the batch as a process of its own, for the tests of this folder."""

import csv
import subprocess
import sys

import bpy
import dask_cluster
import pytest
import stage


@pytest.fixture
def ball(tmp_path):
    """The path of a saved scene that is pressed in milliseconds."""
    stage.scene()
    path = tmp_path / "ball.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


@pytest.fixture
def batch(tmp_path):
    """Runs a batch of `tmp_path/jobs.toml`; gives (exit code, what it printed, rows of its table)."""

    def run(out, *more, **options):
        command = [sys.executable, "-m", "thenar_blender", "batch", tmp_path / "jobs.toml", "--out", out, *more]
        environment = dask_cluster.environment() | options.pop("environment", {})
        output = subprocess.run(
            [str(part) for part in command], capture_output=True, text=True, env=environment, timeout=240, **options
        )
        table = out / "results.csv"
        rows = list(csv.DictReader(table.open(encoding="utf-8", newline=""))) if table.is_file() else []
        return output.returncode, output.stdout + output.stderr, rows

    return run
