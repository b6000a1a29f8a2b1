"""Operators of recordings: load, take off, show the mat, compare, select a place."""

import bpy
from bpy_extras.io_utils import ImportHelper

from .. import names
from ..operators import computing, display, polling, running, selecting
from ..scene.checks import Refusal
from . import comparing, laying, loading, outline, settings

RESIDUAL, PRINT = "RESIDUAL", "PRINT"


def _no_recording(context):
    return "" if settings.chosen(context) is not None else "no recording is loaded; load one first"


def _no_map(context):
    item = settings.chosen(context)
    return "" if item is not None and item.kind != settings.STUDY else "select a recording of a mat or a print"


def _no_comparison(context):
    state = context.scene.thenar_recordings.comparison
    return "" if state.is_valid else "nothing was compared yet; press Compare first"


class THENAR_OT_load_recording(bpy.types.Operator, ImportHelper):
    """Load a study (its folder or study.toml), a maker's export of a pressure mat, or the image of a handprint"""

    bl_idname = "thenar.load_recording"
    bl_label = "Load Recording"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: bpy.props.StringProperty(
        default="*.toml;*.csv;*.txt;*.asc;*.asf;*.fsx;*.lst;*.tsv;*.sol;*.fgt;*.xlsx;*.ods;*.png;*.jpg;*.jpeg;*.tif;*.tiff",
        options={"HIDDEN"},
    )

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_module(), polling.busy())

    def execute(self, context):
        added = running.attempt(self, loading.load, context, bpy.path.abspath(self.filepath))
        if added is None:
            return {"CANCELLED"}
        item = settings.chosen(context)
        if item.kind != settings.STUDY:
            _guess_diameter(context, item)
        self.report({"INFO"}, f"Loaded {', '.join(added)}")
        return {"FINISHED"}


def _guess_diameter(context, item):
    """Begin with the product's own width; where there is no product yet, the default stays."""
    try:
        item.placing.diameter_mm = laying.diameter_mm(comparing.seat_of(context), item.placing.axis)
    except Refusal:
        return


class THENAR_OT_remove_recording(bpy.types.Operator):
    """Remove the recording from the list; its file stays"""

    bl_idname = "thenar.remove_recording"
    bl_label = "Remove Recording"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, _no_recording(context), polling.busy())

    def execute(self, context):
        state = context.scene.thenar_recordings
        state.items.remove(min(state.index, len(state.items) - 1))
        state.index = max(0, min(state.index, len(state.items) - 1))
        return {"FINISHED"}


class THENAR_OT_outline_mat(bpy.types.Operator):
    """Show the sensels of the mat on the product"""

    bl_idname = "thenar.outline_mat"
    bl_label = "Show Mat"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        problems = (polling.no_module(), _no_map(context), polling.no_hand(context), polling.no_product(context))
        return polling.allows(cls, *problems, polling.busy())

    def execute(self, context):
        drawn = running.attempt(self, outline.draw, context, settings.chosen(context))
        return {"CANCELLED"} if drawn is None else {"FINISHED"}


class THENAR_OT_compare(computing.Computing, bpy.types.Operator):
    """Compare with the simulation: a study with its own skin, a mat or a print with the contact of this scene"""

    bl_idname = "thenar.compare"
    bl_label = "Compare"
    bl_options = {"REGISTER", "UNDO"}
    noun = "Compare"

    @classmethod
    def poll(cls, context):
        item = settings.chosen(context)
        scene = () if item is None or item.kind == settings.STUDY else (polling.no_hand, polling.no_product)
        problems = (polling.no_module(), _no_recording(context), *(problem(context) for problem in scene))
        return polling.allows(cls, *problems, polling.busy())

    def steps(self, context):
        return comparing.steps(context)

    def _report(self, context, comparison):
        hand = context.scene.thenar.hand
        held = hand.data.attributes if hand is not None and hand.type == "MESH" else ()
        if names.PRINT_RESIDUAL in held:
            display.show(context, PRINT)
        elif names.RESIDUAL_KPA in held:
            display.show(context, RESIDUAL)
            fitting = display.fitting_range(context)
            if fitting is not None:
                context.scene.thenar.maps.residual_kpa = fitting
        else:
            display.refresh(context)
        running.redraw(context)
        self.report({"INFO"}, comparison.sentence)
        return {"FINISHED"}


class THENAR_OT_select_place(bpy.types.Operator):
    """Select the skin's vertices at this location"""

    bl_idname = "thenar.select_place"
    bl_label = "Select Location"
    bl_options = {"REGISTER", "UNDO"}

    index: bpy.props.IntProperty(name="Place", description="Number of the place in the list", min=0)

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, _no_comparison(context), polling.no_hand(context))

    def execute(self, context):
        return {"CANCELLED"} if running.attempt(self, _select, context, self.index) is None else {"FINISHED"}


def _select(context, index):
    """Select the vertices of a worst place on the hand, in Edit Mode. Returns how many."""
    state, hand = context.scene.thenar_recordings.comparison, context.scene.thenar.hand
    if index >= len(state.worst):
        raise Refusal(f"there is no place {index}; the comparison lists {len(state.worst)}")
    listed = state.worst[index].vertices
    vertices = [int(number) for number in listed.split(",") if number]
    if hand.type != "MESH" or len(hand.data.vertices) != state.vertices or max(vertices, default=0) >= state.vertices:
        raise Refusal(f"the place lies on another skin than '{hand.name}'; choose the hand that was compared")
    if not vertices:
        raise Refusal("the recording does not say where this place lies on the skin; give its sensels or site")
    selecting.select(context, hand, vertices)
    return len(vertices)


CLASSES = (
    THENAR_OT_load_recording,
    THENAR_OT_remove_recording,
    THENAR_OT_outline_mat,
    THENAR_OT_compare,
    THENAR_OT_select_place,
)
