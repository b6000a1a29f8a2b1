"""The asset library of poses: a .blend with pose assets in the user's data folder, and its entry in the preferences."""

import json
import os
from pathlib import Path

import bpy
import numpy as np

from ..hand.poses import LABELS
from ..scene.checks import Refusal
from . import actions

NAME = "Thenar Poses"
BLEND = "thenar_poses.blend"
CATALOGS = "blender_assets.cats.txt"
CATALOG_IDS = {
    "right": ("6a1f4d0e-52f7-4c64-9c1b-3f0f6f4d7a01", "Hand Poses/Right"),
    "left": ("6a1f4d0e-52f7-4c64-9c1b-3f0f6f4d7a02", "Hand Poses/Left"),
}
"""Side -> the catalog's number, which stays the same in every version, and its path in the browser."""
PICTURES = Path(__file__).parent / "pictures"
STAMPS = "made_of.json"
"""Pose -> digest of the angles that its picture shows."""


def folder():
    """The library's folder in the user's data."""
    return Path(bpy.utils.user_resource("DATAFILES", path="")) / "thenar" / "poses"


def registered(context):
    """The library's entry in the preferences, or None."""
    home = os.path.normcase(str(folder()))
    entries = context.preferences.filepaths.asset_libraries
    return next((entry for entry in entries if os.path.normcase(os.path.normpath(entry.path)) == home), None)


def add(context):
    """Write the library and enter it in the preferences. Returns the number of poses, and those without a picture.

    Raises `Refusal` where the folder cannot be written or no hand can be made; the open file stays as it was.
    """
    home = folder()
    bare = []
    try:
        home.mkdir(parents=True, exist_ok=True)
        _write_catalogs(home / CATALOGS)
        count = _write_poses(home / BLEND, bare)
    except (OSError, RuntimeError) as error:
        reason = getattr(error, "strerror", None) or " ".join(str(error).split())
        raise Refusal(
            f"the pose library cannot be written to '{home}': {reason}; free that folder for writing"
        ) from None
    if registered(context) is None:
        context.preferences.filepaths.asset_libraries.new(name=NAME, directory=str(home))
        context.preferences.is_dirty = True
    return count, bare


def _write_poses(path, bare):
    """All poses of both sides as assets of one .blend, written whole or not at all."""
    made = []
    try:
        for side in actions.SIDES:
            for name, angles in actions.turns(side).items():
                made.append(_asset(name, side, angles))
                if made[-1].preview is None and LABELS[name] not in bare:
                    bare.append(LABELS[name])
        partial = path.with_name(f".{path.stem}.partial.blend")
        try:
            bpy.data.libraries.write(str(partial), set(made), fake_user=True, compress=True)
            os.replace(partial, path)
        finally:
            partial.unlink(missing_ok=True)
        return len(made)
    finally:
        for action in made:
            bpy.data.actions.remove(action)


def _asset(name, side, angles):
    """The pose asset of one side, with its picture."""
    action = actions.add(f"{LABELS[name]} ({side})", angles)
    action.asset_mark()
    data = action.asset_data
    data.catalog_id, data.author = CATALOG_IDS[side][0], "Thenar"
    data.description = f"{LABELS[name]}: pose of a {side} hand that Thenar made"
    for tag in ("hand", side):
        data.tags.new(tag)
    pixels = picture(name, side)
    if pixels is not None:
        preview = action.preview_ensure()
        preview.image_size = pixels.shape[1::-1]
        preview.image_pixels_float.foreach_set(np.ascontiguousarray(pixels, np.float32).ravel())
    return action


def picture(name, side):
    """The picture (h, w, 4) of a pose, rows from below; None where none is shipped of the pose as it is now.

    A left hand's is the mirror image.
    """
    path = PICTURES / f"{name}.png"
    if stamps().get(name) != actions.digest(name) or not path.is_file():
        return None
    image = bpy.data.images.load(str(path), check_existing=False)
    try:
        flat = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(flat)
        pixels = flat.reshape(image.size[1], image.size[0], 4)
    finally:
        bpy.data.images.remove(image)
    return pixels if side == "right" else pixels[:, ::-1]


def stamps():
    """Pose -> digest of the angles that its shipped picture shows."""
    file = PICTURES / STAMPS
    return json.loads(file.read_text("utf-8")) if file.is_file() else {}


def _write_catalogs(path):
    """The catalogs of the library; lines that the user added stay."""
    lines = path.read_text("utf-8").splitlines() if path.is_file() else ["VERSION 1", ""]
    for number, place in CATALOG_IDS.values():
        if not any(line.startswith(number) for line in lines):
            lines.append(f"{number}:{place}:{place.replace('/', '-')}")
    path.write_text("\n".join(lines) + "\n", "utf-8")
