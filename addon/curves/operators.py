"""The operator that shows a frame of a bake or a recording."""

import bpy

from .. import languages
from ..operators import polling, running
from ..recordings import settings as recordings
from . import tables


def _nothing(context):
    is_there = any(tables.of(context, source) is not None for source in (tables.BAKE, tables.RECORDING))
    return "" if is_there else "there are no frames to show; bake frames or load a recording of several frames first"


class THENAR_OT_show_frame(bpy.types.Operator):
    """Show this frame of the bake or of the recording"""

    bl_idname = "thenar.show_frame"
    bl_label = "Show Frame"
    bl_options = {"REGISTER", "UNDO_GROUPED"}

    source: bpy.props.EnumProperty(
        name="Of",
        description="What the frame belongs to",
        items=(
            (tables.BAKE, "Bake", "The bake that plays; the timeline goes to the frame"),
            (tables.RECORDING, "Recording", "The recording that is selected in the list"),
        ),
    )
    frame: bpy.props.IntProperty(name="Frame", description="Number of the frame")

    @classmethod
    def description(cls, context, properties):
        """The numbers of the frame as the tooltip."""
        table = tables.of(context, properties.source)
        if table is None:
            return languages.tip("Show this frame of the bake or of the recording")
        return tables.sentence(table, int(abs(table.frames - properties.frame).argmin()))

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, _nothing(context), polling.busy())

    def execute(self, context):
        if tables.of(context, self.source) is None:
            self.report({"ERROR"}, running.sentence(languages.report(_NONE[self.source])))
            return {"CANCELLED"}
        if self.source == tables.BAKE:
            context.scene.frame_set(self.frame)
        else:
            item = recordings.chosen(context)
            item.frame_rule, item.frame = "NUMBER", min(max(self.frame, 1), item.frames)
        running.redraw(context)
        return {"FINISHED"}


_NONE = {
    tables.BAKE: "no bake of several frames plays; press Bake Frames first",
    tables.RECORDING: "the selected recording has no curve over its frames; load it again",
}


def register():
    """Register the operator."""
    bpy.utils.register_class(THENAR_OT_show_frame)


def unregister():
    """Unregister it again."""
    bpy.utils.unregister_class(THENAR_OT_show_frame)
