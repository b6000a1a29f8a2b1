"""The command line: solve and batch, resumable, one bad case beside good ones."""

import json
import os
import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest
import stage
import thenar_blender


def command(*arguments, **environment):
    package = Path(thenar_blender.__file__).parent.parent
    paths = os.pathsep.join(path for path in (str(package), os.environ.get("PYTHONPATH", "")) if path)
    return subprocess.run(
        [sys.executable, "-m", "thenar_blender", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=120,
        env={**os.environ, "PYTHONPATH": paths, **environment},
    )


@pytest.fixture
def grip(tmp_path):
    stage.scene()
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = 120, 90
    path = tmp_path / "grip.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def test_solve_writes_file_and_summary(grip, tmp_path):
    expected = stage.solve().force_n
    done = command(
        "solve",
        grip,
        "--hand",
        "Pad",
        "--product",
        "Plate",
        "--out",
        tmp_path / "o.blend",
        "--json",
        tmp_path / "o.json",
        "--render",
        tmp_path / "o.png",
        "--map",
        "depth",
    )
    assert done.returncode == 0, done.stderr
    assert json.loads((tmp_path / "o.json").read_text())["force_n"] == pytest.approx(expected, rel=1e-6)
    image = bpy.data.images.load(str(tmp_path / "o.png"))
    assert tuple(image.size) == (120, 90) and np.ptp(np.array(image.pixels[:]).reshape(-1, 4)[:, :3]) > 0.3
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "o.blend"))
    assert bpy.context.scene.thenar.result.force_n == pytest.approx(expected, rel=1e-6)
    assert "Thenar Contact" in bpy.data.objects["Pad"].data.shape_keys.key_blocks


def test_bad_input_is_one_sentence(grip, tmp_path):
    done = command("solve", grip, "--hand", "Paw", "--json", tmp_path / "o.json")
    assert done.returncode == 2 and not (tmp_path / "o.json").exists()
    assert "there is no object 'Paw' for the hand; meshes in the file: Pad, Plate" in done.stderr
    assert "Traceback" not in done.stderr
    assert command("solve", tmp_path / "none.blend").returncode == 2
    done = command("solve", grip, "--map", "shear", "--render", tmp_path / "shear.png")
    assert done.returncode == 2 and not (tmp_path / "shear.png").exists()
    assert "nothing shears the skin; add the effect friction" in done.stderr


def test_demo_without_samples_says_so(tmp_path):
    done = command("demo", "--samples", tmp_path, "--out", tmp_path / "demo")
    assert done.returncode == 2 and "no sample of the 48 mm cylinder" in done.stderr


def test_a_command_leaves_no_folder_of_blender_behind(grip, tmp_path):
    kept = tmp_path / "kept"
    kept.mkdir()
    done = command("solve", grip, "--hand", "Paw", "--json", tmp_path / "o.json", TMPDIR=str(kept))
    assert done.returncode == 2 and "Paw" in done.stderr
    assert list(kept.iterdir()) == []


def test_a_folder_in_place_of_a_file_to_write_is_one_sentence(grip, tmp_path):
    done = command("solve", grip, "--hand", "Pad", "--product", "Plate", "--json", tmp_path)
    assert done.returncode == 2 and done.stderr.startswith("thenar: ") and str(tmp_path) in done.stderr
    assert "Traceback" not in done.stderr
