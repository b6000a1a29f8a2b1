"""Reads an export of 309 frames of 28 x 28 cells: `target/venv/bin/python tests/bench/study/read_export.py`.

The ratio is to numpy's reading of the same numbers as one table; of several runs the cheapest counts.
"""

import io
import time
from pathlib import Path

import numpy as np
import thenar

EXPORT = Path(__file__).resolve().parents[4] / "shared/recordings/finger_pressure_iscan/iscan_test.csv"
RUNS = 7


def cheapest(action):
    """Processor time (s) of the cheapest of several calls."""
    times = []
    for _ in range(RUNS):
        began = time.process_time()
        action()
        times.append(time.process_time() - began)
    return min(times)


if __name__ == "__main__":
    read = cheapest(lambda: thenar.read_recording(EXPORT))
    text = io.StringIO()
    np.savetxt(text, thenar.read_recording(EXPORT).maps[0].counts, "%g", delimiter=",")
    table = cheapest(lambda: np.loadtxt(io.StringIO(text.getvalue()), delimiter=","))
    print(f"{1e3 * read:.0f} ms, numpy {1e3 * table:.0f} ms: {read / table:.2f}")
