"""Makes the grasp study that the add-on ships: a hand on a cylinder, by the reference solve, with one concealed effect.

    PYTHONPATH=tests target/venv/bin/python tests/trial/grasps/sample.py [FOLDER]

`addon/sample_studies/held_handle` by default; the same files each time.
"""

import sys
from pathlib import Path

from trial.grasps import drawn

FOLDER = Path(__file__).parents[3] / "addon" / "sample_studies" / "held_handle"
CASE = ("relaxation", 13)


def make(folder=FOLDER):
    """Write the study; returns its truth."""
    case = drawn.Case(*CASE, rate_hz=0.5)
    drawn.write(case, folder, reach_mm=5.0, sectors=128)
    toml = Path(folder) / "study.toml"
    toml.write_text(toml.read_text().replace("A hand on a cylinder", "Sample: a hand on a handle"))
    return case.truth


if __name__ == "__main__":
    print(make(*(Path(folder) for folder in sys.argv[1:])))
