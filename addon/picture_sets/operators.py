"""Operators of pictures: make one in a process of its own, open the last one."""

from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty

from .. import languages, status
from ..operators import computing, polling
from ..panels import preferences
from ..scene.checks import Refusal
from . import order as orders
from . import process

_made = []
"""The files of the last picture; the scene keeps nothing of it."""


class THENAR_OT_picture(computing.Computing, bpy.types.Operator):
    """Make a picture of the result in a process of its own; scene, camera and render settings stay as they are"""

    bl_idname = "thenar.picture"
    bl_label = "Make Picture"
    bl_options = {"REGISTER"}
    noun = "Picture"

    kind: EnumProperty(name="Picture", description="What is made", items=orders.KINDS)
    filepath: StringProperty(
        name="File", description="Where to; empty: a new name in the folder under Pictures", subtype="FILE_PATH"
    )
    height: IntProperty(
        name="Height (pixels)", description="0: as set under Pictures", min=0, max=orders.MOST, default=0
    )
    samples: IntProperty(
        name="Samples", description="Rays per pixel; what is left of noise is removed", min=1, default=orders.SAMPLES
    )
    rate: IntProperty(name="Rate", description="Frames a second of a Turntable", min=1, max=60, default=24)
    frames: IntProperty(
        name="Frames", description="Most frames of a Live Film; 0: as set under Pictures", min=0, max=2000, default=0
    )
    overwrite: BoolProperty(name="Overwrite", description="Replace the file if it exists", default=False)

    @classmethod
    def description(cls, context, properties):
        """The picture's own description as the tooltip."""
        return languages.tip(next(row[2] for row in orders.KINDS if row[0] == properties.kind))

    @classmethod
    def poll(cls, context):
        problems = (
            status.native_problem,
            orders.no_text(),
            polling.no_hand(context),
            no_result(context),
            polling.busy(),
        )
        return polling.allows(cls, *problems, polling.live(context), polling.wrong_mode(context))

    def invoke(self, context, event):
        """From a button, the preferences name the folder where the scene names none."""
        preferences.fill(context, context.scene.thenar_pictures, {"folder": "folder"})
        return super().invoke(context, event)

    def steps(self, context):
        chosen = context.scene.thenar_pictures
        order = orders.Order(
            self.kind,
            self.filepath and bpy.path.abspath(self.filepath),
            self.height or chosen.height,
            self.samples,
            with_percentiles=chosen.with_percentiles,
            rate=self.rate,
            frames=self.frames or chosen.film_frames,
        )
        if not order.target:
            order.target = str(orders.free_path(_folder(chosen), self.kind, context.scene.thenar.result.product_name))
        if not self.overwrite:
            orders.refuse_to_overwrite(order)
        return (yield from process.steps(context, order))

    def _report(self, context, paths):
        _made[:] = paths
        files = ", ".join(path.name for path in paths)
        self.report({"INFO"}, languages.report("Wrote {files} in {folder}", files=files, folder=paths[0].parent))
        return {"FINISHED"}


class THENAR_OT_open_picture(bpy.types.Operator):
    """Open the picture that was made last with the system's viewer"""

    bl_idname = "thenar.open_picture"
    bl_label = "Open Picture"

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, "" if last_made() else "no picture was made yet")

    def execute(self, context):
        bpy.ops.wm.path_open(filepath=str(last_made()))
        return {"FINISHED"}


def last_made():
    """The first file of the last picture that is still there; None if there is none."""
    return next((path for path in _made if path.exists()), None)


def no_result(context):
    """The scene keeps no result."""
    return "" if context.scene.thenar.result.is_valid else "there is no result to show; press Solve first"


def has_folder(chosen):
    """Whether pictures have a folder: one next to a file that was never saved is none."""
    return bool(bpy.data.filepath) or not chosen.folder.startswith("//")


def _folder(chosen):
    """The folder of pictures. Raises `Refusal` where the file was never saved and the folder is named after it."""
    if not has_folder(chosen):
        raise Refusal("the file was never saved, so there is no folder for pictures; save it, or choose a Folder")
    return Path(bpy.path.abspath(chosen.folder))


CLASSES = (THENAR_OT_picture, THENAR_OT_open_picture)
