"""The operator that bakes a range of frames."""

import bpy

from .. import baking, status
from . import display, running, solve


class THENAR_OT_bake(bpy.types.Operator):
    """Press every frame of a range and keep shape and pressure beside the file, to be played and rendered"""

    bl_idname = "thenar.bake"
    bl_label = "Bake Frames"
    bl_options = {"REGISTER", "UNDO"}

    frame_start: bpy.props.IntProperty(name="Start", description="First frame of the bake", default=1)
    frame_end: bpy.props.IntProperty(name="End", description="Last frame of the bake", default=1)

    @classmethod
    def poll(cls, context):
        return solve.poll(cls, context)

    def execute(self, context):
        bake = running.attempt(self, baking.run, context, self.frame_start, self.frame_end)
        return self._report(context, bake)

    def invoke(self, context, event):
        if bpy.app.background or context.window is None:
            return self.execute(context)
        self._bake = running.attempt(self, baking.begin, context, self.frame_start, self.frame_end)
        if self._bake is None:
            return {"CANCELLED"}
        self._worker = None
        self._timer = running.begin(context, self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS":
            self.cancel(context)
            self.report({"WARNING"}, "Bake cancelled; nothing was written")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"} if running.is_navigation(event) else {"RUNNING_MODAL"}
        self._show(context)
        if self._worker is not None and not self._worker.is_done():
            return {"RUNNING_MODAL"}
        bake = running.attempt(self, self._step, context)
        if bake is not None and not bake.is_complete:
            return {"RUNNING_MODAL"}
        if bake is not None:
            bake = running.attempt(self, self._publish, context)
        running.end(context, self._timer)
        baking.leave(context, self._bake)
        return self._report(context, bake)

    def cancel(self, context):
        if self._worker is not None:
            self._worker.stop()
        running.end(context, self._timer)
        baking.leave(context, self._bake)

    def _step(self, context):
        if self._worker is not None:
            if self._worker.error is not None:
                raise self._worker.error
            baking.keep_frame(self._bake, self._job, self._worker.contact)
            self._worker = None
        if not self._bake.is_complete:
            self._job = baking.read_frame(context, self._bake)
            self._worker = running.Worker(self._job)
        return self._bake

    def _publish(self, context):
        baking.publish(context, self._bake)
        return self._bake

    def _show(self, context):
        bake = self._bake
        status.run.stage = f"frame {bake.frame} of {bake.last}"
        status.run.fraction = len(bake.done) / (bake.last - bake.first + 1)
        running.show(context)

    def _report(self, context, bake):
        if bake is None:
            return {"CANCELLED"}
        display.refresh(context)
        peak = max(frame["peak_kpa"] for frame in bake.done)
        count = len(bake.done)
        self.report({"INFO"}, f"Baked {count} frame{'s' if count > 1 else ''}; highest peak {peak:.0f} kPa")
        return {"FINISHED"}


CLASSES = (THENAR_OT_bake,)
