"""Preset files: where they are, how they are named, read and written. What a preset means stands in `kinds`.

A preset is a JSON text of data. Blender's own presets are Python scripts, which run when they are chosen; files that
people send each other must not.
"""

import json
import re
from pathlib import Path

import bpy

from ..results.export import replace_file
from ..scene.checks import Refusal

FORMAT = "thenar preset"
VERSION = 1
SUFFIX = ".json"
LARGEST = 1_000_000
"""Bytes of a preset file."""
LONGEST = 60
"""Letters of a preset's name."""
_NOT_IN_NAMES = re.compile(r'[\\/:*?"<>|\x00-\x1f\x7f]')


def folder(kind):
    """The folder of one kind's presets in the user's configuration."""
    return Path(bpy.utils.user_resource("CONFIG", path="")) / "thenar" / "presets" / kind.lower()


def listed(kind):
    """Names of the presets of a kind, in order."""
    try:
        return sorted((file.stem for file in folder(kind).glob(f"*{SUFFIX}")), key=str.lower)
    except OSError:
        return []


def path_of(kind, name):
    """The file of the preset of that name, whatever its capitals; a new one where there is none.

    Raises `Refusal` for a name that no file can have.
    """
    clean = _NOT_IN_NAMES.sub("_", name).strip(" .")
    if not clean or len(clean) > LONGEST:
        raise Refusal(f"'{name}' cannot be the name of a preset; type 1 to {LONGEST} letters")
    there = {known.lower(): known for known in listed(kind)}
    return folder(kind) / f"{there.get(clean.lower(), clean)}{SUFFIX}"


def save(kind, name, content, replaces=False):
    """Write a preset of `content` (what `kinds` reads). Returns its path.

    Raises `Refusal` where one of that name is there already, or the folder cannot be written.
    """
    path = path_of(kind, name)
    if path.exists() and not replaces:
        raise Refusal(f"there is a preset '{path.stem}' already; choose another name, or tick Replace")
    text = json.dumps({"format": FORMAT, "version": VERSION, "kind": kind.lower(), **content}, indent=2)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        replace_file(path, lambda partial: partial.write_text(text + "\n", "utf-8"))
    except OSError as error:
        raise Refusal(f"'{path}' cannot be written: {error.strerror}; free the folder for writing") from None
    return path


def remove(kind, name):
    """Delete a preset's file. Raises `Refusal` where it cannot be deleted."""
    path = path_of(kind, name)
    try:
        path.unlink()
    except OSError as error:
        raise Refusal(f"'{path}' cannot be deleted: {error.strerror}; look at the folder's rights") from None


def read(path):
    """The content of a preset file, a dict; its fields are checked by `kinds`.

    Raises `Refusal` with file and line where it is no preset of a version that is known.
    """
    path = Path(path)
    try:
        data = path.read_bytes() if path.stat().st_size <= LARGEST else None
    except OSError as error:
        raise Refusal(f"'{path.name}' cannot be read: {error.strerror}; choose the preset's file") from None
    if data is None:
        raise Refusal(f"'{path.name}' is larger than a preset can be (1 MB); choose the preset's file")
    content = _parsed(path.name, data)
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise Refusal(f'\'{path.name}\' is no preset of Thenar: its "format" is not "{FORMAT}"; choose another file')
    version = content.get("version")
    if type(version) is not int or version < 1:
        raise Refusal(f"'{path.name}', version: {version!r} is no whole number from 1 on; write {VERSION}")
    if version > VERSION:
        raise Refusal(
            f"'{path.name}' was written by a newer Thenar (version {version}, this one reads {VERSION}); update Thenar"
        )
    return content


def _parsed(name, data):
    try:
        return json.loads(data.decode("utf-8-sig"), object_pairs_hook=_once, parse_constant=_no_number)
    except json.JSONDecodeError as error:
        raise Refusal(
            f"'{name}', line {error.lineno}, column {error.colno}: {error.msg}; mend it, or save the preset again"
        ) from None
    except UnicodeDecodeError:
        raise Refusal(f"'{name}' is no text in UTF-8; save the preset again") from None
    except ValueError as error:
        raise Refusal(f"'{name}': {error}; save the preset again") from None
    except RecursionError:
        raise Refusal(f"'{name}' is nested too deep; save the preset again") from None


def _once(pairs):
    keys = [key for key, _ in pairs]
    twice = next((key for key in keys if keys.count(key) > 1), None)
    if twice is not None:
        raise ValueError(f'"{twice}" is there twice')
    return dict(pairs)


def _no_number(word):
    raise ValueError(f"{word} is no number")
