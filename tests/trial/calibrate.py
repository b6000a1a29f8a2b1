"""Diagnoses the calibration split, and scores it: the table on which the thresholds of the diagnosis were set.

    python -m trial.calibrate OUT [--binary thenar] [--workers 2] [--every N]        (in `tests`)

The thresholds stand in rust/diagnosis/src/diagnose (gates.rs, checks.rs, prepare.rs), each with what it means. They
were set on this split alone: detection above what its nulls reach, the lead over rivals and what a name may leave
between its single effects and its unlisted ones.
"""

import argparse
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from trial import cases


def diagnose(binary, case, out):
    """Writes OUT/<case>/findings.json. Raises CalledProcessError if the binary fails."""
    with tempfile.TemporaryDirectory() as folder:
        cases.write(case, folder)
        command = [binary, "diagnose", folder, "--out", str(out / case), "--threads", "1"]
        subprocess.run(command, check=True, capture_output=True)


def main():
    """Runs and prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--binary", default="thenar")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--every", type=int, default=1)
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    wanted = cases.names("calibration")[:: asked.every]
    with ThreadPoolExecutor(asked.workers) as pool:
        list(pool.map(lambda case: diagnose(asked.binary, case, asked.out), wanted))
    score = [sys.executable, "-m", "trial.score", str(asked.out), "--split", "calibration"]
    raise SystemExit(subprocess.run(score, check=False).returncode)


if __name__ == "__main__":
    main()
