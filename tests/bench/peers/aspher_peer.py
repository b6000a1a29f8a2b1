"""aspher, a boundary element solver of rough contact on a flat half space (PyPI), in an environment of its own.

Run by itself there: solves a rough square of `POINTS` by `POINTS` cold, as its own first example does; prints JSON.
"""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

VERSION = "0.1.3.post1"


def python(target):
    """The interpreter of an environment below `target` that holds aspher; made once. Raises Unavailable.

    aspher is built from source and needs Eigen's headers, which come from Debian.
    """
    from bench.peers import debian

    made = Path(target) / "aspher-venv"
    interpreter = made / "bin/python"
    if (
        interpreter.is_file()
        and subprocess.run([interpreter, "-c", "import aspher"], capture_output=True).returncode == 0
    ):
        return interpreter
    eigen = debian.unpacked(Path(target) / "eigen", ["libeigen3-dev"]) / "usr"
    subprocess.run([sys.executable, "-m", "venv", made], check=True, capture_output=True)
    install = [interpreter, "-m", "pip", "install", "--quiet", f"aspher=={VERSION}"]
    found = {**os.environ, "CMAKE_PREFIX_PATH": str(eigen), "Eigen3_ROOT": str(eigen)}
    done = subprocess.run(install, env=found, capture_output=True, text=True)
    if done.returncode:
        lines = done.stderr.strip().splitlines() or ["pip failed"]
        raise debian.Unavailable(f"aspher cannot be built: {lines[-1]}")
    return interpreter


def solve(points):
    """Presses aspher's rough surface of its first example; what it took."""
    import resource

    import aspher
    import rfgen

    height = rfgen.selfaffine_field(N=points, Hurst=0.8, k_low=4 / points, k_high=64 / points)
    gap = -(height * 0.002 / height.std()).ravel()
    wall, cpu = time.perf_counter(), time.process_time()
    found = aspher.solve_nested(grid_size=points, gap=gap, p_nominal=0.005, coarsest=64, q=6)
    return {
        "version": VERSION,
        "points": points * points,
        "cpu_s": time.process_time() - cpu,
        "wall_s": time.perf_counter() - wall,
        "status": str(found.status),
        "area": float(found.contact_area),
        "iterations": int(found.iterations),
        "peak_gib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20,
    }


if __name__ == "__main__":
    print(json.dumps(solve(int(sys.argv[1]))))
