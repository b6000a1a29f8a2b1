"""Reads studies and measurement files into the scene's list of recordings."""

from pathlib import Path

from .. import native
from ..scene.checks import Refusal
from . import frames, over_time, settings

_STUDY_FILE = "study.toml"
IMAGES = (".png", ".jpg", ".jpeg", ".tif", ".tiff")
"""Endings of the images that a handprint may be."""
_LOOK_PX = 256.0
"""Side of a cell at a first look, pixels: the longest image that is read has few of them."""


def load(context, path):
    """Add what `path` holds to the list. Returns the names added. Raises as `read`."""
    return add(context, read(path))


def read(path, cancel=None, progress=None):
    """What `path` holds: a study (its folder or study.toml), every mat of a file, or a handprint. No Blender in it.

    Returns the properties of each recording. Raises `Refusal` and the native module's errors.
    """
    problem = native.problem()
    if problem:
        raise Refusal(problem)
    place = Path(path)
    if place.name == _STUDY_FILE:
        place = place.parent
    of_file = _print if place.suffix.lower() in IMAGES else _maps
    return _study(place) if place.is_dir() else of_file(place)


def add(context, found):
    """Add what `read` returned to the list, and choose the last. Returns the names added."""
    state, added = context.scene.thenar_recordings, []
    for values in found:
        item = state.items.add()
        for name, value in values.items():
            setattr(item, name, value)
        added.append(item.name)
    state.index = len(state.items) - 1
    return added


def _study(folder):
    study = native.module.Study.load(folder)
    count = len(study.recordings)
    about = f"study of {count} recording{'' if count == 1 else 's'}"
    return [{"name": study.title or folder.name, "kind": settings.STUDY, "path": str(folder), "about": about}]


def _maps(file):
    read = frames.read(file)
    if not read.maps:
        raise Refusal(
            f"'{file.name}' holds {len(read.curves)} indentations and no pressure map; "
            "press New Study from Files to say what they were taken from"
        )
    rows = []
    for found in read.maps:
        count = len(frames.values_of(found))
        about = f"{read.format}: {count} frames of {len(found.row)} sensels, {found.unit}"
        name = f"{file.name}, {found.name}" if found.name else file.name
        curves = over_time.kept(frames.values_of(found), found.area_mm2, found.pressure_kpa is not None)
        about_file = {"kind": settings.MAP, "path": str(file), "mat": found.name}
        rows.append({"name": name, **about_file, "about": about, "frames": count, "curves": curves})
    return rows


def _print(file):
    """An image is read once, in cells of many pixels, to refuse what is no print. Its scale is the user's to give."""
    width, height = native.module.Print.read(file, mm_per_px=1.0, cell_mm=_LOOK_PX).size_px
    about = f"handprint of {width} x {height} pixels; its size goes by the dpi of its scan"
    return [{"name": file.name, "kind": settings.PRINT, "path": str(file), "about": about}]
