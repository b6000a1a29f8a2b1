"""The tabs of the panel by task: set up, result, record, diagnose. Which is open is kept while Blender runs."""

import functools

import bpy
from bpy.props import EnumProperty, PointerProperty

SETUP, RESULT, RECORD, DIAGNOSE = "SETUP", "RESULT", "RECORD", "DIAGNOSE"


_AGAIN_S = (0.1, 0.2, 0.3, 0.5)
"""Pauses before the panel is drawn again: Blender (5.2) puts panels that appear where they were last, and right with a
later drawing. One timer after the other, so that each leads to a drawing however slow these are."""


def _was_opened(_self, context):
    _redraw()
    if not bpy.app.background:
        bpy.app.timers.register(functools.partial(_again, iter(_AGAIN_S[1:])), first_interval=_AGAIN_S[0])


def _again(pauses):
    _redraw()
    return next(pauses, None)


def _redraw():
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


class ThenarTabs(bpy.types.PropertyGroup):
    """`window_manager.thenar_tabs`: no undo step and no file keeps it."""

    tab: EnumProperty(
        name="Task",
        description="What the panel shows",
        items=(
            (SETUP, "Set Up", "Hand, product, grasp, materials and effects, and the button that solves"),
            (RESULT, "Result", "The result: views, maps, numbers, pictures, frames and files"),
            (RECORD, "Record", "Recordings of pressure, how they lie on the product, and what comparing them shows"),
            (DIAGNOSE, "Diagnose", "What a study of recordings shows that the model leaves out"),
        ),
        update=_was_opened,
    )


def shows(context, tab):
    """Whether the panel shows what belongs to a tab: the one that is open, or all while no hand is set."""
    return context.scene.thenar.hand is None or context.window_manager.thenar_tabs.tab == tab


def open_tab(context, tab):
    """Open a tab, as a click on it does."""
    context.window_manager.thenar_tabs.tab = tab


def open_after_hand(context):
    """Open what comes next once a hand is set: the study that is being made, or setting up."""
    open_tab(context, RECORD if context.scene.thenar_new_study.is_open else SETUP)


def register():
    """Hang the tabs on the window manager."""
    bpy.utils.register_class(ThenarTabs)
    bpy.types.WindowManager.thenar_tabs = PointerProperty(type=ThenarTabs)


def unregister():
    """Take them off again."""
    del bpy.types.WindowManager.thenar_tabs
    bpy.utils.unregister_class(ThenarTabs)
