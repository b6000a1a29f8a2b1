"""Names of the columns of a text table, to ask the user which is which. Values are read by the native module alone."""

import csv
import re
from itertools import pairwise
from pathlib import Path

_MOST_BYTES = 1 << 16
"""Part of a file in which its head is looked for."""
_SEPARATORS = "\t;,"
"""The first that a line holds parts it, as in the native module."""
_UNITS = re.compile(
    r"s|secs?|seconds?|[mu]s|min|h|[cmun]?m|(milli|centi)?meters|in|inches|[kmunp]?n|kgf?s?|gf?|lbf|lbs?|[kmg]?pa|m?bar"
    r"|psi|mmhg|n/m|n/mm2?|m?v|hz|%|mm/s"
)
"""Units in lower case, `u` for micro and `2` for squares: those of the native module, and others that tables have."""
_LEAST_UNITS = 2
"""Known units that make a row one of units, as in the native module."""


def of(path):
    """Names above the first row of numbers, in order; empty where the file is no text or has none. Raises `OSError`."""
    text = _text(Path(path))
    rows = [[]] + [_fields(line) for line in text.splitlines() if line.strip() and not line.startswith("#")]
    for place, (above, row) in enumerate(pairwise(rows)):
        if len(row) >= 2 and all(_is_number(field) or not field for field in row) and any(row):
            before = rows[place - 1] if place >= 1 else []
            return _names(above, before)
    return []


def _names(above, before):
    """The row above the numbers, or the one before it where the former holds units alone."""
    if not above or any(_is_number(field) for field in above):
        return []
    are_units = len(before) == len(above) and all(before) and sum(map(_is_unit, above)) >= _LEAST_UNITS
    return [name for name in (before if are_units else above) if name]


def _text(path):
    with path.open("rb") as file:
        held = file.read(_MOST_BYTES)
    if held.startswith((b"\xff\xfe", b"\xfe\xff")):
        return held[: len(held) // 2 * 2].decode("utf-16", "replace")
    if b"\0" in held:
        return ""
    try:
        return held.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        is_cut = len(held) == _MOST_BYTES and error.start > len(held) - 4
        return held.decode("utf-8-sig" if is_cut else "latin-1", "ignore")


def _fields(line):
    separator = next((letter for letter in _SEPARATORS if letter in line), None)
    parts = next(csv.reader([line])) if separator == "," else line.split(separator)
    return [field.strip().strip('"').strip() for field in parts]


def _is_unit(field):
    bare = field.strip("()[] ").lower().replace("\N{SUPERSCRIPT TWO}", "2").replace("^", "")
    return _UNITS.fullmatch(bare.replace("\N{MICRO SIGN}", "u").replace("\N{GREEK SMALL LETTER MU}", "u")) is not None


def _is_number(field):
    try:
        float(field.replace(",", ".", 1))
    except ValueError:
        return False
    return True
