"""Operators of the grasp: find one, settle it, take another one, add a sample."""

from functools import partial

import bpy
from bpy.props import EnumProperty, FloatProperty, IntProperty

from .. import languages, tabs, workflow
from ..grasp_fit import fitter
from ..hand import pads
from ..hand.operators import can_make, can_pose
from ..operators import computing, polling, running
from ..scene.checks import Refusal
from . import fitting, samples, ways, words
from .settings import MOVES

STRENGTHS = (
    ("LIGHT", "Light", "60 N in sum over the skin, as in a loose hold"),
    ("FIRM", "Firm", "200 N in sum over the skin, a power grasp below the strongest one"),
    ("CUSTOM", "Custom Depths", "Depths entered below; the forces follow from them"),
)
PLACES = (
    ("LAY", "Search", "Ways to hold the product are tried; where hand and product stand does not count"),
    ("KEEP", "Current Pose", "The fit starts from the current pose and place of hand and product"),
)
ENDS = (
    ("AUTO", "Automatic", "Whichever end of the handle scores better", 0),
    ("FIRST", "One End", "The thumb at one end of the handle", 1),
    ("SECOND", "Other End", "The thumb at the other end of the handle", 2),
)
KINDS = (
    ("AUTO", "Automatic", "A power grip; a pinch where no power grip holds"),
    ("POWER", "Power", "The hand closes around a part of the product"),
    ("PINCH", "Pinch", "Thumb and fingertips from two sides: 30 N in sum if firm, 9 N if light"),
    ("LATERAL", "Lateral", "Thumb against the side of the index finger, as a key is held: forces as of a pinch"),
    (
        "HOOK",
        "Hook",
        "The product hangs in four bent fingers, without thumb and palm: a weight of 100 N if firm, 30 N if light",
    ),
)
END_OF = {"AUTO": 0, "FIRST": 1, "SECOND": -1}
DIGITS = (
    ("thumb", "Thumb", "", 1),
    ("index", "Index", "", 2),
    ("middle", "Middle", "", 4),
    ("ring", "Ring", "", 8),
    ("little", "Little", "", 16),
    ("palm", "Palm", "", 32),
)


def _depth(kind):
    return FloatProperty(
        name=f"{kind.capitalize()} (mm)",
        description=f"Depth of the {kind} pads in the product, mm; 0 leaves them out of the fit",
        min=0.0,
        soft_max=8.0,
        default=pads.FIRM_MM[kind],
    )


class THENAR_OT_fit_grasp(computing.Computing, bpy.types.Operator):
    """Find how the hand holds the product: several ways are tried, the forces balanced, and the best one is taken"""

    bl_idname = "thenar.fit_grasp"
    bl_label = "Fit Grasp"
    bl_options = {"REGISTER", "UNDO"}
    noun = "Fit"

    strength: EnumProperty(
        name="Strength",
        description="How deep the pads press into the product",
        items=STRENGTHS,
        default="FIRM",
        translation_context=languages.FORCE,
    )
    distal_mm: _depth("distal")
    middle_mm: _depth("middle")
    proximal_mm: _depth("proximal")
    palm_mm: _depth("palm")
    place: EnumProperty(
        name="Start", description="Where hand and product are when the fit begins", items=PLACES, default="LAY"
    )
    moves: EnumProperty(
        name="Moves",
        description="What is moved to the other: hand, arm or product",
        items=MOVES,
        default="AUTO",
        options={"SKIP_SAVE"},
    )
    digits: EnumProperty(
        name="Digits",
        description="Digits that touch the product",
        items=DIGITS,
        options={"ENUM_FLAG"},
        default={digit[0] for digit in DIGITS},
    )
    force_n: FloatProperty(
        name="Force (N)",
        description="Sum of forces that the skin shall carry, in a hook the weight, N; 0 for the strength's own",
        min=0.0,
    )
    kind: EnumProperty(name="Kind", description="How the hand holds the product", items=KINDS)
    end: EnumProperty(name="Thumb At", description="Which end of the handle the thumb is at", items=ENDS)

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_product(context)) and can_pose(cls, context)

    def invoke(self, context, event):
        if not self.properties.is_property_set("moves"):
            self.moves = context.scene.thenar_grasps.moves
        return super().invoke(context, event)

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        for name in ("strength", "place", "moves"):
            layout.prop(self, name)
        if self._is_searched():
            layout.prop(self, "kind")
            if self.kind not in (ways.PINCH, ways.LATERAL):
                layout.prop(self, "end")
        if self.strength == "CUSTOM":
            for name in ("distal_mm", "middle_mm", "proximal_mm", "palm_mm"):
                layout.prop(self, name)
        layout.column(align=True).prop(self, "digits")
        layout.prop(self, "force_n")

    def steps(self, context):
        settings = context.scene.thenar
        parts = workflow.product_parts(settings)
        wish = fitting.wish_of(self._wish(), self.kind if self._is_searched() else "AUTO")
        fit = fitting.prepare(context, settings.hand, parts, wish, self.force_n or None)
        moves = fitting.moves_of(context, settings.hand, parts, self.moves)
        if fitting.is_searched(wish) and fitting.can_search(fit):
            asked = fitting.asked_of(self.strength, self.force_n, END_OF[self.end], self.kind)
            found = yield partial(fitting.search_all, fit, asked)
            fitting.finish(context, fit, found[0].grasp, moves)
            fitting.keep(context, fit, found)
            return found
        found = yield partial(fitting.compute, fit)
        fitting.finish(context, fit, found, moves)
        return found

    def _is_searched(self):
        """Whether the place is searched, so that kind and end are asked for."""
        return self.place == "LAY" and self.moves != "FINGERS"

    def _wish(self):
        depths = {"LIGHT": pads.LIGHT_MM, "FIRM": pads.FIRM_MM}.get(self.strength)
        if depths is None:
            depths = {kind: getattr(self, f"{kind}_mm") for kind in pads.FIRM_MM}
        depths = {kind: depth for kind, depth in depths.items() if depth > 0.0}
        if not depths or not self.digits:
            raise Refusal("no pad takes part in the fit; give one a depth, and tick a digit or the palm")
        free_mm = 0.0 if self.moves == "FINGERS" else 40.0
        placed = self.place == "KEEP" or self.moves == "FINGERS"
        digits = None if len(self.digits) == len(DIGITS) else tuple(sorted(self.digits))
        return fitter.Wish(depths, digits, placed, free_mm)

    def _report(self, context, found):
        fitting.bring_into_view(context)
        if isinstance(found, list):
            return self._report_best(context, found)
        for text in found.warnings:
            self.report({"WARNING"}, running.sentence(text))
        misses = [abs(found.depths_mm[name] - want) for name, want in found.targets_mm.items()]
        force = f", {found.force_n:.0f} N" if found.force_n is not None else ""
        words = "{pads} pads within {most:.1f} mm of their depth (mean {mean:.1f} mm){force}, {seconds:.1f} s"
        text = languages.report(
            words,
            pads=len(misses),
            most=max(misses),
            mean=sum(misses) / len(misses),
            force=force,
            seconds=found.seconds,
        )
        self.report({"INFO"}, text)
        return {"FINISHED"}

    def _report_best(self, context, found):
        best = found[0]
        for text in best.grasp.warnings:
            self.report({"WARNING"}, running.sentence(text))
        level, text = words.held(best.state, (best.friction, context.scene.thenar_grasps.friction), best.asked_n)
        said = "{held}; the best of {ways} ways to hold it, {seconds:.1f} s"
        said = "{held}; 1 way to hold it, {seconds:.1f} s" if len(found) == 1 else said
        self.report({level}, languages.report(said, held=text, ways=len(found), seconds=best.grasp.seconds))
        return {"FINISHED"}


