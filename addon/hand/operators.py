"""Operators of the hand: make it, pose it, name its bones."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty

from .. import languages, status, tabs
from ..hand_bones import posing
from ..hand_bones.reading import armature_of
from ..hand_shape import framing
from ..operators import computing, polling, running
from ..panels import preferences
from . import added, build
from .poses import LABELS


class THENAR_OT_make_hand(computing.Computing, bpy.types.Operator):
    """Add a rigged hand of measured proportions, with its regions and tissue"""

    bl_idname = "thenar.make_hand"
    bl_label = "Make Hand"
    bl_options = {"REGISTER", "UNDO"}
    noun = "Hand"

    sex: EnumProperty(
        name="Sex",
        description="Sex whose measured sizes the hand has",
        items=(("male", "Male", ""), ("female", "Female", "")),
    )
    side: EnumProperty(
        name="Side", description="Right or left hand", items=(("right", "Right", ""), ("left", "Left", ""))
    )
    percentile: FloatProperty(
        name="Percentile", description="Size among adults of that sex", min=1.0, max=99.0, default=50.0
    )
    length_mm: FloatProperty(name="Length (mm)", description="Hand length, mm; 0 takes the percentile's", min=0.0)
    breadth_mm: FloatProperty(name="Breadth (mm)", description="Hand breadth, mm; 0 takes the percentile's", min=0.0)
    spacing_mm: FloatProperty(name="Spacing (mm)", description="Vertex spacing, mm", min=1.0, max=6.0, default=2.5)

    @classmethod
    def poll(cls, context):
        return can_make(cls, context)

    def invoke(self, context, event):
        """From a button, the preferences say which hand."""
        preferences.fill(context, self.properties, {"sex": "sex", "side": "side", "percentile": "percentile"})
        return super().invoke(context, event)

    def steps(self, context):
        """The hand is made next to the window; ended on the way, the file is as it was."""
        shape = {"percentile": self.percentile, "sex": self.sex, "side": self.side, "spacing_mm": self.spacing_mm}
        for name in ("length_mm", "breadth_mm"):
            if getattr(self, name) > 0.0:
                shape[name] = getattr(self, name)
        return hand_steps(context, shape)

    def _report(self, context, hand):
        tabs.open_after_hand(context)
        running.redraw(context)
        words = "'{name}' has {vertices:,} vertices"
        self.report({"INFO"}, languages.report(words, name=hand.name, vertices=len(hand.data.vertices)))
        return {"FINISHED"}


def hand_steps(context, shape):
    """The steps of a hand of this `shape` in the scene shown at their start, chosen as its hand and looked at. Returns
    the hand."""
    with added.taken_back_unless_whole(context) as own:
        hand = yield from own.in_turns(_adding(context, shape))
    own.scene.thenar.hand = hand
    if own.is_shown():
        framing.frame(context, hand)
    return hand


def _adding(context, shape):
    made = yield build.making(**shape)
    hand, _ = yield from build.adding(context, made)
    return hand


class THENAR_OT_apply_pose(bpy.types.Operator):
    """Apply a pose of the library to the hand; works on every armature whose bones are assigned"""

    bl_idname = "thenar.apply_pose"
    bl_label = "Apply Pose"
    bl_options = {"REGISTER", "UNDO"}

    name: EnumProperty(
        name="Pose",
        description="Joint angles that the fingers take",
        items=[(name, label, "") for name, label in LABELS.items()],
        default="relaxed",
    )

    @classmethod
    def poll(cls, context):
        return can_pose(cls, context)

    def execute(self, context):
        done = running.attempt(self, posing.apply_pose, context, context.scene.thenar.hand, self.name)
        if not done:
            _open_bones()
        return {"FINISHED"} if done else {"CANCELLED"}


class THENAR_OT_guess_bones(bpy.types.Operator):
    """Find the hand's bones by hierarchy and shape, whatever their names"""

    bl_idname = "thenar.guess_bones"
    bl_label = "Detect Bones"
    bl_options = {"REGISTER", "UNDO"}

    with_regions: BoolProperty(
        name="Regions", description="Paint the skin's regions too, if the hand lists none", default=True
    )

    @classmethod
    def poll(cls, context):
        return can_pose(cls, context)

    def execute(self, context):
        found = running.attempt(self, posing.guess_bones, context, context.scene.thenar.hand)
        if found is None:
            _open_bones()
            return {"CANCELLED"}
        count, remarks = found
        hand = context.scene.thenar.hand
        armature_of(hand).thenar_bones.show_digits = True
        text = languages.report("{count} bones found", count=count) + (f"; {remarks}" if remarks else "")
        self.report({"WARNING" if remarks else "INFO"}, text)
        if self.with_regions and _has_bone_groups_only(hand) and bpy.ops.thenar.regions_from_bones.poll():
            _try_regions(self)
        return {"FINISHED"}


def _has_bone_groups_only(hand):
    """Whether no region is listed and every vertex group is a bone's: groups of one's own may be regions already."""
    return not hand.thenar.materials and set(hand.vertex_groups.keys()) <= set(armature_of(hand).data.bones.keys())


def _try_regions(operator):
    """Regions as well; where they cannot be cut the bones stay, and the reason is shown as a warning."""
    try:
        bpy.ops.thenar.regions_from_bones()
    except RuntimeError as error:
        operator.report({"WARNING"}, languages.reported(error))


def _open_bones():
    """Show the *Bones* panel at the mouse, where what the message asks for can be done."""
    if not bpy.app.background and bpy.context.window is not None:
        bpy.ops.wm.call_panel("INVOKE_DEFAULT", name="THENAR_PT_bones", keep_open=True)


def can_make(cls, context):
    """Whether a hand can be added now."""
    return polling.allows(cls, status.native_problem, polling.wrong_mode(context), polling.busy())


def can_pose(cls, context):
    """Whether the scene has a hand that can be posed now."""
    problems = (polling.no_hand(context), status.native_problem, polling.wrong_mode(context), polling.busy())
    return polling.allows(cls, *problems)


CLASSES = (
    THENAR_OT_make_hand,
    THENAR_OT_apply_pose,
    THENAR_OT_guess_bones,
)
