"""Lateral grips and hooks of handles and everyday things: which are held, what of the hand bears, what is left over.

    target/venv/bin/python tests/bench/hand/lateral_and_hook.py [--kinds LATERAL HOOK] [--things card "steering wheel"]
        [--sheet PICTURE.jpg]

A median hand takes each by *Grasp* with that kind and is solved. A lateral grip shall be borne by the thumb and
the index finger's middle and proximal phalanges, a hook by the four fingers alone. `--sheet` draws `SHOWN` from
four sides. With THENAR_RESULTS=1 writes the rows of tests/bench/RESULTS.md.
"""

import argparse
import os
import sys
import time
from pathlib import Path

import numpy as np

TESTS = Path(__file__).resolve().parents[2]
COMMAND = "target/venv/bin/python tests/bench/hand/lateral_and_hook.py"
BEARERS = {"LATERAL": ("thumb", "index_middle", "index_proximal"), "HOOK": ("index", "middle", "ring", "little")}
WANTED = {"LATERAL": 0.0, "HOOK": 100.0}
"""What the skin's forces shall leave over, N: nothing, or the weight that hangs."""

SHOWN = {"LATERAL": ("mug handle", "pencil", "phone"), "HOOK": ("dumbbell", "steering wheel", "tube")}
"""What `--sheet` draws."""

ALONE = 0.95
"""This share of the forces shall be on the digits that a kind takes."""

LEFT = 0.05
"""What is left over beyond `WANTED`, in parts of the sum of forces, at most."""


def main():
    """Measures, prints and records. Returns the exit code."""
    from handles import everyday, grasping, shapes

    things = {**shapes.SHAPES, **everyday.SHAPES}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kinds", nargs="+", default=list(BEARERS), choices=list(BEARERS))
    parser.add_argument("--things", nargs="+", default=list(things), choices=list(things))
    parser.add_argument("--sheet", type=Path)
    asked = parser.parse_args()
    grasping.register()
    drawn, figures = [], []
    for kind in asked.kinds:
        rows = {}
        for name in asked.things:
            rows[name], picture = held(kind, things[name]())
            drawn += picture if name in SHOWN[kind] else []
            print(f"{kind} {name}: {said(rows[name])}", flush=True)
        figures.append((kind, rows))
    if asked.sheet:
        from handles import sheets

        sheets.save(asked.sheet, drawn)
    return report(figures)


def held(kind, mesh):
    """One thing in one kind of grasp: its numbers, or why it is refused; and its row of a sheet in a list."""
    import bpy
    from handles import grasping, sheets

    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.thenar.make_hand(percentile=50)
    hand = bpy.context.scene.thenar.hand
    rest, triangles = grasping.seen(hand)
    palm = sheets.palm_of(hand)
    product = grasping._add(mesh, (10, 20, 30))
    bpy.context.scene.thenar.product = product
    cpu = time.process_time()
    try:
        bpy.ops.thenar.fit_grasp(kind=kind)
        cpu = time.process_time() - cpu
        bpy.ops.thenar.solve()
    except RuntimeError as error:
        return str(error).partition(";")[0].removeprefix("Error: ").strip(), []
    result = bpy.context.scene.thenar.result
    force = {row.name: row.force_n for row in result.regions}
    total = sum(force.values())
    own = sum(value for name, value in force.items() if name.startswith(BEARERS[kind]))
    net = float(np.linalg.norm(result.force_vector_n))
    numbers = {
        "total_n": total,
        "own": own / total,
        "left": abs(net - WANTED[kind]) / total,
        "peak_kpa": result.peak_kpa,
        "grade": result.grade,
        "cpu_s": cpu,
    }
    return numbers, [sheets.row(rest, grasping.seen(hand)[0], triangles, palm, grasping.seen(product))]


def said(row):
    """A row in words."""
    if isinstance(row, str):
        return f"refused: {row}"
    return (
        f"{row['total_n']:.0f} N, {100.0 * row['own']:.0f} % on its digits, {100.0 * row['left']:.1f} % left over, "
        f"peak {row['peak_kpa']:.0f} kPa, {row['grade']}, {row['cpu_s']:.1f} s"
    )


def report(figures):
    """Prints and records the sums. Returns the exit code: 1 where a grasp is not to be used."""
    import results

    out, unsound = [], 0
    for kind, rows in figures:
        solved = {name: row for name, row in rows.items() if not isinstance(row, str)}
        good = [name for name, row in solved.items() if row["own"] >= ALONE and row["left"] <= LEFT]
        unsound += sum(row["grade"] == "do not use" for row in solved.values())
        refused = ", ".join(name for name in rows if name not in solved) or "none"
        others = "; ".join(f"{name} {said(row)}" for name, row in solved.items() if name not in good) or "none"
        seconds = sorted(row["cpu_s"] for row in solved.values())
        middle = seconds[len(seconds) // 2] if seconds else 0.0
        measured = (
            f"{len(good)} of {len(rows)}; {middle:.1f} s of CPU in the middle; refused: {refused}; the others: {others}"
        )
        what = f"{kind.lower()} grips of twelve handles and eleven things of every day, percentile 50"
        wanted = f"borne by {', '.join(BEARERS[kind])} to {100 * ALONE:.0f} %, at most {100 * LEFT:.0f} % left over"
        print(f"\n{what}: {measured}")
        out.append(results.Figure(what, wanted, measured, len(good) == len(rows)))
    results.record("bench", COMMAND, out)
    return int(unsound > 0)


if __name__ == "__main__":
    sys.path[0] = str(TESTS)
    code = main()
    sys.stdout.flush()
    os._exit(code)