class THENAR_OT_settle_grasp(computing.Computing, bpy.types.Operator):
    """Bend and move the hand from where it is until the forces on the product balance, with its weight and at the \
grip asked for"""

    bl_idname = "thenar.settle_grasp"
    bl_label = "Settle"
    bl_options = {"REGISTER", "UNDO"}
    noun = "Settling"

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_product(context)) and can_pose(cls, context)

    def steps(self, context):
        settings, asked = context.scene.thenar, context.scene.thenar_grasps
        wish = fitter.Wish(pads.FIRM_MM, is_placed=True)
        fit = fitting.prepare(context, settings.hand, workflow.product_parts(settings), wish, 1.0)
        found = yield partial(fitting.settle_here, fit, asked.weight_n, asked.total_n or None)
        fitting.finish(context, fit, found[0], asked.placed())
        asked.shown = -1
        return found

    def _report(self, context, found):
        fitting.bring_into_view(context)
        _, state, friction = found
        level, text = words.held(
            state, (friction, context.scene.thenar_grasps.friction), context.scene.thenar_grasps.total_n or None
        )
        self.report({level}, text)
        return {"FINISHED"}


class THENAR_OT_use_grasp(bpy.types.Operator):
    """Take another one of the grasps that were found for this product"""

    bl_idname = "thenar.use_grasp"
    bl_label = "Use Grasp"
    bl_options = {"REGISTER", "UNDO"}

    index: IntProperty(name="Grasp", description="Which of the grasps found, the best one first", min=0)

    @classmethod
    def poll(cls, context):
        found = getattr(context.scene, "thenar_grasps", None)
        problem = "" if found is not None and found.found else "no grasp was found yet; press Grasp first"
        return polling.allows(cls, polling.no_product(context), problem) and can_pose(cls, context)

    def execute(self, context):
        done = running.attempt(self, fitting.use, context, self.index)
        if done is None:
            return {"CANCELLED"}
        fitting.bring_into_view(context)
        words = "Grasp {number} of {count}; solve to press it"
        count = len(context.scene.thenar_grasps.found)
        self.report({"INFO"}, languages.report(words, number=self.index + 1, count=count))
        return {"FINISHED"}


class THENAR_OT_add_sample(computing.Computing, bpy.types.Operator):
    """Add a complete scene to try: hand, product, camera, light and materials, ready to solve"""

    bl_idname = "thenar.add_sample"
    bl_label = "Add Sample"
    bl_options = {"REGISTER", "UNDO"}
    noun = "Sample"

    kind: EnumProperty(
        name="Sample",
        description="Product, and how the hand meets it",
        items=[(kind, sample.label, "") for kind, sample in samples.SAMPLES.items()],
        default="cylinder_48",
    )

    @classmethod
    def poll(cls, context):
        return can_make(cls, context)

    def steps(self, context):
        return samples.scene_steps(context, self.kind)

    def _report(self, context, made):
        tabs.open_after_hand(bpy.context)
        running.redraw(bpy.context)
        return {"FINISHED"}


CLASSES = (THENAR_OT_fit_grasp, THENAR_OT_settle_grasp, THENAR_OT_use_grasp, THENAR_OT_add_sample)
