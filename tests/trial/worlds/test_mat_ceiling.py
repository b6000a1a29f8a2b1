"""A mat that clips though its data sheet does not say so is at fault, and one that does not clip is not."""

import csv
import json

import thenar
from trial import studies


def _said(folder):
    return json.loads(thenar.diagnose(thenar.Study.load(folder)).to_json())


def _readings(folder):
    files = sorted(folder.glob("mat_*.csv"))
    return {path: list(csv.DictReader(path.open())) for path in files}


def _clip(folder, limit):
    for path, rows in _readings(folder).items():
        for row in rows:
            row["pressure_kpa"] = f"{min(float(row['pressure_kpa']), limit):.4f}"
        with path.open("w") as file:
            table = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
            table.writeheader()
            table.writerows(rows)


def test_clipped_cells_are_named_with_their_ceiling(tmp_path):
    studies.make("finger", 5, 0.01, tmp_path)
    largest = max(float(row["pressure_kpa"]) for rows in _readings(tmp_path).values() for row in rows)
    limit = round(0.6 * largest, 2)
    _clip(tmp_path, limit)
    said = _said(tmp_path)
    (finding,) = [one for one in said["findings"] if one["effect"] == "saturation"]
    assert finding["kind"] == "instrument" and said["verdict"] == "instrument"
    assert abs(finding["parameters"]["ceiling_kpa"]["value"] - limit) < 1e-6


def test_mat_that_does_not_clip_is_not_accused(tmp_path):
    studies.make("finger", 5, 0.01, tmp_path)
    assert [one["effect"] for one in _said(tmp_path)["findings"]] == []
