"""Files that a .blend reads besides itself: libraries, images, caches, Alembic; and digests of files."""

import hashlib
import os
import re
from pathlib import Path

import bpy

_SEQUENCES = {"SEQUENCE", "TILED"}
_BLOCK = 1 << 20


def digest(path, known):
    """Digest of a file's bytes, hexadecimal; empty where it is no file. `known` remembers files by size and time."""
    path = Path(path)
    try:
        if not path.is_file():  # a pipe would be read forever
            return ""
        about = path.stat()
        key = str(path), about.st_size, about.st_mtime_ns
        if key not in known:
            sums = hashlib.blake2b(digest_size=16)
            with path.open("rb") as file:
                while block := file.read(_BLOCK):
                    sums.update(block)
            known[key] = sums.hexdigest()
        return known[key]
    except OSError:
        return ""


def of_open_file(known):
    """{path: digest} of what the open .blend reads besides itself, sorted; a missing file has an empty digest."""
    found = {bpy.path.abspath(path) for path in bpy.utils.blend_paths(absolute=True, packed=False, local=False)}
    found |= {_place(library.filepath, library) for library in bpy.data.libraries}
    for obj in bpy.data.objects:
        found |= set(_of_object(obj))
    for cache in bpy.data.cache_files:
        found |= _numbered(_place(cache.filepath, cache)) if cache.is_sequence else set()
    for image in bpy.data.images:
        found |= _numbered(_place(image.filepath, image)) if image.source in _SEQUENCES else set()
    own = _same(bpy.data.filepath)
    paths = sorted({_same(path) for path in found if path} - {own})
    return {path: digest(path, known) for path in paths}


def are_unchanged(files, known):
    """Whether every file of `{path: digest}` is what it was; also False for what is no such table."""
    if not isinstance(files, dict):
        return False
    return all(digest(path, known) == kept for path, kept in files.items())


def _of_object(obj):
    """Caches that an object's modifiers and its bake read."""
    for modifier in obj.modifiers:
        for name in ("filepath", "cache_directory", "simulation_bake_directory", "bake_directory"):
            place = getattr(modifier, name, "") or getattr(getattr(modifier, "domain_settings", None), name, "")
            if place:
                yield from _all_in(_place(place, obj))
        cache = getattr(modifier, "point_cache", None)
        if cache is not None and cache.use_disk_cache and bpy.data.filepath:
            yield from _all_in(str(Path(bpy.data.filepath).parent / f"blendcache_{Path(bpy.data.filepath).stem}"))
    bake = getattr(getattr(obj, "thenar", None), "bake_path", "")
    if bake:
        yield _place(bake, obj)


def _place(path, owner):
    """The absolute path; of linked data it is relative to its library."""
    return bpy.path.abspath(path, library=getattr(owner, "library", None)) if path else ""


def _all_in(path):
    if not os.path.isdir(path):
        return [path]
    return [os.path.join(folder, name) for folder, _, names in os.walk(path) for name in names]


def _numbered(path):
    """All files of a sequence of numbered ones, or of tiles, of which `path` is one."""
    place = Path(path)
    if not path or not place.parent.is_dir():
        return {path}
    pattern = re.sub(r"<UDIM>|<UVTILE>|\d+(?=\D*$)", "\0", place.name, count=1)
    wanted = re.compile(r"u?\d+(?:_v\d+)?".join(re.escape(part) for part in pattern.split("\0")))
    return {str(each) for each in place.parent.iterdir() if wanted.fullmatch(each.name)} | {path}


def _same(path):
    return os.path.normpath(path)
