"""What the files of recordings hold, kept while they do not change, and the frame that the timeline stands on."""

import os

import bpy
import numpy as np
from bpy.app.handlers import persistent

from .. import cache, native
from ..scene.checks import Refusal
from . import laying, settings

_BY_RULE = "frame_by_rule"
"""Entry that is added to a map's record: the frames that its rules choose."""


def read(path):
    """The library's record of a measurement file; read once, and again when the file was changed.

    Raises `RecordingError` if it cannot be read.
    """
    try:
        about = os.stat(path)
    except OSError:
        return native.module.read_recording(path)
    key = cache.content_hash(str(path), about.st_mtime_ns, about.st_size)
    return cache.recording(key, lambda: native.module.read_recording(path))


def map_of(path, mat):
    """One mat of a file. Raises `Refusal` if the file holds it no more, `RecordingError`."""
    found = next((found for found in read(path).maps if found.name == mat), None)
    if found is None:
        raise Refusal(f"'{path}' holds no mat '{mat}' any more; load it again")
    return found


def values_of(found):
    """The frames (frames, sensels) of a map: kPa, or counts."""
    return np.asarray(found.counts if found.pressure_kpa is None else found.pressure_kpa)


def number_of(found, rule, number):
    """Which frame of a map is meant, from 0. Raises `Refusal` for a number that is not there, or an empty map."""
    values = values_of(found)
    if rule == "NUMBER":
        if number > len(values):
            raise Refusal(f"there is no frame {number}; the recording has {len(values)}")
        return number - 1
    if _BY_RULE not in found:
        found[_BY_RULE] = _by_rule(values, np.nan_to_num(np.asarray(found.area_mm2), nan=1.0))
    if found[_BY_RULE] is None:
        raise Refusal("no frame of the recording reads anything; load another")
    return found[_BY_RULE][rule]


def _by_rule(values, areas):
    """Rule -> frame that it chooses, from 0; None where no frame reads anything."""
    force = np.nansum(values * areas, axis=1)
    if not (force > 0.0).any():
        return None
    wanted = {"MEAN": force[force > 0.0].mean(), "LARGEST": force.max()}
    return {rule: int(np.abs(np.where(force > 0.0, force, np.inf) - each).argmin()) for rule, each in wanted.items()}


def shown(item):
    """What every cell of a recording reads in its chosen frame, and the frame's number from 0.

    Pressure, kPa, or counts; of a print the inked share. Raises as `map_of` and `number_of`.
    """
    look = laying.look_of(item)
    if look is not None:
        return np.asarray(look.read(item.path).inked), 0
    found = map_of(item.path, item.mat)
    number = number_of(found, item.frame_rule, item.frame)
    return values_of(found)[number], number


def settle(context):
    """Let the number of a frame that a rule chooses be seen, where the recording can still be read."""
    item = settings.chosen(context) if context is not None and context.scene is not None else None
    if item is None or item.kind != settings.MAP or item.frame_rule == "NUMBER":
        return
    try:
        number = number_of(map_of(item.path, item.mat), item.frame_rule, item.frame) + 1
    except (Refusal, *native.error_types()):
        return  # what asks for the frame says so
    if item.frame != number:
        item.frame = number


def follow(scene):
    """Bring the frame of the scene's chosen recording to the scene's own, where it follows the timeline."""
    state = getattr(scene, "thenar_recordings", None)
    item = settings.chosen_of(state) if state is not None else None
    if item is None or not item.follows_timeline or item.frames < 1:
        return
    frame = min(max(scene.frame_current - scene.frame_start + 1, 1), item.frames)
    if item.frame_rule != "NUMBER" or item.frame != frame:
        item.frame_rule, item.frame = "NUMBER", frame


@persistent
def _frame_changed(scene, depsgraph=None):
    follow(scene)


def register():
    """Watch the timeline, and the rule that chooses the frame."""
    settings.framed.append(settle)
    bpy.app.handlers.frame_change_post.append(_frame_changed)


def unregister():
    """Watch them no more."""
    settings.framed.remove(settle)
    bpy.app.handlers.frame_change_post.remove(_frame_changed)
