"""The extension in a Blender program, not the bpy module: `blender -b FILE --command thenar solve` and `batch`.

Looks for the program in the variable BLENDER, else on the path; skipped where there is none.
"""

import csv
import json
import os
import shutil
import subprocess

import products
import pytest

PROGRAM = os.environ.get("BLENDER") or shutil.which("blender")
pytestmark = pytest.mark.skipif(not PROGRAM, reason="needs a Blender program on the path, or named by BLENDER")

SAMPLE = products.ROOT / "blend-samples/fingertip_on_plate.blend"


@pytest.fixture(scope="module")
def blender(tmp_path_factory):
    """Runs Blender in background in a folder of its own, where the extension is installed: `(run, folder)`."""
    folder = tmp_path_factory.mktemp("program")
    environment = os.environ | {"BLENDER_USER_RESOURCES": str(folder / "resources"), "HOME": str(folder)}
    shutil.copy(products.ZIP, folder / "extension.zip")
    shutil.copy(SAMPLE, folder / "tip.blend")

    def run(*arguments):
        call = [PROGRAM, "-b", *map(str, arguments)]
        return subprocess.run(call, capture_output=True, text=True, timeout=240, env=environment, cwd=folder)

    done = run("--command", "extension", "install-file", "-r", "user_default", "--enable", folder / "extension.zip")
    assert done.returncode == 0, done.stdout + done.stderr
    return run, folder


def test_solve_writes_file_and_summary(blender):
    run, folder = blender
    done = run(
        "tip.blend", "--command", "thenar", "solve", "--hand", "Hand", "--product", "Plate", "--force", "3",
        "--out", "solved.blend", "--json", "solved.json",
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    summary = json.loads((folder / "solved.json").read_text())
    assert summary["force_n"] == pytest.approx(3.0, rel=0.02)
    assert summary["penetration_after_mm"] < 0.02
    again = run("solved.blend", "--command", "thenar", "solve", "--json", "again.json")
    assert again.returncode == 0, again.stderr
    twice = json.loads((folder / "again.json").read_text())
    assert twice["force_n"] == pytest.approx(summary["force_n"], rel=1e-6), "the saved contact is not read as posture"


def test_bad_input_is_one_sentence(blender):
    run, _ = blender
    done = run("tip.blend", "--command", "thenar", "solve", "--hand", "Paw")
    assert done.returncode == 2
    assert "thenar: there is no object 'Paw' for the hand" in done.stderr and "Traceback" not in done.stderr


def test_batch_runs_blender_for_every_case_and_resumes(blender):
    run, folder = blender
    (folder / "jobs.toml").write_text(
        'blend = "tip.blend"\nsave = false\n[[case]]\nname = "posed"\n'
        '[[case]]\nname = "two newtons"\nforce_n = 2.0\n[[case]]\nname = "bad"\nhand = "Paw"\n'
    )
    for states in (["done", "done", "failed"], ["kept", "kept", "failed"]):
        done = run("--command", "thenar", "batch", "jobs.toml", "--out", "out")
        assert done.returncode == 2 and "1 of 3 cases failed (bad)" in done.stderr, done.stdout + done.stderr
        rows = list(csv.DictReader((folder / "out/results.csv").open()))
        assert [row["status"] for row in rows] == states
    assert float(rows[1]["force_n"]) == pytest.approx(2.0, rel=0.02)
