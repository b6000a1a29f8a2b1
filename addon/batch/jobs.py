"""A job file to cases: tables `[[case]]` and `[[sweep]]`, checked before anything runs; and a case's digest."""

import hashlib
import itertools
import json
from dataclasses import dataclass

from .. import names
from ..scene.checks import Refusal
from ..soft_grip import settings as grip_settings
from . import case_files, depends, job_text

_NAME, _TEXT, _NUMBER = "a text or a number", "a text in quotes", "a number above zero"
_WHOLE, _FLAG = "a whole number", "true or false"
_GRIPS = ("rigid", *grip_settings.PRESETS)
KEYS = {
    "name": _NAME,
    "blend": _TEXT,
    "hand": _TEXT,
    "product": _TEXT,
    "force_n": _NUMBER,
    "model": ("layer", "paper"),
    "frame": _WHOLE,
    "pose": _TEXT,
    "fit": ("light", "firm"),
    "hand_percentile": _NUMBER,
    "hand_sex": ("female", "male"),
    "stiffness": _NUMBER,
    "grip": _GRIPS,
    "grip_thickness_mm": _NUMBER,
    "grip_youngs_mpa": _NUMBER,
    "grip_shore_a": _NUMBER,
    "out": _NAME,
    "save": _FLAG,
    "render": _FLAG,
}
"""What a case may say, and what is admissible. `stiffness` is a factor on every modulus of the skin; a grip covers
every part of the product."""

_RANGES = {
    "force_n": (1e-6, 1e6),
    "frame": (-1_048_574, 1_048_574),
    "stiffness": (1e-4, 1e4),
    "grip_shore_a": (20, 80),
    "grip_youngs_mpa": (0.001, 1e5),
    "grip_thickness_mm": (0.1, 1000),
}
"""What Blender's frames and the properties of a grip hold; what a force and a factor can be."""

NOT_SWEPT = ("name", "out", "save", "render")
_PATHS = ("blend",)
MOST_CASES = 1_000_000


@dataclass(frozen=True)
class Entry:
    """A case as the job file has it, the name of its files without a suffix, and why it is refused, if it is."""

    case: dict
    stem: str
    refusal: str = ""


def read_jobs(path):
    """The cases of a job file, dictionaries of `KEYS`; keys at the top are defaults, paths are relative to the file.

    A table `[[sweep]]` gives lists of values and stands for every combination of them, the last list running fastest.
    Raises `Refusal` naming the case, the key and what is admissible.
    """
    entries = read_entries(path)
    for entry in entries:
        if entry.refusal:
            raise Refusal(entry.refusal)
    return [entry.case for entry in entries]


def read_entries(path):
    """An `Entry` for each case of a job file. Raises `Refusal` for a file without cases, and where none is sound."""
    jobs = job_text.parse(path)
    listed, sweeps = jobs.pop("case", []), jobs.pop("sweep", [])
    if not (_are_tables(listed) and _are_tables(sweeps)) or not (listed or sweeps):
        raise Refusal(f"'{path}' lists no case; add one [[case]] for each, or a [[sweep]] with lists of values")
    cases = [{"name": f"case-{number:03}", **jobs, **own} for number, own in enumerate(listed, 1)]
    for number, own in enumerate(sweeps, 1):
        cases.extend({**jobs, **case} for case in _swept(own, f"sweep-{number}"))
    refusals = [_refusal(case, path) for case in cases]
    for case in cases:
        case["name"] = str(case["name"])
    taken = set()
    for place, case in enumerate(cases):
        if case["name"] in taken:
            refusals[place] = refusals[place] or f"case {case['name']} has the name of another; give each its own"
        taken.add(case["name"])
    if all(refusals):
        raise Refusal(refusals[0])
    pairs = list(zip(cases, refusals, strict=True))
    wanted = [(str(case.get("out", case["name"])), case["name"]) for case, refusal in pairs if not refusal]
    stems = iter(case_files.stems(wanted))
    return [Entry(case, "" if refusal else next(stems), refusal) for case, refusal in pairs]


