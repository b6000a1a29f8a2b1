"""Operators of the hand: make it, pose it, name its bones, fit a grasp, add a sample."""

from functools import partial

import bpy
from bpy.props import EnumProperty, FloatProperty

from .. import status, workflow
from ..hand_shape import framing
from ..operators import computing, polling, running
from ..scene.checks import Refusal
from . import build, fitting, grasp, pads, posing, samples
from .poses import LABELS

STRENGTHS = (
    ("LIGHT", "Light", "Pads sink 2 to 3 mm, as in a loose hold"),
    ("FIRM", "Firm", "Pads sink 3 to 6 mm, as the contact areas of a power grasp need"),
    ("CUSTOM", "Custom Depths", "Depths entered below"),
)
MOVES = (
    ("HAND", "Hand", "The hand goes to the product"),
    ("PRODUCT", "Product", "The product comes to the hand"),
    ("FINGERS", "Fingers Only", "Hand and product stay; only the fingers close"),
)
PLACES = (
    ("LAY", "In Palm", "The product is placed across the palm before the fingers close"),
    ("KEEP", "Current Pose", "The fit starts from the current pose and place of hand and product"),
)
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


class THENAR_OT_make_hand(bpy.types.Operator):
    """Add a rigged hand of measured proportions, with its regions and tissue"""

    bl_idname = "thenar.make_hand"
    bl_label = "Make Hand"
    bl_options = {"REGISTER", "UNDO"}

    sex: EnumProperty(name="Sex", items=(("male", "Male", ""), ("female", "Female", "")))
    side: EnumProperty(name="Side", items=(("right", "Right", ""), ("left", "Left", "")))
    percentile: FloatProperty(
        name="Percentile", description="Size among adults of that sex", min=1.0, max=99.0, default=50.0
    )
    length_mm: FloatProperty(name="Length (mm)", description="Hand length, mm; 0 takes the percentile's", min=0.0)
    breadth_mm: FloatProperty(name="Breadth (mm)", description="Hand breadth, mm; 0 takes the percentile's", min=0.0)
    spacing_mm: FloatProperty(name="Spacing (mm)", description="Vertex spacing, mm", min=1.0, max=6.0, default=2.5)

    @classmethod
    def poll(cls, context):
        return _can_make(cls, context)

    def execute(self, context):
        hand = running.attempt(self, self._make, context)
        if hand is None:
            return {"CANCELLED"}
        self.report({"INFO"}, f"'{hand.name}' has {len(hand.data.vertices):,} vertices")
        return {"FINISHED"}

    def _make(self, context):
        shape = {"percentile": self.percentile, "sex": self.sex, "side": self.side, "spacing_mm": self.spacing_mm}
        for name in ("length_mm", "breadth_mm"):
            if getattr(self, name) > 0.0:
                shape[name] = getattr(self, name)
        hand, _ = build.add_hand(context, build.make(**shape))
        context.scene.thenar.hand = hand
        framing.frame(context, hand)
        return hand


class THENAR_OT_apply_pose(bpy.types.Operator):
    """Apply a pose of the library to the hand; works on every armature whose bones are assigned"""

    bl_idname = "thenar.apply_pose"
    bl_label = "Apply Pose"
    bl_options = {"REGISTER", "UNDO"}

    name: EnumProperty(name="Pose", items=[(name, label, "") for name, label in LABELS.items()], default="relaxed")

    @classmethod
    def poll(cls, context):
        return _can_pose(cls, context)

    def execute(self, context):
        done = running.attempt(self, posing.apply_pose, context, context.scene.thenar.hand, self.name)
        return {"FINISHED"} if done else {"CANCELLED"}


class THENAR_OT_guess_bones(bpy.types.Operator):
    """Assign the bones by their names and their order"""

    bl_idname = "thenar.guess_bones"
    bl_label = "Detect Bones"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return _can_pose(cls, context)

    def execute(self, context):
        found = running.attempt(self, posing.guess_bones, context, context.scene.thenar.hand)
        if found is None:
            return {"CANCELLED"}
        self.report({"INFO"}, f"{found} bones found")
        return {"FINISHED"}


class THENAR_OT_fit_grasp(computing.Computing, bpy.types.Operator):
    """Close the hand on the product until every pad reaches the given depth, within the joint limits"""

    bl_idname = "thenar.fit_grasp"
    bl_label = "Fit Grasp"
    bl_options = {"REGISTER", "UNDO"}
    noun = "Fit"

    strength: EnumProperty(name="Strength", items=STRENGTHS, default="FIRM")
    distal_mm: _depth("distal")
    middle_mm: _depth("middle")
    proximal_mm: _depth("proximal")
    palm_mm: _depth("palm")
    place: EnumProperty(name="Start", items=PLACES, default="LAY")
    moves: EnumProperty(name="Moves", items=MOVES, default="HAND")
    digits: EnumProperty(name="Digits", items=DIGITS, options={"ENUM_FLAG"}, default={digit[0] for digit in DIGITS})
    force_n: FloatProperty(
        name="Force (N)", description="Total force that the pressed skin shall carry, N; 0 for depths alone", min=0.0
    )

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_product(context)) and _can_pose(cls, context)

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        for name in ("strength", "place", "moves"):
            layout.prop(self, name)
        if self.strength == "CUSTOM":
            for name in ("distal_mm", "middle_mm", "proximal_mm", "palm_mm"):
                layout.prop(self, name)
        layout.column(align=True).prop(self, "digits")
        layout.prop(self, "force_n")

    def steps(self, context):
        settings = context.scene.thenar
        parts = workflow.product_parts(settings)
        fit = fitting.prepare(context, settings.hand, parts, self._wish(), self.force_n or None)
        found = yield partial(fitting.compute, fit)
        fitting.finish(context, fit, found, self.moves)
        return found

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
        return grasp.Wish(depths, digits, placed, free_mm)

    def _report(self, context, found):
        for text in found.warnings:
            self.report({"WARNING"}, running.sentence(text))
        misses = [abs(found.depths_mm[name] - want) for name, want in found.targets_mm.items()]
        force = f", {found.force_n:.0f} N" if found.force_n is not None else ""
        self.report(
            {"INFO"},
            f"{len(misses)} pads within {max(misses):.1f} mm of their depth "
            f"(mean {sum(misses) / len(misses):.1f} mm){force}, {found.seconds:.1f} s",
        )
        return {"FINISHED"}


class THENAR_OT_add_sample(bpy.types.Operator):
    """Add a complete scene to try: hand, product, camera, light and materials, ready to solve"""

    bl_idname = "thenar.add_sample"
    bl_label = "Add Sample"
    bl_options = {"REGISTER", "UNDO"}

    kind: EnumProperty(
        name="Sample",
        items=[(kind, sample.label, "") for kind, sample in samples.SAMPLES.items()],
        default="cylinder_48",
    )

    @classmethod
    def poll(cls, context):
        return _can_make(cls, context)

    def execute(self, context):
        made = running.attempt(self, samples.add_sample_scene, context, self.kind)
        return {"FINISHED"} if made else {"CANCELLED"}


def _can_make(cls, context):
    return polling.allows(cls, status.native_problem, polling.wrong_mode(context), polling.busy())


def _can_pose(cls, context):
    problems = (polling.no_hand(context), status.native_problem, polling.wrong_mode(context), polling.busy())
    return polling.allows(cls, *problems)


CLASSES = (
    THENAR_OT_make_hand,
    THENAR_OT_apply_pose,
    THENAR_OT_guess_bones,
    THENAR_OT_fit_grasp,
    THENAR_OT_add_sample,
)
