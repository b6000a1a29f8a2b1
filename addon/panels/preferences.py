"""The extension's preferences: what a new hand, map and picture begin with; what is loaded, or why it is not."""

import os

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from .. import names, status
from . import text

THREADS = "RAYON_NUM_THREADS"
"""Where the native module looks for the number of threads, when it computes for the first time."""


def _set_threads(preferences, _context=None):
    if preferences.threads:
        os.environ[THREADS] = str(preferences.threads)
    else:
        os.environ.pop(THREADS, None)


class ThenarPreferences(bpy.types.AddonPreferences):
    """Defaults of buttons; scripts and open scenes keep their own values."""

    bl_idname = __package__.rpartition(".")[0]

    sex: EnumProperty(
        name="Sex", description="Sex of a new hand", items=(("male", "Male", "Men"), ("female", "Female", "Women"))
    )
    side: EnumProperty(
        name="Side",
        description="Side of a new hand",
        items=(("right", "Right", "Right hand"), ("left", "Left", "Left hand")),
    )
    percentile: FloatProperty(
        name="Percentile",
        description="Size of a new hand among adults of that sex, percent",
        min=1.0,
        max=99.0,
        default=50.0,
    )
    map_after_solve: BoolProperty(
        name="Show Map after Solve",
        description="The button Solve shows the pressure, and the product as glass",
        default=True,
    )
    palette: EnumProperty(
        name="Colors",
        description="Color map of the pressure in a scene that was not solved yet",
        items=(
            ("EMBER", "Ember", "Light where pressure is low"),
            ("VIRIDIS", "Viridis", "Dark where pressure is low"),
            ("CIVIDIS", "Cividis", "As Viridis, also with a color-vision deficiency"),
        ),
    )
    range_kpa: FloatProperty(
        name="Range (kPa)",
        description="Pressure at the top of the color map in a scene that was not solved yet, kPa",
        min=1.0,
        soft_max=500.0,
        default=150.0,
    )
    folder: StringProperty(
        name="Pictures",
        description="Folder of pictures where the scene names none; empty: thenar_pictures next to the file",
        subtype="DIR_PATH",
    )
    threads: IntProperty(
        name="Threads",
        description="Threads of the solver, from the next start of Blender on; 0: all of the processor's",
        min=0,
        max=1024,
        update=_set_threads,
    )

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        for title, fields in _GROUPS:
            column = layout.column(heading=title)
            for name in fields:
                column.prop(self, name)
        layout.use_property_split = False
        layout.operator("thenar.add_pose_library", icon="ASSET_MANAGER")
        draw_state(layout, context)


_GROUPS = (
    ("New hand", ("sex", "side", "percentile")),
    ("Result", ("map_after_solve", "palette", "range_kpa")),
    ("System", ("folder", "threads")),
)


def draw_state(layout, context):
    """Version and platform; the reason where the native module cannot be used; what a report needs."""
    problem = status.native_problem
    if problem:
        text.alert(layout.box(), context, problem)
    column = layout.column(align=True)
    column.label(text=f"Thenar {names.VERSION}", icon="ERROR" if problem else "CHECKMARK")
    column.label(text=status.where(), icon="BLANK1")
    layout.operator("thenar.copy_debug_info", icon="COPYDOWN")


def apply_threads(context):
    """Bring the number of threads to the native module before it computes."""
    addon = context.preferences.addons.get(ThenarPreferences.bl_idname)
    if addon is not None and addon.preferences is not None and addon.preferences.threads:
        _set_threads(addon.preferences)


def fill(context, target, preferences):
    """Set properties of `target` that nobody set yet, {name: preference}; those without a preference stay."""
    addon = context.preferences.addons.get(ThenarPreferences.bl_idname)
    for name, preference in preferences.items() if addon is not None else ():
        value = getattr(addon.preferences, preference, "")
        if value != "" and not target.is_property_set(name):
            setattr(target, name, value)


def get(context, name, otherwise):
    """The preference of that name; `otherwise` where there are no preferences, as in scripts and tests."""
    addon = context.preferences.addons.get(ThenarPreferences.bl_idname)
    return getattr(addon.preferences, name, otherwise) if addon is not None else otherwise


CLASSES = (ThenarPreferences,)
