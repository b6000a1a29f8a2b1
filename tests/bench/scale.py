"""A million vertices: one curved pad at 10^4, 10^5 and 10^6 pressed cold, beside aspher on a million points.

`python tests/bench/scale.py [VERTICES ...]`, where Thenar can be imported: one thread, CPU time, every case in a
process of its own. Writes target/scale.json.
"""

import json
import os
import resource
import subprocess
import sys
import time
from pathlib import Path

ONE_THREAD = {name: "1" for name in ("RAYON_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
TARGET = Path(__file__).parents[2] / "target"
SIZES = (10_000, 100_000, 1_000_000)
DEPTH_MM = 2.5
MOST_GROWTH = 13.0
MOST_GIB = 24.0
MOST_MISS = 1e-4
PEER_POINTS = 1024
"""Points along a side of aspher's square: 1024^2 is a million."""
PEER_RATIO = 2.0


def main(sizes):
    """Measures every size, and the peer; prints the table. Returns 1 if an answer is wrong."""
    cases = [apart("case", str(size)) for size in sizes]
    print("CPU, s:   vertices contacts prepare   press  in all  grows    GiB  far field")
    is_right, before = True, None
    for case in cases:
        grows = "" if before is None else f"{growth(before, case):6.1f}"
        numbers = (
            f"{case['prepare_s']:7.2f} {case['press_s']:7.2f} {total(case):7.2f} {grows:>6} {case['peak_gib']:6.2f}"
        )
        print(f"{case['vertices']:18d} {case['contacts']:8d} {numbers} {case['far_field']:10.1e}")
        print(f"{'':9} wall, s: " + ", ".join(f"{stage} {spent:.2f}" for stage, spent in case["wall_s"].items()))
        is_right &= case["has_converged"] and case["far_field"] <= MOST_MISS
        before = case
    grown = [growth(a, b) for a, b in zip(cases, cases[1:], strict=False)]
    judge(
        f"growth per decade {', '.join(f'{g:.1f}' for g in grown)}",
        f"<= {MOST_GROWTH:g}",
        all(g <= MOST_GROWTH for g in grown),
    )
    judge(f"peak memory {cases[-1]['peak_gib']:.2f} GiB", f"<= {MOST_GIB:g}", cases[-1]["peak_gib"] <= MOST_GIB)
    figures = [
        (
            "CPU of preparing and pressing, growth per decade of vertices up to 998,562",
            f"{MOST_GROWTH:g}x",
            ", ".join(f"{total(case):.2f} s" for case in cases) + "; " + ", ".join(f"{g:.1f}x" for g in grown),
            all(g <= MOST_GROWTH for g in grown),
        ),
        (
            "the same: peak memory",
            f"{MOST_GIB:g} GiB",
            f"{cases[-1]['peak_gib']:.2f} GiB",
            cases[-1]["peak_gib"] <= MOST_GIB,
        ),
        (
            "the same: far field against the direct sum",
            f"{MOST_MISS:g}",
            f"{cases[-1]['far_field']:.0e}",
            cases[-1]["far_field"] <= MOST_MISS,
        ),
    ]
    keep(figures)
    report = {"machine_threads": 1, "unit": "s of CPU time", "cases": cases, "aspher": beside_peer(cases[-1])}
    TARGET.mkdir(exist_ok=True)
    (TARGET / "scale.json").write_text(json.dumps(report, indent=2) + "\n")
    return 0 if is_right else 1


def beside_peer(largest):
    """Runs aspher on a million points and sets our largest case beside it; what it took, or None."""
    from bench.peers import aspher_peer
    from bench.peers.debian import Unavailable

    try:
        python = aspher_peer.python(TARGET)
        peer = json.loads(said([str(python), aspher_peer.__file__, str(PEER_POINTS)]))
    except (Unavailable, subprocess.CalledProcessError) as error:
        print(f"aspher is left out: {error}")
        return None
    spent = f"{peer['cpu_s']:.2f} s of CPU, {peer['peak_gib']:.2f} GiB"
    print(f"aspher {peer['version']}, {peer['points']} points, {peer['status']}: {spent}")
    ratio = total(largest) / peer["cpu_s"]
    judge(f"ours at {largest['vertices']} vertices over aspher {ratio:.2f}", f"<= {PEER_RATIO:g}", ratio <= PEER_RATIO)
    what = f"a million vertices against aspher on {peer['points']} points, one run, one thread"
    keep([(what, f"{PEER_RATIO:g}x", f"{ratio:.2f}x", ratio <= PEER_RATIO)])
    return peer


def keep(figures):
    """Writes figures (what, wanted, measured, whether met) into RESULTS.md, if asked."""
    import results

    command = "target/venv/bin/python tests/bench/scale.py"
    results.record("bench", command, [results.Figure(*figure) for figure in figures])


def judge(what, wanted, is_met):
    """Prints a figure beside what is wanted of it."""
    print(f"{what}, wanted {wanted}: {'met' if is_met else 'NOT MET'}")


def total(case):
    """CPU of preparing and pressing, s."""
    return case["prepare_s"] + case["press_s"]


def growth(small, large):
    """Growth of the cost over one decade of vertices."""
    decades = large["vertices"] / small["vertices"] / 10.0
    return total(large) / total(small) / decades


def apart(*arguments):
    """What this file prints when run by itself with `arguments`."""
    return json.loads(said([sys.executable, __file__, *arguments]))


def said(command):
    """The last line that a process prints. Raises CalledProcessError."""
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True, env={**os.environ, **ONE_THREAD})
    return done.stdout.strip().splitlines()[-1]


def measure(size):
    """Prepares and presses the pad of one size; what it took."""
    import thenar
    from bench import refined_pad

    positions, triangles = refined_pad.pad(size)
    handle = refined_pad.handle(positions, DEPTH_MM)
    material = thenar.Material.finger_layer()
    skin, prepare_s, prepared_in = timed(lambda: thenar.Skin(positions, triangles, materials=[material]))
    contact, press_s, _ = timed(lambda: skin.press(*handle))
    return {
        "vertices": len(positions),
        "contacts": int(contact.in_contact.sum()),
        "force_n": float(contact.total_force_n[2]),
        "prepare_s": prepare_s,
        "press_s": press_s,
        "wall_s": {"prepare": prepared_in, **dict(contact.seconds.items())},
        "peak_gib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20,
        "has_converged": bool(contact.convergence["has_converged"]),
        "complementarity": float(contact.residual["complementarity"]),
        "far_field": float(contact.residual["far_field"]),
    }


def timed(call):
    """What `call` returns, and the CPU and wall seconds that it took."""
    wall, cpu = time.perf_counter(), time.process_time()
    value = call()
    return value, time.process_time() - cpu, time.perf_counter() - wall


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1]))
    if sys.argv[1:2] == ["case"]:
        print(json.dumps(measure(int(sys.argv[2]))))
        sys.exit()
    sys.exit(main([int(size) for size in sys.argv[1:]] or SIZES))
