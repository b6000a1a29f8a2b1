"""Twelve handles, hands of five sizes and six starts through Make Hand, Grasp, Solve; what is shown is measured apart.

    BLENDER_USER_RESOURCES=target/test-blender/venv target/venv/bin/python tests/bench/handles.py
        [--handles tube "door knob"] [--percentiles 1 50] [--starts made turned] [--workers N] [--out FILE.jsonl]

Goes on where it was cut: cases that have a row in the file are kept (--again: none is). Exit code 1 if a result is
unsound or more than 5 % are refused.
"""

import argparse
import json
import os
import sys
from collections import Counter
from itertools import product
from pathlib import Path

import numpy as np

TESTS = Path(__file__).resolve().parents[1]
MOST_REFUSED = 0.05
PERCENTILES = (1, 5, 50, 95, 99)
STARTS = ("made", "turned", "over", "tilted", "leaned", "lying")
MOST_BACK_DEG, MOST_OFF_DEG, PINCH_N = 10.0, 25.0, 45.0
FAULTS = ("spike", "patch", "inside", "peak", "died")


def main():
    """Runs what was asked for. Returns the exit code."""
    from bench import searching
    from handles import everyday, shapes

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--handles", nargs="+", default=list(shapes.SHAPES), choices=[*shapes.SHAPES, *everyday.SHAPES])
    parser.add_argument("--percentiles", nargs="+", type=int, default=list(PERCENTILES))
    parser.add_argument("--starts", nargs="+", default=list(STARTS), choices=STARTS)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--out", type=Path, default=TESTS.parent / "target/handles.jsonl", help="a row a case")
    parser.add_argument("--again", action="store_true", help="grasp cases that the file holds once more")
    parser.add_argument("--dump", type=Path, help="a folder for the arrays of every press, for the module alone")
    parser.add_argument("--child", action="store_true", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.child:
        return child(asked.out, os.environ.get("THENAR_DUMP", ""))
    if asked.dump:
        asked.dump.mkdir(parents=True, exist_ok=True)
        os.environ["THENAR_DUMP"] = str(asked.dump)
    if asked.again:
        asked.out.unlink(missing_ok=True)
    cases = [case_name(*case) for case in product(asked.percentiles, asked.starts, asked.handles)]
    rows = searching.search(__file__, cases, asked.out, asked.workers)
    return report({case: rows[case] for case in cases})


def case_name(percentile, start, handle):
    """A case as one text: "50, made, tube"."""
    return f"{percentile}, {start}, {handle}"


def child(out, dump):
    """Runs cases in one Blender process; it ends at once, since bpy may hang at exit with the add-on registered."""
    from bench import searching
    from handles import everyday, grasping, shapes

    known = shapes.SHAPES | everyday.SHAPES

    def one(case):
        percentile, start, handle = case.split(", ")
        path = Path(dump) / f"{handle}_{percentile}_{start}.npz".replace(" ", "_") if dump else None
        row = grasping.grasp(known[handle](), float(percentile), start, path)
        return {"handle": handle, "percentile": int(percentile), "start": start} | row

    grasping.register()
    searching.run(json.load(sys.stdin), out, one)
    sys.stdout.flush()
    os._exit(0)


def report(rows):
    """A row a case, then rates by handle, size and start. Returns the exit code."""
    import results
    from handles import grasping

    wrong = {case: grasping.faults(row) for case, row in rows.items()}
    for case, row in rows.items():
        print(f"{case:<28} {_sentence(row)} {', '.join(wrong[case]).upper()}")
    print(f"\n{'':<18}{'cases':>7}{'refused':>9}{'unsound':>9}" + "".join(f"{name:>9}" for name in FAULTS))
    names = {part: None for k in (2, 0, 1) for part in (case.split(", ")[k] for case in rows)}
    for name in [*names, "all"]:
        chosen = [case for case in rows if name == "all" or name in case.split(", ")]
        count = Counter(fault for case in chosen for fault in wrong[case])
        refused = sum(grasping.is_refused(rows[case]) for case in chosen)
        unsound = sum(bool(wrong[case]) for case in chosen)
        print(f"{name:<18}{len(chosen):>7}{refused:>9}{unsound:>9}" + "".join(f"{count[name]:>9}" for name in FAULTS))
    print("over the starts of a handle and a size, at most: " + _spread(rows))
    print(_cost(rows))
    print(_anatomy(rows))
    texts = Counter(f"{row['refused']}: {row['text'][:140]}" for row in rows.values() if "refused" in row)
    for text, number in texts.most_common(12):
        print(f"refused {number} at {text}")
    print("grades:", dict(Counter(row["grade"] for row in rows.values() if row.get("grade"))) or "none reported")
    refused, unsound = sum(map(grasping.is_refused, rows.values())), sum(bool(faults) for faults in wrong.values())
    print(f"unsound {unsound}/{len(rows)}, refused {refused}/{len(rows)}")
    is_met = not unsound and refused <= MOST_REFUSED * len(rows)
    grades = Counter(row.get("grade") or "no result" for row in rows.values())
    told = ", ".join(f"{number} {grade}" for grade, number in sorted(grades.items()))
    figure = results.Figure(
        "twelve handles grasped by the add-on's buttons, measured by code of its own",
        f"none unsound, at most {100 * MOST_REFUSED:g} % refused",
        f"{len(rows)} cases: {told}; unsound {unsound}, refused {refused}",
        is_met,
    )
    results.record("bench", "target/venv/bin/python tests/bench/handles.py", [figure])
    return int(not is_met)


def _spread(rows):
    """How far force and area of one handle and size lie apart over the starts, and what a grasp took."""
    groups = {}
    for case, row in rows.items():
        if "force_n" in row:
            percentile, _, handle = case.split(", ")
            groups.setdefault((percentile, handle), []).append((row["force_n"], row["area_mm2"]))
    apart = [max(np.ptp(each) / max(*each, 1e-9) for each in np.array(of_one).T) for of_one in groups.values()]
    seconds = sorted(row["fit_s"] for row in rows.values() if "force_n" in row)
    middle = seconds[len(seconds) // 2] if seconds else 0.0
    return f"{100 * max(apart, default=0.0):.2f} % of force and area; a grasp took {middle:.1f} s in the middle"


def _cost(rows):
    """Seconds of CPU that *Grasp* took, by handle: the middle one."""
    taken = {}
    for case, row in rows.items():
        if "fit_cpu_s" in row:
            taken.setdefault(case.split(", ")[2], []).append(row["fit_cpu_s"])
    middles = sorted((sorted(each)[len(each) // 2], handle) for handle, each in taken.items())
    return "CPU of a grasp: " + (", ".join(f"{handle} {seconds:.1f}" for seconds, handle in middles) or "none") + " s"


def _anatomy(rows):
    """Joints bent back, the thumb's pad, and skin in skin, over all grasps."""
    held = [row for row in rows.values() if "net_n" in row and "dip_back_deg" in row]
    if not held:
        return "no grasp was held"
    back = sum(row["dip_back_deg"] > MOST_BACK_DEG for row in held)
    power = [row for row in held if row["force_n"] > PINCH_N]
    off = sorted(row["thumb_off_deg"] for row in power) or [0.0]
    facing = sum(angle <= MOST_OFF_DEG for angle in off)
    folded = sum(row["in_skin"] > 0 for row in held)
    left = max(row["net_n"] / row["force_n"] for row in held)
    return (
        f"last joint bent back beyond {MOST_BACK_DEG:g} degrees in {back} of {len(held)}; thumb's pad within "
        f"{MOST_OFF_DEG:g} degrees of facing the index finger's in {facing} of {len(power)} power grips, "
        f"{off[len(off) // 2]:.0f} in the middle; skin more than 1 mm deep in skin in {folded}, at most "
        f"{max(row['in_skin'] for row in held)} vertices; at most {100 * left:.1f} % of the forces left over"
    )


def _sentence(row):
    if "died" in row:
        return f"died: {row['died']}"
    if "refused" in row:
        return f"refused at {row['refused']}: {row['text'][:110]}"
    return (
        f"{row['force_n']:7.1f} N {row['area_mm2'] / 100:6.1f} cm2, peak {row['peak_kpa']:7.0f}, patch "
        f"{row['patch_peak_kpa']:6.0f} kPa; moved {row['moved_mm']:6.2f} of {row['deepest_mm']:5.2f} mm, in a patch "
        f"beyond {row['beyond_mm']:6.2f}, left {row['left_mm']:.3f} mm {row['grade']}"
    )


if __name__ == "__main__":
    sys.path[0] = str(TESTS)
    from bench.searching import ONE_THREAD

    if any(os.environ.get(name) != value for name, value in ONE_THREAD.items()):
        os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, **ONE_THREAD})
    sys.exit(main())
