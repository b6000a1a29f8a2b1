"""Reads an export of 309 frames of 28 x 28 cells: `target/venv/bin/python tests/bench/study/read_export.py`.

The ratio is to numpy's reading of the same numbers as one table; of several runs the cheapest counts.
"""

import io
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np  # noqa: E402
import thenar  # noqa: E402
import timing  # noqa: E402

EXPORT = Path(__file__).resolve().parents[4] / "shared/recordings/finger_pressure_iscan/iscan_test.csv"
RUNS = 7


if __name__ == "__main__":
    read = min(timing.once_ms(lambda: thenar.read_recording(EXPORT))[0] for _ in range(RUNS))
    text = io.StringIO()
    np.savetxt(text, thenar.read_recording(EXPORT).maps[0].counts, "%g", delimiter=",")
    loads = (timing.once_ms(lambda: np.loadtxt(io.StringIO(text.getvalue()), delimiter=",")) for _ in range(RUNS))
    table = min(spent for spent, _ in loads)
    print(f"{read:.0f} ms, numpy {table:.0f} ms: {read / table:.2f}")
