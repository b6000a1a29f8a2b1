"""Many cases in child processes, a row each in a file of JSON lines that outlives all of them.

A child writes {"begin": case} before a case and its row after; one that dies or is silent costs that case alone, whose
row then says so. Cases that have a row are not run again.
"""

import json
import subprocess
import sys
import time
from threading import Thread

ONE_THREAD = {name: "1" for name in ("RAYON_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
SILENT_S = 240.0


def read(out):
    """Case -> row of a file."""
    return {row["case"]: row for row in _lines(out) if "case" in row}


def write(out, row):
    """One row more."""
    with out.open("a") as file:
        file.write(json.dumps(row) + "\n")


def run(cases, out, run_one):
    """In a child: runs every case that has no row."""
    known = read(out)
    for case in (case for case in cases if case not in known):
        write(out, {"begin": case})
        write(out, {"case": case, **run_one(case)})


def search(script, cases, out, workers=1):
    """Children of `script` (--child --out FILE, the cases as JSON on standard input) until every case has a row."""
    out.parent.mkdir(parents=True, exist_ok=True)
    shares = [list(cases)[k::workers] for k in range(workers)]
    files = [out] if workers == 1 else [out.with_name(f"{out.stem}.{k}{out.suffix}") for k in range(workers)]
    threads = [Thread(target=_share, args=(script, *pair)) for pair in zip(shares, files, strict=True)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return {case: row for file in files for case, row in read(file).items()}


def _share(script, cases, out):
    while missing := [case for case in cases if case not in read(out)]:
        reason = _child(script, missing, out)
        begun = [row["begin"] for row in _lines(out) if row.get("begin") in missing]
        begun = [case for case in begun if case not in read(out)]
        if reason and not begun:
            raise SystemExit(f"a child ended before its first case: {reason}")
        if reason:
            write(out, {"case": begun[-1], "died": reason})


def _child(script, cases, out):
    """Runs one child. Returns why it ended, empty if it did all; ended here if its file does not grow."""
    log = out.with_suffix(".log")
    with log.open("w") as errors:
        command = [sys.executable, str(script), "--child", "--out", str(out)]
        process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=errors, stderr=errors, text=True)
        process.stdin.write(json.dumps(cases))
        process.stdin.close()
        size, since = -1, time.monotonic()
        while process.poll() is None:
            time.sleep(0.3)
            now = out.stat().st_size if out.exists() else 0
            if now != size:
                size, since = now, time.monotonic()
            elif time.monotonic() - since > SILENT_S:
                process.kill()
                process.wait()
                return f"silent for {SILENT_S:.0f} s"
    return "" if process.returncode == 0 else f"exit {process.returncode}: {log.read_text()[-300:]}"


def _lines(out):
    text = out.read_text().splitlines() if out.exists() else []
    return [json.loads(line) for line in text if line.startswith("{") and line.endswith("}")]
