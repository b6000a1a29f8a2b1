"""Whether findings still belong to the study on disk. Looks at the files at most every two seconds."""

import hashlib
import time
import tomllib
from pathlib import Path

from .. import languages, names

STUDY_FILE = "study.toml"
_EVERY_S = 2.0
_seen = {}
"""By folder: when it was last looked at, what its files looked like then, and their digest."""


def digest(folder):
    """Digest of study.toml and of every file it names; empty if it cannot be read."""
    told = hashlib.blake2b(digest_size=16)
    try:
        for path in _files(Path(folder)):
            told.update(f"{path.name}\0{path.stat().st_size}\0".encode())
            told.update(path.read_bytes())
    except (OSError, ValueError):
        return ""
    return told.hexdigest()


def problem(state):
    """Why the findings may not hold for the study as it is now, as one sentence; empty if they do."""
    if state.made_with != f"Thenar {names.VERSION}":
        return languages.iface(
            "These findings were made with {made_with}; diagnose again with this version", made_with=state.made_with
        )
    now = _remembered(state.path)
    if not now:
        words = "The study is no longer at '{path}', so nobody can see whether it changed"
        return languages.iface(words, path=state.path)
    return "" if now == state.study_hash else "The study has changed since; diagnose again"


def forget():
    """Look at the files anew next time."""
    _seen.clear()


def _remembered(folder):
    looked, signature, known = _seen.get(folder, (0.0, None, ""))
    if signature is not None and time.monotonic() - looked < _EVERY_S:
        return known
    now = _signature(folder)
    if now != signature or signature is None:
        known = digest(folder)
    _seen[folder] = (time.monotonic(), now, known)
    return known


def _signature(folder):
    try:
        return tuple((str(path), path.stat().st_size, path.stat().st_mtime_ns) for path in _files(Path(folder)))
    except (OSError, ValueError):
        return ()


def _files(folder):
    """study.toml and the files it names, in its order."""
    top = folder / STUDY_FILE
    yield top
    for text in dict.fromkeys(_texts(tomllib.loads(top.read_text(encoding="utf-8")))):
        if len(text) < 256 and "\0" not in text and (folder / text).is_file():
            yield folder / text


def _texts(value):
    if isinstance(value, str) and value:
        yield value
    elif isinstance(value, dict):
        for each in value.values():
            yield from _texts(each)
    elif isinstance(value, list):
        for each in value:
            yield from _texts(each)
