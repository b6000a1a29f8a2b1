"""Solve of a sample file writes the shape key that was frozen, bit for bit, on the kinds of machine that are known.

As `rust/contact/tests/frozen` has it: the hash says that nothing changed, not that it is right. A commit that means to
change results rewrites it with THENAR_FREEZE=1, which drops those of other machines, and says so in its message.
"""

import hashlib
import json
import os
import warnings
from pathlib import Path

import bpy
import machine_kind
import numpy as np
import stage

TABLE = Path(__file__).with_name("frozen_round_trip.json")
SAMPLE = Path(__file__).parents[3] / "blend-samples/cylinder_48.blend"


def pressed():
    """The key's coordinates (n, 3), float32, after Solve on a freshly opened file, and the basis they started from."""
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLE))
    stage.solve()
    keys = bpy.context.scene.thenar.hand.data.shape_keys.key_blocks
    found = []
    for key in (keys["Thenar Contact"], keys[0]):
        coordinates = np.empty(len(key.data) * 3, np.float32)
        key.data.foreach_get("co", coordinates)
        found.append(coordinates)
    return found


def digest(coordinates):
    return hashlib.sha256(coordinates.tobytes()).hexdigest()[:16]


def test_solve_writes_the_same_key_twice_and_the_frozen_one():
    key, basis = pressed()
    again, _ = pressed()
    assert digest(key) == digest(again) and np.abs(key - basis).max() > 1e-3, "nothing was pressed"
    frozen, machine = json.loads(TABLE.read_text()), machine_kind.kind()
    if os.environ.get("THENAR_FREEZE"):
        frozen = {machine: digest(key)} | (frozen if frozen.get(machine) in (None, digest(key)) else {})
        TABLE.write_text(json.dumps(frozen, indent=2, sort_keys=True) + "\n")
    if machine not in frozen:
        warnings.warn(f"NOTHING COMPARED but two runs: {TABLE.name} does not know {machine}", stacklevel=1)
        return
    assert digest(key) == frozen[machine]


def test_the_digest_sees_the_last_bit():
    coordinates = np.linspace(0.1, 1.0, 30, dtype=np.float32)
    moved = coordinates.copy()
    moved[17] = np.nextafter(moved[17], np.float32(2))
    assert digest(coordinates) != digest(moved)
