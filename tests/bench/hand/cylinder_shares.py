"""Shares of the grip force by finger, phalanx and palm on cylinders of 30 to 100 mm, next to published ones.

    target/venv/bin/python tests/bench/hand/cylinder_shares.py [--diameters 30 40 48 50 60 70 80 90 100]

A median hand grasps each cylinder firmly by the add-on's buttons and is solved. Prints a row a cylinder; with
THENAR_RESULTS=1 writes those of tests/bench/RESULTS.md. Nothing is fitted to what was published.
"""

import argparse
import os
import re
import sys
import time
from pathlib import Path

import numpy as np

TESTS = Path(__file__).resolve().parents[2]
COMMAND = "target/venv/bin/python tests/bench/hand/cylinder_shares.py"
DIAMETERS_MM = (30, 40, 48, 50, 60, 70, 80, 90, 100)
LENGTH_MM = 200.0
FINGERS = ("thumb", "index", "middle", "ring", "little")
PHALANGES = ("distal", "middle", "proximal")
PUBLISHED = (
    "distal phalanges carry more and proximal ones less as the cylinder grows; shares change by 1 to 7 points, the "
    "thumb's most (152 volunteers, three sizes, J. Hand Therapy 30 (2017) 529)"
)
MOST_POINTS = 7.0
"""No published share changes by more over the sizes, points of 100."""

BALANCED = 0.02
"""Net force over the sum of forces that is wanted of a settled grasp."""


def main():
    """Measures, prints and records. Returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--diameters", nargs="+", type=int, default=list(DIAMETERS_MM))
    asked = parser.parse_args()

    from handles import grasping

    grasping.register()
    rows = {}
    for diameter in asked.diameters:
        rows[diameter] = measured(diameter)
        print(sentence(diameter, rows[diameter]), flush=True)
    return report(rows)


def measured(diameter):
    """One cylinder: sum of forces, what is left over, the friction that holds it; shares by finger, phalanx of the
    fingers and palm, as parts."""
    import bpy
    from handles import grasping

    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.thenar.make_hand(percentile=50)
    bpy.context.scene.thenar.product = grasping._add(cylinder(diameter), (0, 0, 0))
    cpu = time.process_time()
    bpy.ops.thenar.fit_grasp(kind="POWER")
    cpu = time.process_time() - cpu
    bpy.ops.thenar.solve()
    result = bpy.context.scene.thenar.result
    force = {row.name.replace(" ", "_"): row.force_n for row in result.regions}
    total = sum(force.values())
    parts = {
        finger: sum(value for name, value in force.items() if name.startswith(finger)) / total for finger in FINGERS
    }
    of_fingers = {name: value for name, value in force.items() if name.startswith(FINGERS[1:])}
    for phalanx in PHALANGES:
        parts[f"{phalanx} phalanges"] = (
            sum(value for name, value in of_fingers.items() if f"_{phalanx}" in name) / total
        )
    parts["palm"] = sum(value for name, value in force.items() if re.search("palm|thenar", name)) / total
    left = float(np.linalg.norm(result.force_vector_n)) / total
    friction = bpy.context.scene.thenar_grasps.found[0].friction
    return {
        "total_n": total,
        "left": left,
        "parts": parts,
        "cpu_s": cpu,
        "held": result.held_share,
        "friction": friction,
    }


def cylinder(diameter):
    """A closed cylinder along z: vertices (n, 3), mm, and triangles (m, 3)."""
    from handles.random_products import revolved

    along = np.linspace(-0.5 * LENGTH_MM, 0.5 * LENGTH_MM, 101)
    across = np.full(101, 0.5 * diameter)
    return revolved(np.r_[0.0, across, 0.0], np.r_[along[0], along, along[-1]], 96)


def sentence(diameter, row):
    """A cylinder's row as text."""
    parts = ", ".join(f"{name} {100 * share:.0f}" for name, share in row["parts"].items())
    return (
        f"{diameter} mm: {row['total_n']:.0f} N, {100 * row['left']:.1f} % left over without friction, which a "
        f"coefficient of {row['friction']:.2f} holds; smallest wrench "
        f"{100 * row['held']:.0f} %; shares, %: {parts}; {row['cpu_s']:.1f} s of CPU"
    )


def report(rows):
    """Trends over the diameters against the published ones. Returns the exit code."""
    import results

    sizes = np.array(list(rows), float)
    parts = {
        name: np.array([row["parts"][name] for row in rows.values()]) for name in next(iter(rows.values()))["parts"]
    }
    slopes = {name: float(np.polyfit(sizes, 100.0 * each, 1)[0]) * 10.0 for name, each in parts.items()}
    ranges = {finger: 100.0 * float(np.ptp(parts[finger])) for finger in FINGERS}
    most = max(ranges, key=ranges.get)
    rises, falls = slopes["distal phalanges"] > 0.0, slopes["proximal phalanges"] < 0.0
    by_size = ", ".join(
        f"{name} {slopes[name]:+.1f}" for name in (*(f"{each} phalanges" for each in PHALANGES), "palm")
    )
    trends = (
        f"by 10 mm of diameter: {by_size} points of 100; the share that changes most is the {most}'s ("
        + ", ".join(f"{name} {value:.0f}" for name, value in ranges.items())
        + " points)"
    )
    print(trends)
    each = [sentence(diameter, row) for diameter, row in rows.items()]
    left = max(row["left"] for row in rows.values())
    figures = [
        results.Figure(
            "cylinders of 30 to 100 mm, firm power grip, percentile 50: shares by finger, phalanx of the four fingers "
            "and palm",
            PUBLISHED,
            "; ".join(each) + ". " + trends,
            rises and falls and most == "thumb" and ranges[most] <= MOST_POINTS,
        ),
        results.Figure(
            "cylinders of 30 to 100 mm, the same grips: net force over the sum of forces",
            f"{100 * BALANCED:.0f} % at most",
            ", ".join(
                f"{diameter} mm {100 * row['left']:.1f} % (a friction of {row['friction']:.2f} holds it)"
                for diameter, row in rows.items()
            ),
            left <= BALANCED,
        ),
    ]
    results.record("bench", COMMAND, figures)
    return int(not all(figure.is_met for figure in figures))


if __name__ == "__main__":
    sys.path[0] = str(TESTS)
    from bench.searching import ONE_THREAD

    if any(os.environ.get(name) != value for name, value in ONE_THREAD.items()):
        os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, **ONE_THREAD})
    code = main()
    sys.stdout.flush()
    os._exit(code)
