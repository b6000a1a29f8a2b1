"""Xie Table 6 and the force frames of Fig. 21 as a virtual mat reads them.

    target/venv/bin/python tests/proof/by_mat/table_6.py

Solves the three cylinders of `blend-samples`, reads each by a virtual F-Scan mat over thresholds of 0 to 5 kPa and 24
placements, solves the 48 mm grasp at three forces, and prints the rows of tests/proof/RESULTS.md and of README.md.
With THENAR_RESULTS=1 it writes the former itself. Nothing is fitted to the table but the total force.
"""

import sys
from pathlib import Path

import bpy
import thenar_blender
from thenar_blender import workflow
from thenar_blender.recordings import table_6
from thenar_blender.terminal import headless

ROOT = Path(__file__).parents[3]
COMMAND = "target/venv/bin/python tests/proof/by_mat/table_6.py"
sys.path.insert(0, str(ROOT / "tests"))

import results  # noqa: E402

JUDGED = ("area_mm2", "mean_kpa", "peak_kpa")
"""What Table 6 can judge: the force is the target of the fit."""


def main():
    """Measures, prints and records."""
    thenar_blender.register()
    figures, solved = [], {}
    for diameter in table_6.PAPER:
        path = ROOT / "blend-samples" / f"cylinder_{diameter}.blend"
        headless.open_file(path)
        workflow.solve(bpy.context)
        solved[diameter] = table_6.read_scene(bpy.context)
        print("\n".join(table_6.lines(solved[diameter])), end="\n\n")
        figures.append(figure(diameter, solved[diameter]))
    frames = table_6.read_frames(bpy.context, ROOT / "blend-samples" / "cylinder_48.blend")
    print("\n".join(table_6.frame_lines(frames)), end="\n\n")
    figures += [frame_figure(name, reading) for name, reading in frames.items()]
    print(results.HEAD, "| --- | --- | --- | --- | --- |", sep="\n")
    for each in figures:
        print("| " + " | ".join(each.cells(COMMAND)) + " |")
    print("\nREADME.md:\n" + readme_row(solved))
    results.record("proof", COMMAND, figures)


def figure(diameter, reading):
    """The row of one cylinder: what the mat reads over all thresholds and placements; wanted is what was measured."""
    paper = table_6.measured(diameter)
    wanted = {name: values[:1] for name, values in paper.items()}
    is_met = all(reading["range"][name][0] <= paper[name][0] <= reading["range"][name][1] for name in JUDGED)
    return results.Figure(f"{diameter} mm cylinder, as a mat reads it", said(wanted), with_skin(reading), is_met)


def frame_figure(name, reading):
    """The row of one force frame; the paper prints no reading of it that could be wanted."""
    what = f"force frame of Fig. 21 on the 48 mm cylinder: {name}, {reading['wanted_n']:.0f} N"
    return results.Figure(what, "stated", with_skin(reading))


def with_skin(reading):
    """A reading in words, the skin's own figures last."""
    skin = {name: (value,) for name, value in reading["skin"].items()}
    return f"{said(reading['range'])}; the skin itself: {said(skin)}"


def said(bounds):
    """Quantities in words: "area, cm2: 75 to 96; ..."."""
    return "; ".join(f"{label}: {table_6.text(name, bounds[name])}" for name, (label, _, _) in table_6.LABELS.items())


def readme_row(solved):
    """The row of README.md: each quantity on the three cylinders, with the measured one in brackets."""
    cells = []
    for name in JUDGED:
        each = [
            f"{table_6.text(name, reading['range'][name])} ({table_6.text(name, table_6.measured(diameter)[name][:1])})"
            for diameter, reading in solved.items()
        ]
        cells.append(f"{table_6.LABELS[name][0]}: {', '.join(each)}")
    return (
        "| handles of 48, 60, 100 mm at the force of measured hands, read by a virtual pressure mat over thresholds "
        f"of 0 to 5 kPa (Xie Table 6) | **{'; '.join(cells)}** | `{COMMAND}` |"
    )


if __name__ == "__main__":
    main()
