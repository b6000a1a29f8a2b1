"""What the bits of a result depend on besides the input: Blender, instructions, the C library's functions."""

import hashlib
import math
import platform
import struct
from pathlib import Path

import bpy

# Those that the Rust library chooses by (rust/contact/tests/frozen/machine.rs).
CHOSEN_BY = ("avx2", "fma", "avx512f", "avx512vl")


def kind():
    """In words."""
    instructions = " ".join(name for name in CHOSEN_BY if name in _flags())
    return f"Blender {bpy.app.version_string}, {platform.machine()} {instructions}, functions {_functions()}"


def _flags():
    listing = Path("/proc/cpuinfo")
    lines = listing.read_text().splitlines() if listing.exists() else []
    return next((line.split() for line in lines if line.startswith("flags")), [])


def _functions():
    digest = hashlib.sha256()
    for k in range(1, 20_000):
        x = 7.3e-4 * k
        answers = (
            *(f(x) for f in (math.exp, math.expm1, math.log, math.log10, math.cbrt, math.sin, math.cos, math.tanh)),
            math.exp(-x),
            math.pow(x, 1.37),
            math.pow(x, -0.62),
            math.atan2(x, 1.9),
            math.asin(x / 15),
        )
        digest.update(struct.pack(f"<{len(answers)}d", *answers))
    return digest.hexdigest()[:16]
