"""What a measurement file holds for a study, and which of its columns must be asked for. Knows nothing of Blender."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .. import native
from ..scene.checks import Refusal
from . import heads
from .repeats import Track

_GUESSES = {
    "time": re.compile(r"time|zeit|temps|tiempo|tempo|^t\b|sec", re.IGNORECASE),
    "force": re.compile(r"force|load|kraft|fuerza|carga|forza|^f[nz]?\b|charge", re.IGNORECASE),
    "depth": re.compile(
        r"depth|tiefe|profond|indent|penetr|disp|exten|travel|weg|stroke|posi|dist|^[xzd]\b|height", re.IGNORECASE
    ),
}
"""Names that suggest a role; the user sees and corrects what they propose."""
TOUCHED = re.compile(r"depth|tiefe|profond|indent|penetr", re.IGNORECASE)
"""Names of a length that counts from the skin."""
_NO_UNIT = re.compile(r"column '(.+?)' has no unit")
_read = {}
"""By path and run: time, size and columns of a recording when it was read, and its `Track`."""
_CHANNELS = {"time": ("time_s",), "depth": ("depth_mm", "travel_mm"), "force": ("force_n",)}


@dataclass(frozen=True)
class Found:
    """One recording of a file. `headers` is empty where the file itself says all; `asks`: roles that are open."""

    path: str
    run: str
    headers: tuple = ()
    asks: tuple = ()
    is_depth_reversed: bool = False
    is_force_reversed: bool = False


def look(path):
    """The recordings of a file as `Found`. Raises `Refusal` where it holds none that a study can be made of."""
    name = Path(path).name
    try:
        read = native.module.read_recording(path)
    except native.error_types() as error:
        headers = _headers(path)
        if not headers:
            raise Refusal(_without_names(path, name) or str(error)) from None
        return [Found(str(path), "", headers, tuple(_CHANNELS))]
    if not read.curves:
        raise Refusal(
            f"'{name}' holds a pressure map and no press of a tool; "
            "load it with + under Recordings, and compare it there"
        )
    runs = [curve.name if len(read.curves) > 1 else "" for curve in read.curves]
    return [_found(path, run, curve) for run, curve in zip(runs, read.curves, strict=True)]


def _found(path, run, curve):
    asks = tuple(role for role, names in _CHANNELS.items() if not any(name in curve.channels for name in names))
    falls = any("falls where the force grows" in text for text in curve.warnings)
    pulls = any("the force is negative" in text for text in curve.warnings)
    asks += tuple(role for role, is_odd in (("depth", falls), ("force", pulls)) if is_odd and role not in asks)
    if not asks:
        return Found(str(path), run)
    headers = _headers(path) or tuple(name.rpartition("_")[0] or name for name in curve.channels)
    return Found(str(path), run, headers, asks, falls, pulls)


def _headers(path):
    try:
        return tuple(heads.of(path))
    except OSError as error:
        raise Refusal(f"'{Path(path).name}' cannot be read ({error.strerror}); check the file") from None


def _without_names(path, name):
    """What to do about a table of numbers alone; empty where the file is something else."""
    with open(path, encoding="latin-1") as file:
        first = next((line for line in file if line.strip()), "")
    if not re.fullmatch(r"[\s\d.,;+\-eE]*\d[\s\d.,;+\-eE]*", first):
        return ""
    return (
        f"'{name}', line 1: no row of names stands above the numbers; write one as first line, "
        "such as time_s;depth_mm;force_n in the order of the columns, and choose the file again"
    )


def propose(headers, asks):
    """Header by role, as far as names or what remains say it; each header once."""
    known = [_GUESSES[role] for role in _GUESSES if role not in asks]
    free, chosen = [header for header in headers if not any(each.search(header) for each in known)], {}
    for role in asks:
        fitting = [header for header in free if _GUESSES[role].search(header)]
        if len(fitting) == 1:
            chosen[role] = fitting[0]
            free.remove(fitting[0])
    open_roles = [role for role in asks if role not in chosen]
    if len(open_roles) == 1 and len(free) == 1:
        chosen[open_roles[0]] = free[0]
    return chosen


def track(path, run, columns):
    """The recording as the study will read it. Raises `Refusal` with what is still missing.

    `columns`: (key, header) pairs as they stand under `[recordings.columns]`.
    """
    file = Path(path)
    try:
        seen = file.stat()
    except OSError:
        raise Refusal(f"'{path}' is not there any more; choose the files again") from None
    state = (seen.st_mtime_ns, seen.st_size, tuple(columns))
    held = _read.get((str(path), run))
    if held is None or held[0] != state:
        held = _read[str(path), run] = state, _track(str(path), run, columns)
    return held[1]


def keep(recordings):
    """Let go of the recordings that were read, but of these: (path, run) pairs."""
    for other in _read.keys() - set(recordings):
        del _read[other]


def _track(path, run, columns):
    name = Path(path).name
    named = {"columns": dict(columns)} if columns else {}
    named |= {"run": run} if run else {}
    try:
        read = native.module.read_recording(path, **named)
    except native.error_types() as error:
        unit = _NO_UNIT.search(str(error))
        if unit:
            raise Refusal(f"'{name}' states no unit of the {unit[1].replace('_', ' ')}; choose it") from None
        raise Refusal(str(error).replace(path, name)) from None
    (curve,) = read.curves[:1] or [None]
    if curve is None:
        raise Refusal(f"'{name}' holds no press of a tool under these columns; choose others")
    channels = {}
    for role, names in _CHANNELS.items():
        held = next((curve.channels[each] for each in names if each in curve.channels), None)
        if held is None:
            raise Refusal(f"which column of '{name}' is the {role}? Choose it below")
        channels[role] = np.asarray(held, dtype=np.float64)
    return Track(channels["time"], channels["depth"], channels["force"], "depth_mm" in curve.channels)