def check(case, name):
    """Refuse a case that says what no case can say; `name` is how the user knows it. Raises `Refusal`."""
    for key, value in case.items():
        if key not in KEYS:
            raise Refusal(f"case {name} has the unknown key '{key}'; known: {', '.join(sorted(KEYS))}")
        wanted = KEYS[key]
        if not _fits(value, wanted):
            choices = " or ".join(f'"{word}"' for word in wanted) if isinstance(wanted, tuple) else wanted
            raise Refusal(f"case {name}: {key} is {_short(value)}, but must be {choices}")
        low, high = _RANGES.get(key, (value, value))
        if not low <= value <= high:
            raise Refusal(f"case {name}: {key} is {_short(value)}, but must be {low:g} to {high:g}")
    if "blend" not in case:
        raise Refusal(f'case {name} names no file; add blend = "FILE.blend"')
    for key in ("hand_percentile", "hand_sex"):
        if key in case and "fit" not in case:
            raise Refusal(
                f'case {name}: a hand of its own size must be laid on the product; add fit = "firm" or "light"'
            )
    _check_grip(case, name)
    if case.get("hand_percentile", 50) >= 100:
        raise Refusal(f"case {name}: hand_percentile is {case['hand_percentile']}, but must lie below 100")


def _check_grip(case, name):
    kinds = [key for key in ("grip", "grip_youngs_mpa", "grip_shore_a") if key in case]
    if len(kinds) > 1:
        raise Refusal(f"case {name} says both {kinds[0]} and {kinds[1]}, which are two grips; keep one")


def case_hash(case, known):
    """Digest of a case's settings, its file's bytes and Thenar's version; `known` is that of `depends.digest`.

    What its file reads besides is known once it is open: a worker gives the digests of these files with the result.
    """
    digest = hashlib.blake2b(digest_size=16)
    digest.update(json.dumps({key: case[key] for key in sorted(case)}, default=str).encode())
    digest.update(names.VERSION.encode())
    digest.update(depends.digest(case["blend"], known).encode())
    return digest.hexdigest()


def _swept(own, default):
    title = str(own.get("name", default))
    lists = {key: values for key, values in own.items() if isinstance(values, list)}
    fixed = {key: value for key, value in own.items() if key not in lists and key != "name"}
    if not lists:
        raise Refusal(f"{title} holds no list; give at least one key several values, as force_n = [5, 10, 20]")
    for key, values in lists.items():
        if key in NOT_SWEPT:
            raise Refusal(
                f"{title} cannot run through {key}; it can through {', '.join(sorted(set(KEYS) - {*NOT_SWEPT}))}"
            )
        if not values:
            raise Refusal(f"{title} has an empty list for {key}; give it values or take it out")
    count = 1
    for values in lists.values():
        count *= len(values)
    if count > MOST_CASES:
        raise Refusal(f"{title} stands for {count:,} cases, {MOST_CASES:,} are allowed; split it")
    width = len(str(count))
    for number, values in enumerate(itertools.product(*lists.values()), 1):
        yield {"name": f"{title}-{number:0{width}}", **fixed, **dict(zip(lists, values, strict=True))}


def _refusal(case, path):
    """Why a case is refused, empty where it is sound; then its paths are made absolute."""
    try:
        check(case, _short(case["name"]) if not _fits(case["name"], _NAME) else case["name"])
        case.update({key: str((path.parent / case[key]).resolve()) for key in _PATHS})
    except Refusal as refusal:
        return str(refusal)
    except (OSError, ValueError, RuntimeError) as error:  # a NUL in a path, a loop of links
        return f"case {case['name']}: '{case['blend']}' is no path ({error})"
    return ""


def _are_tables(values):
    return isinstance(values, list) and all(isinstance(each, dict) for each in values)


def _short(value):
    """A value as it may stand in a message."""
    if isinstance(value, int) and abs(value) >= 10**15:
        return f"a number of {len(str(abs(value)))} digits"
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _fits(value, wanted):
    if isinstance(wanted, tuple):
        return value in wanted
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return {
        _NAME: isinstance(value, str) or is_number,
        _TEXT: isinstance(value, str),
        _NUMBER: is_number and 0.0 < value < float("inf"),
        _WHOLE: isinstance(value, int) and not isinstance(value, bool),
        _FLAG: isinstance(value, bool),
    }[wanted]
