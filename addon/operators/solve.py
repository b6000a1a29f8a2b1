"""The operators that press the hand against the product, and that show where that failed."""

import bpy

from .. import languages, tabs, workflow
from ..languages import sentences
from ..panels import preferences
from ..results import grades
from ..scene import regions
from . import computing, display, polling, running, selecting


class THENAR_OT_solve(computing.Computing, bpy.types.Operator):
    """Press the hand against the product: shape, pressure and forces of the skin"""

    bl_idname = "thenar.solve"
    bl_label = "Solve Contact"
    bl_options = {"REGISTER", "UNDO"}
    noun = "Solve"

    show_map: bpy.props.BoolProperty(
        name="Show Map",
        description="Show the pressure after the solve; the button takes this from the preferences",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context):
        return polling.can_compute(cls, context)

    def invoke(self, context, event):
        """From a button, the preferences say whether the map comes on."""
        if not self.properties.is_property_set("show_map"):
            self.show_map = preferences.get(context, "map_after_solve", True)
        if not context.scene.thenar.result.is_valid:
            preferences.fill(context, context.scene.thenar, {"palette": "palette", "range_kpa": "range_kpa"})
        return super().invoke(context, event)

    def steps(self, context):
        forget_refusal(context)
        return workflow.steps(context)

    def refused(self, error):
        """Keep why there is no result, and select where the skin does not fit; the scene is as before otherwise."""
        vertices = getattr(error, "vertices", ())
        hand, refusal = bpy.context.scene.thenar.hand, bpy.context.scene.thenar.refusal
        if not vertices or hand is None:
            return
        refusal.text = running.sentence(error)
        refusal.vertices = ",".join(map(str, vertices))
        if hand.mode == "OBJECT":
            regions.select_only(hand.data, vertices)
        running.redraw(bpy.context)

    def _report(self, context, result):
        """The last message is the one that is seen: the gravest."""
        if self.show_map:
            tabs.open_tab(context, tabs.RESULT)
        if self.show_map and not context.scene.thenar.hand.thenar.shows_pressure:
            display.show(context)
            if bpy.ops.thenar.look.poll():
                bpy.ops.thenar.look(kind="GLASS")
        else:
            display.refresh(context)
        for text in result.warnings:
            self.report({"WARNING"}, running.sentence(sentences.shown(text.name)))
        numbers = languages.report(
            "{force_n:.1f} N on {area_cm2:.1f} cm², peak {peak_kpa:.0f} kPa, mean {mean_kpa:.0f} kPa",
            force_n=result.force_n,
            area_cm2=result.area_mm2 / 100,
            peak_kpa=result.peak_kpa,
            mean_kpa=result.mean_kpa,
        )
        if result.grade == grades.GOOD:
            self.report({"INFO"}, numbers)
        else:
            grade = languages.report(grades.title(result.grade))
            reason = sentences.shown(result.reason)
            self.report({"WARNING"}, f"{grade}: {reason} ({numbers})")
        return {"FINISHED"}


class THENAR_OT_show_place(bpy.types.Operator):
    """Select the vertices at which the press failed, or that the grade is about"""

    bl_idname = "thenar.show_place"
    bl_label = "Show Location"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        settings = context.scene.thenar
        return settings.hand is not None and bool(_place(settings))

    def execute(self, context):
        settings = context.scene.thenar
        selecting.select(context, settings.hand, _place(settings))
        return {"FINISHED"}


class THENAR_OT_grasp_lighter(bpy.types.Operator):
    """Fit a lighter grasp and solve again"""

    bl_idname = "thenar.grasp_lighter"
    bl_label = "Lighter Grasp and Solve"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return polling.can_compute(cls, context) and bpy.ops.thenar.fit_grasp.poll()

    def execute(self, context):
        try:
            bpy.ops.thenar.fit_grasp(strength="LIGHT", place="KEEP")
            bpy.ops.thenar.solve()
        except RuntimeError as error:  # what those operators report
            self.report({"ERROR"}, languages.reported(error))
            return {"CANCELLED"}
        return {"FINISHED"}


def forget_refusal(context):
    """No press has failed."""
    refusal = context.scene.thenar.refusal
    refusal.text = refusal.vertices = ""


def _place(settings):
    """The vertices to look at: of the last failure, else of the result's reason."""
    failed, count = settings.refusal.vertices, 0
    if settings.hand is not None and settings.hand.type == "MESH":
        count = len(settings.hand.data.vertices)
    vertices = [int(each) for each in failed.split(",")] if failed else [settings.result.reason_vertex]
    return [vertex for vertex in vertices if 0 <= vertex < count]


CLASSES = (THENAR_OT_solve, THENAR_OT_show_place, THENAR_OT_grasp_lighter)
