"""Makes the two sample studies that the add-on ships, from closed forms alone.

    PYTHONPATH=tests target/venv/bin/python tests/trial/worlds/sample_studies.py [FOLDER]

`addon/sample_studies` by default. `nothing_missing`: balls in a half-space as Sneddon has it. `concealed_effect`: the
same with a modulus that fades (relaxation in two terms, Lee and Radok 1960). Nothing of Thenar computes them.
"""

import sys
from pathlib import Path

from trial.worlds import closed_forms

SAMPLES = {"nothing_missing": (22, "nothing", "in_proportion"), "concealed_effect": (56, "relaxation", "in_proportion")}
"""Folder: seed, truth and noise. Seeds of few files with holds, two tools, and two speeds."""
TITLES = {"nothing_missing": "Sample: balls on gel A", "concealed_effect": "Sample: balls on gel B"}
FOLDER = Path(__file__).parents[3] / "addon" / "sample_studies"


def make(folder=FOLDER):
    """Write both studies below `folder`; the same files each time."""
    for name, drawn in SAMPLES.items():
        closed_forms.draw(*drawn).write(Path(folder) / name)
        toml = Path(folder) / name / "study.toml"
        toml.write_text(toml.read_text().replace("Spheres on a half-space", TITLES[name]))


if __name__ == "__main__":
    make(*(Path(folder) for folder in sys.argv[1:]))
