"""Droppable derived state: prepared skins and products, and maps of Subdivision levels, by content."""

import hashlib
from collections import OrderedDict
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

T = TypeVar("T")
_SKINS_KEPT = 4
_skins: OrderedDict[str, Any] = OrderedDict()
_PRODUCTS_KEPT = 2
_products: OrderedDict[str, Any] = OrderedDict()
_RECORDINGS_KEPT = 2
_recordings: OrderedDict[str, Any] = OrderedDict()
_LEVELS_KEPT = 2
_levels: OrderedDict[str, Any] = OrderedDict()


def content_hash(*parts: object) -> str:
    """Hex digest (32 digits) of arrays, texts and numbers; arrays enter with type, shape and bytes."""
    digest = hashlib.blake2b(digest_size=16)
    for part in parts:
        if isinstance(part, np.ndarray):
            digest.update(f"{part.dtype.str}{part.shape}".encode())
            digest.update(np.ascontiguousarray(part).tobytes())
        else:
            digest.update(repr(part).encode())
        digest.update(b"\0")
    return digest.hexdigest()


def skin(key: str, make: Callable[[], T]) -> T:
    """The prepared skin of `key`, made by `make()` when it is not kept; a few are kept."""
    return _kept(_skins, _SKINS_KEPT, key, make)


def product(key: str, make: Callable[[], T]) -> T:
    """The prepared product of `key`, made by `make()` when it is not kept; a few are kept."""
    return _kept(_products, _PRODUCTS_KEPT, key, make)


def level(key: str, make: Callable[[], T]) -> T:
    """The map of a Subdivision level of `key`, made by `make()` when it is not kept; a few are kept."""
    return _kept(_levels, _LEVELS_KEPT, key, make)


def _kept(where: OrderedDict[str, Any], most: int, key: str, make: Callable[[], T]) -> T:
    if key not in where:
        where[key] = make()
        while len(where) > most:
            where.popitem(last=False)
    where.move_to_end(key)
    kept: T = where[key]
    return kept


def recording(key: str, make: Callable[[], T]) -> T:
    """What the measurement file of `key` holds, read by `make()` when it is not kept; a few are kept."""
    if key not in _recordings:
        _recordings[key] = make()
        while len(_recordings) > _RECORDINGS_KEPT:
            _recordings.popitem(last=False)
    _recordings.move_to_end(key)
    kept: T = _recordings[key]
    return kept


def clear() -> None:
    """Drop everything."""
    _skins.clear()
    _products.clear()
    _recordings.clear()
    _levels.clear()
