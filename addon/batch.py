"""Many cases from a TOML file: a process for each, one row each, resumable, and no bad case stops the rest."""

import csv
import hashlib
import json
import os
import subprocess
import sys
import tomllib
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

import bpy

from . import export, names
from .scene.checks import Refusal

_KEYS = {"name", "blend", "hand", "product", "force_n", "model", "frame", "out", "save", "render"}
_COLUMNS = (
    "force_n",
    "contact_area_mm2",
    "peak_pressure_kpa",
    "patch_peak_kpa",
    "mean_pressure_kpa",
    "max_penetration_before_mm",
    "penetration_after_mm",
    "write_back_error_mm",
    "offset_mm",
)


def run(jobs, out, workers):
    """Run the cases of `jobs`; results and `results.csv` go to `out`. Returns the rows.

    Raises `Refusal` for a job file that cannot be read, and at the end if any case failed.
    """
    cases = read_jobs(jobs)
    out.mkdir(parents=True, exist_ok=True)
    rows = {}
    todo = []
    for case in cases:
        done = _finished(case, out)
        if done is not None:
            rows[case["name"]] = _row(case, done, "kept")
            print(f"{case['name']}: kept from an earlier run", flush=True)
        else:
            todo.append(case)
    with ThreadPoolExecutor(max_workers=workers or max(1, (os.cpu_count() or 2) // 2)) as pool:
        under_way = {pool.submit(_run_case, case, out): case for case in todo}
        for future in as_completed(under_way):
            case = under_way[future]
            rows[case["name"]] = future.result()
            _save_rows(out, cases, rows)
            print(
                f"{case['name']}: {rows[case['name']]['status']} {rows[case['name']]['message']}".rstrip(), flush=True
            )
    _save_rows(out, cases, rows)
    failed = [name for name, row in rows.items() if row["status"] == "failed"]
    if failed:
        raise Refusal(
            f"{len(failed)} of {len(cases)} cases failed ({', '.join(failed[:5])}); see {out / 'results.csv'}"
        )
    return [rows[case["name"]] for case in cases]


def read_jobs(path):
    """The cases of a job file: tables `[[case]]`, with keys at the top as defaults; paths are relative to the file."""
    try:
        jobs = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError:
        raise Refusal(f"there is no job file '{path}'") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise Refusal(f"'{path}' is not TOML: {error}") from None
    listed = jobs.pop("case", [])
    if not listed or not isinstance(listed, list):
        raise Refusal(f"'{path}' lists no case; add one [[case]] for each")
    cases = []
    for number, own in enumerate(listed, 1):
        case = {"name": f"case-{number:03}", **jobs, **own}
        unknown = sorted(set(case) - _KEYS)
        if unknown:
            raise Refusal(f"case {case['name']} has the unknown key '{unknown[0]}'; known: {', '.join(sorted(_KEYS))}")
        if "blend" not in case:
            raise Refusal(f'case {case["name"]} names no file; add blend = "FILE.blend"')
        case["blend"] = str((path.parent / case["blend"]).resolve())
        case["name"] = str(case["name"])
        cases.append(case)
    if len({case["name"] for case in cases}) < len(cases):
        raise Refusal(f"two cases of '{path}' have the same name; give each its own")
    return cases


def _stem(case, out):
    return out / bpy.path.clean_name(str(case.get("out", case["name"])))


def _case_hash(case):
    digest = hashlib.blake2b(digest_size=16)
    digest.update(json.dumps({key: case[key] for key in sorted(case)}, default=str).encode())
    digest.update(names.VERSION.encode())
    path = Path(case["blend"])
    digest.update(path.read_bytes() if path.is_file() else b"")
    return digest.hexdigest()


def _finished(case, out):
    path = _stem(case, out).with_suffix(".json")
    try:
        summary = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, json.JSONDecodeError):
        return None
    return summary if summary.get("case_hash") == _case_hash(case) else None


def _run_case(case, out):
    stem = _stem(case, out)
    partial = stem.with_name(f".{stem.name}.worker.json")
    try:
        done = subprocess.run(_command(case, stem, partial), capture_output=True, text=True, env=_environment())
        if done.returncode != 0 or not partial.is_file():
            return _row(case, {}, "failed", _complaint(done))
        summary = json.loads(partial.read_text(encoding="utf-8"))
        summary["case"], summary["case_hash"] = case, _case_hash(case)
        target = stem.with_suffix(".json")
        export.replace_file(target, lambda path: path.write_text(json.dumps(summary, indent=1), encoding="utf-8"))
        return _row(case, summary, "done")
    except OSError as error:
        return _row(case, {}, "failed", str(error))
    finally:
        partial.unlink(missing_ok=True)


def _command(case, stem, partial):
    if __package__ == "thenar_blender" or not bpy.app.binary_path:
        start = [sys.executable, "-m", __package__, "solve", case["blend"]]
    else:
        start = [bpy.app.binary_path, "-b", case["blend"], "--command", "thenar", "solve"]
    for option, key in (("--hand", "hand"), ("--product", "product"), ("--force", "force_n"), ("--model", "model")):
        if key in case:
            start += [option, str(case[key])]
    if "frame" in case:
        start += ["--frame", str(case["frame"])]
    if case.get("save", True):
        start += ["--out", str(stem.with_suffix(".blend"))]
    if case.get("render", False):
        start += ["--render", str(stem.with_suffix(".png"))]
    return [*start, "--json", str(partial)]


def _environment():
    paths = [str(Path(__file__).parent.parent), os.environ.get("PYTHONPATH", "")]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in paths if path)}


def _complaint(done):
    lines = [line for line in done.stderr.splitlines() if line.startswith("thenar: ")]
    if lines:
        return lines[-1].removeprefix("thenar: ")
    last = [line for line in done.stderr.splitlines() if line.strip()]
    return f"the process ended with code {done.returncode}" + (f": {last[-1].strip()}" if last else "")


def _row(case, summary, status, message=""):
    row = {"name": case["name"], "status": status, "message": message, "blend": case["blend"]}
    row |= {column: summary.get(column, "") for column in _COLUMNS}
    row["seconds"] = round(sum(summary.get("seconds", {}).get(stage, 0.0) for stage in ("read", "prepare", "press")), 4)
    row["case_hash"] = summary.get("case_hash", "")
    return row


def _save_rows(out, cases, rows):
    ordered = [rows[case["name"]] for case in cases if case["name"] in rows]

    def save(path):
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, fieldnames=list(ordered[0]))
            writer.writeheader()
            writer.writerows(ordered)

    if ordered:
        export.replace_file(out / "results.csv", save)
