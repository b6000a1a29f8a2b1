"""The operator that makes the hand's mesh finer where the product is finer than its skin."""

import bpy

from .. import languages
from ..operators import computing, polling, running
from . import conduct


class THENAR_OT_refine_skin(computing.Computing, bpy.types.Operator):
    """Subdivide the hand's mesh where the product is finer than the skin; the shape at rest stays"""

    bl_idname = "thenar.refine_skin"
    bl_label = "Refine Skin"
    bl_options = {"REGISTER", "UNDO"}
    noun = "Refine Skin"

    spacing_mm: bpy.props.FloatProperty(
        name="Spacing (mm)",
        description="Longest edge of the skin wherever the product is close, mm, 0.5 at least; "
        "0 halves the spacing, only where the product is finer than the skin",
        min=0.0,
        soft_max=5.0,
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context):
        return polling.can_compute(cls, context) and polling.allows(cls, polling.wrong_mode(context))

    def steps(self, context):
        """The refinement."""
        return conduct.steps(context, self.spacing_mm)

    def _report(self, context, refined):
        (before, after), (coarse, fine) = refined.vertices, refined.spacing_mm
        text = languages.report(
            "Refined '{hand}' at '{product}': {before:,} to {after:,} vertices, spacing there {coarse:.2f} to "
            "{fine:.2f} mm; press Solve",
            hand=refined.hand_name,
            product=", ".join(refined.part_names),
            before=before,
            after=after,
            coarse=coarse,
            fine=fine,
        )
        self.report({"INFO"}, text)
        if bpy.ops.thenar.look_back.poll():
            bpy.ops.thenar.look_back()  # it shows what was solved before
        running.redraw(context)
        return {"FINISHED"}


CLASSES = (THENAR_OT_refine_skin,)
