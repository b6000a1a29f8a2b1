"""Reads studies and measurement files into the scene's list of recordings, and picks the frame that is compared."""

from pathlib import Path

import numpy as np

from .. import native
from ..scene.checks import Refusal
from . import settings

_STUDY_FILE = "study.toml"
IMAGES = (".png", ".jpg", ".jpeg", ".tif", ".tiff")
"""Endings of the images that a handprint may be."""
_LOOK_PX = 256.0
"""Side of a cell at a first look, pixels: the longest image that is read has few of them."""


def load(context, path):
    """Add what `path` holds to the list: a study (its folder or study.toml), every mat of a file, or a handprint.

    Returns the names added. Raises `Refusal` and the native module's errors.
    """
    problem = native.problem()
    if problem:
        raise Refusal(problem)
    place = Path(path)
    if place.name == _STUDY_FILE:
        place = place.parent
    of_file = _print if place.suffix.lower() in IMAGES else _maps
    found = _study(place) if place.is_dir() else of_file(place)
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
    read = native.module.read_recording(file)
    if not read.maps:
        raise Refusal(
            f"'{file.name}' holds {len(read.curves)} indentations and no pressure map; "
            "press New Study from Files to say what they were taken from"
        )
    rows = []
    for found in read.maps:
        frames = len(values_of(found))
        about = f"{read.format}: {frames} frames of {len(found.row)} sensels, {found.unit}"
        name = f"{file.name}, {found.name}" if found.name else file.name
        rows.append(
            {"name": name, "kind": settings.MAP, "path": str(file), "mat": found.name, "about": about, "frames": frames}
        )
    return rows


def _print(file):
    """An image is read once, in cells of many pixels, to refuse what is no print. Its scale is the user's to give."""
    width, height = native.module.Print.read(file, mm_per_px=1.0, cell_mm=_LOOK_PX).size_px
    about = f"handprint of {width} x {height} pixels; its size goes by the dpi of its scan"
    return [{"name": file.name, "kind": settings.PRINT, "path": str(file), "about": about}]


def values_of(found):
    """The frames (frames, sensels) of a map: kPa, or counts."""
    return np.asarray(found.counts if found.pressure_kpa is None else found.pressure_kpa)


def frame_number(found, rule, number):
    """Which frame of a map is compared. Raises `Refusal` for a number that is not there, or an empty map."""
    values = values_of(found)
    if rule == "NUMBER":
        if number > len(values):
            raise Refusal(f"there is no frame {number}; the recording has {len(values)}")
        return number - 1
    areas = np.nan_to_num(np.asarray(found.area_mm2), nan=1.0)
    force = np.nansum(values * areas, axis=1)
    if not (force > 0.0).any():
        raise Refusal("no frame of the recording reads anything; load another")
    wanted = force[force > 0.0].mean() if rule == "MEAN" else force.max()
    return int(np.abs(np.where(force > 0.0, force, np.inf) - wanted).argmin())
