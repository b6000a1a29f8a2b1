"""Draws the calibration anew and larger, into a folder that is not kept: what thresholds rest on besides its own cases.

`cargo xtask prove -- --split larger` does, and runs it: the calibration's counts TIMES over on its pads, with a seed
that no other split has. The same tables give the same bytes. Nothing is recorded after these studies.
"""

from pathlib import Path

from trial.drawing import make_cases

TIMES = 3


def drawn(times=TIMES):
    """(split, plan, presses) of every case."""
    plans = [plan for _ in range(times) for plan in make_cases.plans("larger")]
    return [("larger", *make_cases.drawn(plan, "larger", k)) for k, plan in enumerate(plans)]


def make(folder, times=TIMES):
    """Writes the three files into a folder, unless they are there."""
    folder = Path(folder)
    if not (folder / "larger_labels.json").exists():
        folder.mkdir(parents=True, exist_ok=True)
        make_cases.write(drawn(times), "larger_", (95, 3), folder)
