"""Force, area and peak of a mat over its frames, kept with the recording as text. No Blender in it."""

import json

import numpy as np

_MOST = 480
"""Frames that are kept, evenly spread; those of the largest force and peak are always among them."""


def kept(values, areas_mm2, is_calibrated):
    """Force, area and peak of each frame of a mat as text, for `ThenarRecording.curves`.

    `values` (frames, cells): kPa, or counts; `areas_mm2` (cells). Force in N and area in cm² where the mat is
    calibrated and all areas are known; else sums of counts and numbers of cells.
    """
    values, areas = np.nan_to_num(np.asarray(values, float)), np.asarray(areas_mm2, float)
    in_units = is_calibrated and bool(np.isfinite(areas).all())
    weights = areas if in_units else np.ones(values.shape[1])
    force = (values * weights).sum(axis=1) / (1e3 if in_units else 1.0)
    area = ((values > 0.0) * weights).sum(axis=1) / (100.0 if in_units else 1.0)
    peak = values.max(axis=1, initial=0.0)
    count = len(values)
    rows = np.linspace(0, count - 1, min(count, _MOST)).round().astype(int)
    rows = np.unique([*rows, force.argmax(), peak.argmax()])
    columns = {"force": force, "area": area, "peak": peak}
    listed = {name: [float(f"{value:.4g}") for value in column[rows]] for name, column in columns.items()}
    unit = "kPa" if in_units else "kPa, no areas" if is_calibrated else "counts"
    return json.dumps({"unit": unit, "frame": (rows + 1).tolist(), **listed}, separators=(",", ":"))
