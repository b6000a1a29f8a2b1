"""Operators of the diagnosis: diagnose, show a finding on the hand, switch it on."""

import bpy

from ..operators import computing, polling, running, selecting
from ..recordings import settings as recordings
from . import applying, diagnosing, showing


def _no_study(context):
    item = recordings.chosen(context)
    if item is None:
        return "no study is loaded; load its folder under Recordings first"
    return "" if item.kind == recordings.STUDY else "a mat alone cannot be diagnosed; select a study under Recordings"


def _no_diagnosis(context):
    state = context.scene.thenar_diagnosis
    return "" if state.is_valid else "nothing was diagnosed yet; press Diagnose first"


class THENAR_OT_diagnose(computing.Computing, bpy.types.Operator):
    """Ask what the simulation leaves out: the study's recordings against the model, its parameters, the instrument \
and every listed effect"""

    bl_idname = "thenar.diagnose"
    bl_label = "Diagnose"
    bl_options = {"REGISTER", "UNDO"}
    noun = "Diagnose"

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_module(), _no_study(context), polling.busy())

    def steps(self, context):
        return diagnosing.steps(context)

    def _report(self, context, found):
        running.redraw(context)
        self.report({"INFO"}, found.get("sentence") or "Diagnosed")
        return {"FINISHED"}


class _OfFinding:
    """An operator on one finding of the diagnosis."""

    bl_options = {"REGISTER", "UNDO"}

    index: bpy.props.IntProperty(name="Finding", description="Number of the finding in the letter, from 0", min=0)

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_module(), _no_diagnosis(context), polling.busy())


class THENAR_OT_apply_finding(_OfFinding, bpy.types.Operator):
    """Enable the effect in the scene with its fitted parameters, and add it to the study's model"""

    bl_idname = "thenar.apply_finding"
    bl_label = "Switch On"

    def execute(self, context):
        selecting.to_object_mode(context)  # undo in Edit Mode knows of the mesh alone
        taken = running.attempt(self, applying.apply, context, self.index)
        if taken is None:
            return {"CANCELLED"}
        if taken.doubt:
            self.report({"WARNING"}, f"{taken.sentence}. {taken.doubt}")
        else:
            self.report({"INFO"}, taken.sentence)
        running.redraw(context)
        return {"FINISHED"}


class THENAR_OT_show_finding(_OfFinding, bpy.types.Operator):
    """Select the skin at the location of this finding, and turn the view to it"""

    bl_idname = "thenar.show_finding"
    bl_label = "Show Location"

    def execute(self, context):
        selecting.to_object_mode(context)
        found = running.attempt(self, showing.vertices, context, self.index)
        if found is None:
            return {"CANCELLED"}
        selecting.select(context, context.scene.thenar.hand, found)
        return {"FINISHED"}


CLASSES = (THENAR_OT_diagnose, THENAR_OT_apply_finding, THENAR_OT_show_finding)
