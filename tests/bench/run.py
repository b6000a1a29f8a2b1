"""Runs every benchmark, one thread, CPU time; prints the table, writes target/bench.json and, if asked, RESULTS.md."""

import json
import os
import platform
import sys
from pathlib import Path

ONE_THREAD = {name: "1" for name in ("RAYON_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}


def main():
    """Measures, prints, writes. Returns the exit code: 0 unless a benchmark gave a wrong answer."""
    import results
    from bench import friction_rows, grasp, protocol_rows, rows

    table, is_right = [], True
    hand = grasp.grasping()
    measures = {
        "dense problem": rows.dense_rows,
        "distances": lambda: rows.distance_rows(hand),
        "press": lambda: rows.press_rows(hand),
        "friction": friction_rows.friction_rows,
        "protocols": lambda: protocol_rows.protocol_rows(hand),
    }
    for name, measure in measures.items():
        try:
            table += measure()
        except (AssertionError, ArithmeticError, AttributeError) as error:
            is_right = False
            table.append(rows.left_out(name, "", f"FAILED: {error}"))
    print(f"\n{'what':<62} {'reference':<34} {'ours ms':>9} {'ref. ms':>9} {'ratio':>7}  wanted")
    for row in table:
        state = "" if row.is_met is None else ("met" if row.is_met else "NOT MET")
        numbers = f"{row.ours_ms:9.3f} {row.reference_ms:9.3f} {row.ratio:7.2f}"
        print(f"{row.what:<62} {row.reference:<34} {numbers}  {row.wanted} {state}")
        if row.note:
            print(f"    {row.note}")
    rows.TARGET.mkdir(exist_ok=True)
    report = {
        "machine": platform.processor() or platform.machine(),
        "threads": 1,
        "unit": "ms of CPU time, median",
        "rows": [row.as_dict() for row in table],
    }
    (rows.TARGET / "bench.json").write_text(json.dumps(report, indent=2) + "\n")
    figures = [row.as_figure() for row in table if row.is_met is not None]
    results.record("bench", "cargo xtask bench", figures)
    return 0 if is_right else 1


if __name__ == "__main__":
    if any(os.environ.get(name) != value for name, value in ONE_THREAD.items()):
        os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, **ONE_THREAD})
    sys.path.insert(0, str(Path(__file__).parents[1]))
    sys.exit(main())
