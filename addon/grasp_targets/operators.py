"""The button that brings the hand to its target. Registration of all targets, too."""

from functools import partial

import bpy

from .. import workflow
from ..grasp import fitting, words
from ..grasp_fit import fitter
from ..hand import pads
from ..hand.operators import can_pose
from ..languages import report
from ..operators import computing, polling
from ..recordings import comparing, laying
from ..recordings import settings as recordings
from ..scene.checks import Refusal
from . import conduct, explained, parts, reasons, settings, stamp

FREE_MM = 15.0
"""The hand moves no farther, nor turns farther at `task.ARM_MM`: the posture shall be one near the present one."""


class THENAR_OT_reach_target(computing.Computing, bpy.types.Operator):
    """Bend and move the hand a little from where it is until it reaches the target: forces by finger, or what a \
recording read"""

    bl_idname = "thenar.reach_target"
    bl_label = "Reach Target"
    bl_options = {"REGISTER", "UNDO"}
    noun = "Reaching the target"

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_product(context)) and can_pose(cls, context)

    def steps(self, context):
        stored, asked = context.scene.thenar_targets, context.scene.thenar_grasps
        if stored.kind == settings.TOTAL:
            raise Refusal("the target is a total force; press Settle for it, or choose another target")
        free_mm = 0.0 if asked.moves == "FINGERS" else FREE_MM
        if stored.kind == settings.FINGERS:
            wanted = reasons.wanted_of({part: getattr(stored, f"{part}_n") for part in parts.PARTS})
            fit = prepared(context, free_mm)
            found = yield partial(conduct.by_finger, fit, wanted)
        else:
            item = of_mat(context)
            name, seat, frame = item.name, comparing.seat_of(context), (item.frame_rule, item.frame)
            fit = prepared(context, free_mm)
            found = yield partial(conduct.by_recording, fit, seat, (laying.lie_of(item), frame))
        if found.grasp is not None:
            fitting.finish(context, fit, found.grasp, asked.moves)
            asked.shown = -1
        if isinstance(found, conduct.ByFinger):
            settings.keep(context.scene, found.rows, held_of(context, found)[1])
        else:
            named = report("Recording '{name}', frame {frame}.", name=name, frame=found.recorded.frame + 1)
            settings.keep_explained(context.scene, [*explained.lines(found), named])
        stored.stamp = stamp.of(context)
        return found

    def _report(self, context, found):
        fitting.bring_into_view(context)
        if not isinstance(found, conduct.ByFinger):
            level, text = explained.sentence(found)
            self.report({level}, text)
            return {"FINISHED"}
        level, text = reasons.sentence(found.rows)
        held_level, held = held_of(context, found)
        is_good = level == held_level == "INFO"
        self.report({"INFO" if is_good else "WARNING"}, f"{text}. {held}")
        return {"FINISHED"}


def held_of(context, found):
    """Report level and sentence: what the forces of a `conduct.ByFinger` leave over, and whether it would slip out."""
    return words.held(found.state, (found.friction, context.scene.thenar_grasps.friction))


def prepared(context, free_mm):
    """The `fitting.Fit` of the scene's hand from where it is, its place free by `free_mm`. Raises `Refusal`."""
    chosen = context.scene.thenar
    if chosen.use_force:
        raise Refusal(
            "Force Target is on, so Solve would move the product and press with other forces than the ones reached; "
            "switch Force Target off"
        )
    wish = fitter.Wish(pads.FIRM_MM, is_placed=True, free_mm=free_mm)
    fit = fitting.prepare(context, chosen.hand, workflow.product_parts(chosen), wish, 1.0)
    if not fitting.can_search(fit):
        raise Refusal(
            f"'{chosen.hand.name}' is shown with other vertices than it is posed with; switch its Subdivision off, "
            "reach the target, and switch it on again"
        )
    return fit


def of_mat(context):
    """The recording of a mat that is chosen. Raises `Refusal` where none is."""
    item = recordings.chosen(context)
    if item is None:
        raise Refusal("no recording is loaded to be explained; load one under Record, and lay its mat on the product")
    if item.kind != recordings.MAP:
        raise Refusal(f"'{item.name}' is no recording of a mat; choose one of a mat in the list under Record")
    return item


CLASSES = (*settings.CLASSES, THENAR_OT_reach_target)


def register():
    """Register the operator and what a scene keeps of targets."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    settings.register_properties()


def unregister():
    """Unregister them again."""
    settings.unregister_properties()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
