"""A job file to cases: tables `[[case]]` and `[[sweep]]`, checked before anything runs; and a case's digest."""

import hashlib
import itertools
import json
import re
import tomllib
from pathlib import Path

from .. import names
from ..scene.checks import Refusal
from ..soft_grip import settings as grip_settings

_TEXT, _NUMBER, _WHOLE, _FLAG = "a text in quotes", "a number above zero", "a whole number", "true or false"
_GRIPS = ("rigid", *grip_settings.PRESETS)
KEYS = {
    "name": _TEXT,
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
    "out": _TEXT,
    "save": _FLAG,
    "render": _FLAG,
}
"""What a case may say, and what is admissible. `stiffness` is a factor on every modulus of the skin; a grip covers
every part of the product."""

_GRIP_RANGES = {"grip_shore_a": (20, 80), "grip_youngs_mpa": (0.001, 1e5), "grip_thickness_mm": (0.1, 1000)}
"""What the properties of a grip hold."""

NOT_SWEPT = ("name", "out", "save", "render")
_PATHS = ("blend",)
MOST_CASES = 1_000_000


def read_jobs(path):
    """The cases of a job file, dictionaries of `KEYS`; keys at the top are defaults, paths are relative to the file.

    A table `[[sweep]]` gives lists of values and stands for every combination of them, the last list running fastest.
    Raises `Refusal` naming the case, the key and what is admissible.
    """
    try:
        jobs = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError:
        raise Refusal(f"there is no job file '{path}'") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise Refusal(f"'{path}' is not TOML: {error}") from None
    listed, sweeps = jobs.pop("case", []), jobs.pop("sweep", [])
    if not isinstance(listed, list) or not isinstance(sweeps, list) or not (listed or sweeps):
        raise Refusal(f"'{path}' lists no case; add one [[case]] for each, or a [[sweep]] with lists of values")
    cases = [{"name": f"case-{number:03}", **jobs, **own} for number, own in enumerate(listed, 1)]
    for number, own in enumerate(sweeps, 1):
        cases.extend({**jobs, **case} for case in _swept(own, f"sweep-{number}"))
    return [_checked(case, path) for case in _named_apart(cases, path)]


def check(case, name):
    """Refuse a case that says what no case can say; `name` is how the user knows it. Raises `Refusal`."""
    for key, value in case.items():
        if key not in KEYS:
            raise Refusal(f"case {name} has the unknown key '{key}'; known: {', '.join(sorted(KEYS))}")
        wanted = KEYS[key]
        if not _fits(value, wanted):
            told = " or ".join(f'"{word}"' for word in wanted) if isinstance(wanted, tuple) else wanted
            raise Refusal(f"case {name}: {key} is {value!r}, but must be {told}")
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
    for key, (low, high) in _GRIP_RANGES.items():
        if not low <= case.get(key, low) <= high:
            raise Refusal(f"case {name}: {key} is {case[key]}, but must be {low:g} to {high:g}")


def case_hash(case, files):
    """Digest of all that a case's result depends on: its settings, its file's bytes, Thenar's version.

    `files` is a dictionary that remembers the digests of files within a run.
    """
    digest = hashlib.blake2b(digest_size=16)
    digest.update(json.dumps({key: case[key] for key in sorted(case)}, default=str).encode())
    digest.update(names.VERSION.encode())
    if case["blend"] not in files:
        path = Path(case["blend"])
        files[case["blend"]] = hashlib.blake2b(path.read_bytes() if path.is_file() else b"").digest()
    digest.update(files[case["blend"]])
    return digest.hexdigest()


def stem(case):
    """Name of a case's files, without a suffix, fit for every file system."""
    return re.sub(r"[^\w.+-]", "_", str(case.get("out", case["name"])))


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


def _named_apart(cases, path):
    taken = {}
    for case in cases:
        case["name"] = str(case["name"])
        for what, key in (("name", case["name"]), ("file name", stem(case))):
            if taken.setdefault((what, key), case) is not case:
                raise Refusal(f"two cases of '{path}' have the same {what} '{key}'; give each its own")
    return cases


def _checked(case, path):
    check(case, case["name"])
    case.update({key: str((path.parent / case[key]).resolve()) for key in _PATHS})
    return case


def _fits(value, wanted):
    if isinstance(wanted, tuple):
        return value in wanted
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return {
        _TEXT: isinstance(value, str) or is_number,
        _NUMBER: is_number and 0.0 < value < float("inf"),
        _WHOLE: isinstance(value, int) and not isinstance(value, bool),
        _FLAG: isinstance(value, bool),
    }[wanted]
