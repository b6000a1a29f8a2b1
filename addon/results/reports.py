"""Keeps what comparisons and diagnoses returned, for as long as Blender runs, and writes their reports."""

import time
from collections import OrderedDict

from ..scene.checks import Refusal
from . import export

COMPARISON, DIAGNOSIS = "COMPARISON", "DIAGNOSIS"
_MOST = 6
_kept = OrderedDict()
"""By stamp: what has `to_json()` and `report_html()`."""


def keep(made):
    """Keep what was made. Returns the stamp that the scene remembers it by; later ones are larger."""
    stamp = str(time.time_ns())
    _kept[stamp] = made
    while len(_kept) > _MOST:
        _kept.popitem(last=False)
    return stamp


def forget():
    """Drop everything."""
    _kept.clear()


def states(scene):
    """What the scene holds that can be reported: kind -> the properties with its stamp."""
    held = {COMPARISON: scene.thenar_recordings.comparison, DIAGNOSIS: scene.thenar_diagnosis}
    return {kind: state for kind, state in held.items() if state.is_valid}


def write(scene, path, kind=""):
    """Write the report of a kind, or of the latest there is, to `path`: .html a page, .json every number.

    Returns the path. Raises `Refusal`.
    """
    held = states(scene)
    if not held or (kind and kind not in held):
        raise Refusal("there is nothing to report; press Compare or Diagnose first")
    kind = kind or max(held, key=lambda each: int(held[each].stamp or 0))
    if path.suffix not in {".html", ".json"}:
        raise Refusal(f"'{path.name}' has an unknown extension; give .html for a page or .json for numbers")
    text = _text(held[kind], kind, path.suffix)
    try:
        export.replace_file(path, lambda aside: aside.write_text(text, encoding="utf-8"))
    except OSError as error:
        raise Refusal(f"'{path}' cannot be written ({error.strerror}); choose another folder") from None
    return path


def _text(state, kind, suffix):
    made = _kept.get(state.stamp)
    if made is not None:
        return made.report_html() if suffix == ".html" else made.to_json()
    if kind == DIAGNOSIS and suffix == ".json":
        return state.findings + "\n"
    noun, button = ("comparison", "Compare") if kind == COMPARISON else ("diagnosis", "Diagnose")
    raise Refusal(f"the {noun} was made before this file was opened; press {button} again, then write the report")
