"""Where the products of `cargo xtask setup` lie, and how to run a script in one of its environments."""

import os
import subprocess
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TARGET = ROOT / "target"
VERSION = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]["version"]
WHEEL = TARGET / f"wheels/thenar-{VERSION}-cp311-abi3-manylinux_2_28_x86_64.whl"
ZIP = TARGET / f"dist/thenar-{VERSION}-linux_x64.zip"
BLENDERS = {"venv": "5.0", "venv45": "4.5"}
MATRIX = {"4.2": "venv42", "4.3": "venv43", "4.4": "venv44", "4.5": "venv45", "5.0": "venv"}
MATRIX |= {"5.1": "venv51", "5.2": "venv52", "5.3": "venv53"}
"""Every Blender module of PyPI that Thenar supports, by its version: its environment below `target`."""


def blender_scripts(environment):
    """Blender's own scripts inside the bpy wheel of an environment."""
    version = next(version for version, name in MATRIX.items() if name == environment)
    return next(TARGET.glob(f"{environment}/lib/python3.*/site-packages/bpy/{version}/scripts"))


def run(environment, arguments, seconds=120, **variables):
    """Runs the Python of an environment; a hang raises `subprocess.TimeoutExpired`."""
    return subprocess.run(
        [TARGET / environment / "bin/python", *arguments],
        capture_output=True,
        text=True,
        timeout=seconds,
        env=os.environ | variables,
        cwd=ROOT,
    )
