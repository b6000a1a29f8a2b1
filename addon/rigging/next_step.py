"""The button that a rigged hand needs before a grasp, in the main panel: find its bones, or join loose ones; and after
one, where a control rig lost its fingers to it, the way back."""

from ..hand.panel import armature_of
from ..hand_bones import bonemap, constrained
from ..panels import main, start, text
from . import joining


def draw(layout, context):
    """Draw the step that is missing. Returns whether a grasp has to wait for it."""
    armature = armature_of(context)
    if armature is None:
        return False
    known = bonemap.get_map(armature)
    if not known:
        text.faint(layout, context, "Which bone is which finger's is not known yet:")
        _big(layout, "thenar.guess_bones", "VIEWZOOM")
        return False
    if constrained.is_muted(armature):
        text.faint(layout, context, "The fingers keep the grasp; their controls do not move them:")
        layout.operator("thenar.back_to_controls", icon="LOOP_BACK")
    if not joining.loose(armature, known):
        return False
    text.faint(layout, context, "The fingers' bones do not hang on each other, so that they cannot bend yet:")
    _big(layout, "thenar.join_bones", "CONSTRAINT_BONE")
    return True


def _big(layout, operator, icon):
    row = layout.row()
    row.scale_y = start.BIG
    row.operator(operator, icon=icon)


def register():
    """Draw it above the main panel's own buttons."""
    main.before_grasp.append(draw)


def unregister():
    """Draw it no more."""
    main.before_grasp.remove(draw)
