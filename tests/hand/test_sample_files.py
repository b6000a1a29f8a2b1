"""The sample files hold the same each time they are made, in a new process and with other hash seeds."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).with_name("sample_content.py")
KINDS = ("fingertip_on_plate", "bottle")
"""One that is pressed and one that is grasped; each takes seconds to fit, and the others go the same ways."""


def made(seed):
    done = subprocess.run(
        [sys.executable, SCRIPT, *KINDS],
        capture_output=True,
        text=True,
        timeout=300,
        env=os.environ | {"PYTHONHASHSEED": seed},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(done.stdout.split("CONTENT ")[1].splitlines()[0])


@pytest.fixture(scope="module")
def both():
    pytest.importorskip("thenar_blender")
    return made("1"), made("2")


@pytest.mark.parametrize("kind", KINDS)
def test_made_twice_holds_the_same(both, kind):
    first, second = both[0][kind], both[1][kind]
    assert set(first) == set(second) and {"Hand", "Hand Rig", "Camera", "Key Light"} <= set(first)
    for name, parts in first.items():
        assert parts == second[name], name


def test_the_digest_sees_a_difference(both):
    """Hands in two postures share rest shape and weights, and differ in pose and place."""
    one, other = (both[0][kind] for kind in KINDS)
    assert one["Hand"]["weights"] == other["Hand"]["weights"]
    assert one["Hand Rig"]["rest"] == other["Hand Rig"]["rest"]
    assert (
        one["Hand Rig"]["pose"] != other["Hand Rig"]["pose"] and one["Hand Rig"]["place"] != other["Hand Rig"]["place"]
    )
