"""The operator that solves the contact once more, with the tissue as a solid."""

import bpy

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
        numbers = (
            f"reference {reference.force_n:.1f} N on {reference.area_mm2 / 100:.1f} cm², "
            f"fast {result.force_n:.1f} N on {result.area_mm2 / 100:.1f} cm²"
        )
        if reference.note:
            self.report({"WARNING"}, f"{reference.note} ({numbers})")
        else:
            self.report({"INFO"}, numbers)
        return {"FINISHED"}


CLASSES = (THENAR_OT_certify,)
