"""Files of pose parameters as plain values: NPZ, NPY, JSON and pickles. No code of a file is ever run."""

import io
import json
import zipfile
import zlib
from pathlib import Path

import numpy as np

from ..scene.checks import Refusal
from . import plain_pickle

SUFFIXES = (".npz", ".npy", ".json", ".pkl", ".pickle")
LARGEST = 512 * 1024 * 1024
"""Bytes of a file, and of the arrays that it unpacks to."""
_HEADERS = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}


def read(path):
    """What the file at `path` holds: dicts, lists, arrays, texts, numbers.

    Raises `Refusal` for a file that is missing, of another kind, too large, damaged, or that holds code.
    """
    path = Path(path)
    if path.suffix.lower() not in SUFFIXES:
        raise Refusal(f"'{path.name}' is no file of pose parameters; save them as .npz, .json or .pkl")
    if not path.is_file():
        raise Refusal(f"there is no file '{path.name}' in '{path.parent}'; choose the file of pose parameters")
    if path.stat().st_size > LARGEST:
        raise Refusal(f"'{path.name}' is larger than 512 MB; save the hand's poses alone as .npz")
    return _READERS[path.suffix.lower()](path)


def _json(path):
    try:
        return json.loads(path.read_text("utf-8"))
    except json.JSONDecodeError as error:
        raise Refusal(f"'{path.name}', line {error.lineno}, column {error.colno}: {error.msg}; save it again") from None
    except (UnicodeDecodeError, RecursionError, ValueError):
        raise Refusal(f"'{path.name}' is no JSON text; save it again, or as .npz") from None


def _pickle(path):
    return plain_pickle.loads(path.read_bytes(), path.name)


def _npy(path):
    return _array(path.read_bytes(), path.name)


def _npz(path):
    try:
        with zipfile.ZipFile(path) as archive:
            members = [member for member in archive.infolist() if member.filename.endswith(".npy")]
            if sum(member.file_size for member in members) > LARGEST:
                raise Refusal(f"the arrays of '{path.name}' take more than 512 MB; save the hand's poses alone")
            return {
                member.filename.removesuffix(".npy"): _array(
                    archive.read(member), f"{path.name}: {member.filename.removesuffix('.npy')}"
                )
                for member in members
            }
    except (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, NotImplementedError, OSError) as error:
        raise Refusal(f"'{path.name}' is no complete .npz file ({error}); save or copy it again") from None


def _array(data, name):
    """The array of an .npy file; where numpy pickled objects into it, what they are."""
    stream = io.BytesIO(data)
    try:
        version = np.lib.format.read_magic(stream)
        shape, _, dtype = _HEADERS[version](stream)
        if not dtype.hasobject:
            stream.seek(0)
            return np.load(stream, allow_pickle=False)
    except (ValueError, KeyError, EOFError, SyntaxError, OverflowError, MemoryError):
        raise Refusal(f"'{name}' is no complete array of numpy; save or copy it again") from None
    held = plain_pickle.loads(data[stream.tell() :], name)
    return held if shape == () or isinstance(held, list) else [held]


_READERS = {".npz": _npz, ".npy": _npy, ".json": _json, ".pkl": _pickle, ".pickle": _pickle}
