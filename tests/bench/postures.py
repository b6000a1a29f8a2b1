"""Random search for presses that do not hold: hands in random postures against random products. --help tells the rest.

    target/venv/bin/python tests/bench/postures.py [--count 2000] [--first 0] [--out target/postures.jsonl]
    target/venv/bin/python tests/bench/postures.py --remedy [--count 2000] [--out target/postures.jsonl]
    target/venv/bin/python tests/bench/postures.py --case SEED [--dump FILE.npz]

Goes on where it was cut: seeds that have a row in the file are kept (--again: none is). Exit code 1 if a case is
unsound or more than 3 % are refused.
"""

import argparse
import json
import os
import re
import sys
from collections import Counter
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
MOST_REFUSED = 0.03
FAULTS = ("spike", "inside", "peak", "not converged", "through", "hung", "died")


def main():
    """Runs what was asked for. Returns the exit code."""
    from bench import searching
    from handles import random_postures

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=2000, help="how many seeds")
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--out", type=Path, default=TESTS.parent / "target/postures.jsonl", help="a row a case")
    parser.add_argument("--again", action="store_true", help="press seeds that the file holds once more")
    parser.add_argument(
        "--remedy", action="store_true", help="press what the file's rows refuse on a hand cut twice as fine"
    )
    parser.add_argument("--case", type=int, help="this seed alone, printed in full")
    parser.add_argument("--dump", type=Path, help="with --case: the arrays of the press, as .npz")
    parser.add_argument("--child", action="store_true", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.case is not None:
        return one_case(asked.case, asked.dump)
    if asked.child:
        searching.run(json.load(sys.stdin), asked.out, lambda seed: random_postures.press(random_postures.draw(seed)))
        return 0
    if asked.again:
        asked.out.unlink(missing_ok=True)
    seeds = range(asked.first, asked.first + asked.count)
    rows = searching.search(__file__, seeds, asked.out, asked.workers)
    if asked.remedy:
        return report_remedy([row for seed, row in sorted(rows.items()) if seed in seeds])
    return report([row for seed, row in rows.items() if seed in seeds])


def one_case(seed, dump):
    """One seed, printed in full; its arrays in `dump`, for a press by the module alone."""
    from handles import random_postures

    posture = random_postures.draw(seed)
    if dump:
        save(posture, dump)
    row = random_postures.press(posture)
    print(json.dumps(row, indent=2))
    print("faults:", ", ".join(random_postures.faults(row)) or "none")
    return 1 if random_postures.faults(row) else 0


def save(posture, path):
    """The press as arrays: the hand at rest, its materials, `posed`, `product_vertices`, `product_triangles`."""
    import numpy as np
    from handles import random_postures

    np.savez_compressed(
        path,
        **random_postures.hand_of(posture.percentile).arrays(),
        posed=posture.posed,
        product_vertices=posture.vertices,
        product_triangles=posture.product.triangles,
    )


def report(rows):
    """Rates by kind, reasons of refusals and the worst cases. Returns the exit code."""
    import results
    from handles import random_postures, random_products

    wrong = {row["case"]: random_postures.faults(row) for row in rows}
    print(f"{'kind':<8}{'cases':>7}{'refused':>9}{'unsound':>9}" + "".join(f"{name:>15}" for name in FAULTS))
    for kind in [*random_products.KINDS, None]:
        chosen = [row for row in rows if kind in (None, random_products.kind_of(row["case"]))]
        count = Counter(name for row in chosen for name in wrong[row["case"]])
        refused, unsound = sum(map(random_postures.is_refused, chosen)), sum(bool(wrong[row["case"]]) for row in chosen)
        cells = "".join(f"{count[name]:>15}" for name in FAULTS)
        print(f"{kind or 'all':<8}{len(chosen):>7}{refused:>9}{unsound:>9}{cells}")
    for text, number in Counter(_reason(row) for row in rows if random_postures.is_refused(row)).most_common(12):
        print(f"refused {number}: {text}")
    for key, label in (("moved_mm", "farthest moved"), ("left_mm", "deepest left"), ("under_mm", "deepest under skin")):
        worst = sorted((row for row in rows if key in row), key=lambda row: -row[key])[:6]
        print(label, ", ".join(f"{row[key]:.2f} mm (seed {row['case']}, {row['kind']})" for row in worst))
    times = sorted(row["seconds"] for row in rows if "seconds" in row)
    draws = sum(row.get("draws", 0) for row in rows)
    print(
        f"{draws} draws for {len(rows)} postures; a press: median {times[len(times) // 2]:.3f}, most {times[-1]:.2f} s"
    )
    grades = Counter(row["grade"] for row in rows if row.get("grade"))
    print("grades:", dict(grades) or "none reported")
    good = [row for row in rows if random_postures.grade_of(row) == "good"]
    most = [max((row[key] for row in good), default=0.0) for key in ("complementarity", "left_mm")]
    print(f"of {len(good)} graded good: complementarity at most {most[0]:.0e}, skin inside at most {most[1]:.1e} mm")
    refused = sum(map(random_postures.is_refused, rows))
    unsound = sum(bool(faults) for faults in wrong.values())
    print(
        f"unsound {unsound}/{len(rows)} ({100 * unsound / len(rows):.1f} %), refused {100 * refused / len(rows):.1f} %"
    )
    is_met = not unsound and refused <= MOST_REFUSED * len(rows)
    figure = results.Figure(
        "random postures against balls, boxes, rods, plates, sheets, forks, wires, tubes",
        f"none unsound, at most {100 * MOST_REFUSED:g} % refused",
        f"{len(rows)} postures: unsound {unsound}, refused {refused}, a press at most {times[-1]:.2f} s",
        is_met,
    )
    results.record("bench", "target/venv/bin/python tests/bench/postures.py", [figure])
    return int(not is_met)


def report_remedy(rows):
    """Presses what was refused as the message says: on a finer hand. Returns 1 if a result is unsound then."""
    from handles import random_postures

    refused = [row for row in rows if random_postures.is_refused(row)]
    cases = [row["case"] for row in refused]
    after = [{"case": c} | random_postures.press(random_postures.draw(c), is_refined=True) for c in cases]
    solved = [row for row in after if not random_postures.is_refused(row)]
    unsound = [row for row in after if random_postures.faults(row)]
    print(f"{len(refused)} refused; on the hand cut twice as fine {len(solved)} are solved, {len(unsound)} unsound")
    for row in unsound:
        print(f"unsound: seed {row['case']}, {', '.join(random_postures.faults(row))}")
    for text, number in Counter(_reason(row) for row in after if random_postures.is_refused(row)).most_common(6):
        print(f"refused {number}: {text}")
    share = (len(refused) - len(solved)) / max(len(rows), 1)
    print(f"left refused: {100 * share:.1f} % of {len(rows)}")
    return int(bool(unsound))


def _reason(row):
    """Why a row is refused, its numbers taken out."""
    return re.sub(r"[0-9]+([.][0-9]+)?", "#", row.get("refused") or row.get("reason", ""))[:150]


if __name__ == "__main__":
    sys.path[0] = str(TESTS)
    from bench.searching import ONE_THREAD

    if any(os.environ.get(name) != value for name, value in ONE_THREAD.items()):
        os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, **ONE_THREAD})
    sys.exit(main())
