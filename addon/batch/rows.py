"""The tables of a batch: one row a case, as CSV and Parquet, and a sheet of what the swept settings did."""

import csv
import re
import statistics

from .. import native
from ..results import export
from .jobs import KEYS, NOT_SWEPT

RESULTS = (
    "force_n",
    "contact_area_mm2",
    "peak_pressure_kpa",
    "patch_peak_kpa",
    "mean_pressure_kpa",
    "max_penetration_before_mm",
    "penetration_after_mm",
    "write_back_error_mm",
    "offset_mm",
    "grip_mm",
)
SETTING = "set_"
"""Before the names of settings, so that a wanted force and the force found are told apart."""
_SUMMED = ("force_n", "contact_area_mm2", "peak_pressure_kpa", "patch_peak_kpa", "mean_pressure_kpa")


def row(case, case_hash, answer):
    """The row of a case from its answer, or from `None` where it has none yet."""
    summary, error = answer.get("summary", {}), answer.get("error", "")
    status = "failed" if error else "done"
    settings = {SETTING + key: case.get(key) for key in KEYS if key not in NOT_SWEPT}
    numbers = {name: summary.get(name) for name in RESULTS}
    return {
        "name": case["name"],
        "status": status,
        "message": error,
        "grade": summary.get("grade", ""),
        "reason": summary.get("reason", ""),
        **settings,
        **numbers,
        "warnings": "; ".join(summary.get("warnings", ())),
        "case_hash": case_hash,
    }


def save(out, rows):
    """Write `results.csv`, `results.parquet` and `summary.csv` into `out`, each whole or not at all."""
    if not rows:
        return
    columns = {name: [each[name] for each in rows] for name in rows[0]}
    export.replace_file(out / "results.csv", lambda path: _write_csv(path, list(columns), rows))
    table = {name: _column(name, values) for name, values in columns.items()}
    export.replace_file(out / "results.parquet", lambda path: path.write_bytes(native.module.parquet(table)))
    sheet = list(_summary(rows))
    if sheet:
        export.replace_file(out / "summary.csv", lambda path: _write_csv(path, list(sheet[0]), sheet))


def _summary(rows):
    """One row for each value of each setting that differs between cases: counts; mean, least and greatest results."""
    for key in [name for name in rows[0] if name.startswith(SETTING)]:
        values = list(dict.fromkeys(each[key] for each in rows))
        if len(values) < 2:
            continue
        for value in values:
            those = [each for each in rows if each[key] == value]
            done = [each for each in those if each["status"] == "done"]
            told = {
                "setting": key.removeprefix(SETTING),
                "value": "as in the file" if value is None else value,
                "cases": len(those),
                "failed": len(those) - len(done),
            }
            for name in _SUMMED:
                numbers = [each[name] for each in done]
                told[f"{name}_mean"] = statistics.fmean(numbers) if numbers else None
                told[f"{name}_least"], told[f"{name}_greatest"] = min(numbers, default=None), max(numbers, default=None)
            yield told


def _column(name, values):
    """A column of texts or of numbers; nothing is null."""
    kinds = {
        wanted
        for key, wanted in KEYS.items()
        if SETTING + key == name and isinstance(wanted, str) and wanted.endswith(("zero", "number"))
    }
    if name in RESULTS or kinds:
        return [None if value is None else float(value) for value in values]
    return [None if value is None else str(value) for value in values]


FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""Beginnings of a cell that spreadsheets compute."""
_CONTROL = re.compile("[\0-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]")
"""Signs that move a terminal's cursor or color its text; tabs and ends of lines are a text's own."""


def _write_csv(path, columns, rows):
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fieldnames=columns)
        writer.writeheader()
        writer.writerows({name: cell(value) for name, value in row.items()} for row in rows)


def cell(value):
    """A text that a spreadsheet would take for a formula, with an apostrophe before it; control signs as escapes."""
    if not isinstance(value, str):
        return value
    text = _CONTROL.sub(lambda found: ascii(found[0])[1:-1], value)
    return f"'{text}" if text.startswith(FORMULA) else text
