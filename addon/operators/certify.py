"""The operator that solves the contact once more, with the tissue as a solid."""

import bpy

from .. import languages
from ..languages import sentences
from ..reference import certify
from . import computing, display, polling


class THENAR_OT_certify(computing.Computing, bpy.types.Operator):
    """Solve the same contact with the tissue as a solid between skin and bone, and compare it with the fast result"""

    bl_idname = "thenar.certify"
    bl_label = "Certify"
    bl_options = {"REGISTER", "UNDO"}
    noun = "Certify"

    @classmethod
    def poll(cls, context):
        has_result = context.scene.thenar.result.is_valid
        return polling.can_compute(cls, context) and polling.allows(cls, "" if has_result else "press Solve first")

    def steps(self, context):
        return certify.steps(context)

    def _report(self, context, result):
        display.refresh(context)
        reference = result.reference
        numbers = languages.report(
            "reference {solid_n:.1f} N on {solid_cm2:.1f} cm², fast {fast_n:.1f} N on {fast_cm2:.1f} cm²",
            solid_n=reference.force_n,
            solid_cm2=reference.area_mm2 / 100,
            fast_n=result.force_n,
            fast_cm2=result.area_mm2 / 100,
        )
        if reference.note:
            self.report({"WARNING"}, f"{sentences.shown(reference.note)} ({numbers})")
        else:
            self.report({"INFO"}, numbers)
        return {"FINISHED"}


CLASSES = (THENAR_OT_certify,)
