"""Random search for presses that do not hold: hands in random postures against random products. --help tells the rest.

    target/venv/bin/python tests/bench/postures.py [--count 2000] [--first 0] [--out target/postures.jsonl]
    target/venv/bin/python tests/bench/postures.py --case SEED [--dump FILE.npz]

Goes on where it was cut: seeds that stand in the file are kept (--anew: all again). A child process presses; one that
dies or is silent costs its case, which is counted. Exit code 1 if a case is unsound or more than 3 % are refused.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
MOST_REFUSED = 0.03
SILENT_S = 120.0
ONE_THREAD = {name: "1" for name in ("RAYON_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}


def main():
    """Runs what was asked for. Returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=2000, help="how many seeds")
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--out", type=Path, default=TESTS.parent / "target/postures.jsonl", help="a row a case")
    parser.add_argument("--anew", action="store_true", help="press seeds that the file holds once more")
    parser.add_argument("--case", type=int, help="this seed alone, told in full")
    parser.add_argument("--dump", type=Path, help="with --case: the arrays of the press, as .npz")
    parser.add_argument("--child", action="store_true", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.case is not None:
        return one_case(asked.case, asked.dump)
    seeds = range(asked.first, asked.first + asked.count)
    if asked.child:
        return child(seeds, asked.out)
    if asked.anew:
        asked.out.unlink(missing_ok=True)
    asked.out.parent.mkdir(parents=True, exist_ok=True)
    search(seeds, asked.out)
    rows = [row for row in read(asked.out).values() if row["seed"] in seeds]
    return report(rows)


def one_case(seed, dump):
    """One seed, told in full; its arrays in `dump`, in the format of a skin pressed by the module alone."""
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


def child(seeds, out):
    """Presses the seeds that the file lacks, a row each; a line before each, so that who died is known."""
    from handles import random_postures

    known = read(out)
    with out.open("a") as file:
        for seed in (seed for seed in seeds if seed not in known):
            _write(file, {"begin": seed})
            _write(file, random_postures.press(random_postures.draw(seed)))
    return 0


def search(seeds, out):
    """Children until every seed has its row."""
    while missing := [seed for seed in seeds if seed not in read(out)]:
        command = [sys.executable, __file__, "--child", "--first", str(missing[0]), "--out", str(out)]
        process = subprocess.Popen(
            [*command, "--count", str(seeds.stop - missing[0])], stderr=subprocess.PIPE, text=True
        )
        reason = _watch(process, out)
        if reason and (begun := last_begun(out)) is not None:
            with out.open("a") as file:
                _write(file, {"seed": begun, "kind": "", "died": reason})
        elif reason:
            raise SystemExit(f"the search ended before its first case: {reason}")


def _watch(process, out):
    """Why the child ended, empty if it did all; ended here if its file did not grow for `SILENT_S`."""
    size, since = -1, time.monotonic()
    while process.poll() is None:
        time.sleep(0.5)
        now = out.stat().st_size if out.exists() else 0
        if now != size:
            size, since = now, time.monotonic()
        elif time.monotonic() - since > SILENT_S:
            process.kill()
            process.wait()
            return f"silent for {SILENT_S:.0f} s"
    return "" if process.returncode == 0 else f"exit {process.returncode}: {process.stderr.read()[-300:]}"


def read(out):
    """Seed -> row of a file."""
    lines = out.read_text().splitlines() if out.exists() else []
    return {row["seed"]: row for row in map(json.loads, filter(_is_whole, lines)) if "seed" in row}


def last_begun(out):
    """The seed that was begun and has no row."""
    known, begun = (
        read(out),
        [json.loads(line).get("begin") for line in out.read_text().splitlines() if _is_whole(line)],
    )
    open_ones = [seed for seed in begun if seed is not None and seed not in known]
    return open_ones[-1] if open_ones else None


def report(rows):
    """Rates by kind and the worst cases. Returns the exit code."""
    from handles import random_postures

    wrong = {row["seed"]: random_postures.faults(row) for row in rows}
    kinds = sorted({row["kind"] for row in rows})
    names = ("spike", "inside", "peak", "not converged", "through", "hung", "died")
    print(f"{'kind':<8}{'cases':>7}{'refused':>9}{'unsound':>9}" + "".join(f"{name:>15}" for name in names))
    for kind in [*kinds, None]:
        chosen = [row for row in rows if kind is None or row["kind"] == kind]
        count = Counter(name for row in chosen for name in wrong[row["seed"]])
        refused, unsound = sum(map(random_postures.is_refused, chosen)), sum(bool(wrong[row["seed"]]) for row in chosen)
        cells = "".join(f"{count[name]:>15}" for name in names)
        print(f"{kind or 'all':<8}{len(chosen):>7}{refused:>9}{unsound:>9}{cells}")
    for text, number in Counter(row["refused"][:110] for row in rows if "refused" in row).most_common(12):
        print(f"refused {number}: {text}")
    for key, label in (("moved_mm", "farthest moved"), ("left_mm", "deepest left"), ("under_mm", "deepest under skin")):
        worst = sorted((row for row in rows if key in row), key=lambda row: -row[key])[:6]
        print(label, ", ".join(f"{row[key]:.2f} mm (seed {row['seed']}, {row['kind']})" for row in worst))
    times = sorted(row["seconds"] for row in rows if "seconds" in row)
    draws = sum(row.get("draws", 0) for row in rows)
    print(
        f"{draws} draws for {len(rows)} postures; a press: median {times[len(times) // 2]:.3f}, most {times[-1]:.2f} s"
    )
    grades = Counter(row["grade"] for row in rows if row.get("grade"))
    print("grades:", dict(grades) or "none told")
    refused = sum(map(random_postures.is_refused, rows))
    unsound = sum(bool(faults) for faults in wrong.values())
    print(
        f"unsound {unsound}/{len(rows)} ({100 * unsound / len(rows):.1f} %), refused {100 * refused / len(rows):.1f} %"
    )
    return 1 if unsound or refused > MOST_REFUSED * len(rows) else 0


def _is_whole(line):
    return line.startswith("{") and line.endswith("}")


def _write(file, row):
    file.write(json.dumps(row) + "\n")
    file.flush()


if __name__ == "__main__":
    if any(os.environ.get(name) != value for name, value in ONE_THREAD.items()):
        os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, **ONE_THREAD})
    sys.path.insert(0, str(TESTS))
    sys.exit(main())
