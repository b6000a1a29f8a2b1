"""Operators of recordings: load, take off, show the mat, compare, select a place."""

from functools import partial

import bpy

from .. import languages, names, tabs
from ..languages import sentences
from ..operators import computing, display, polling, running, selecting
from ..scene.checks import Refusal
from . import comparing, frames, laying, loading, outline, settings, showing

RESIDUAL, PRINT = "RESIDUAL", "PRINT"


def _no_recording(context):
    return "" if settings.chosen(context) is not None else "no recording is loaded; load one first"


def _no_map(context):
    item = settings.chosen(context)
    return "" if item is not None and item.kind != settings.STUDY else "select a recording of a mat or a print"


def _no_comparison(context):
    state = context.scene.thenar_recordings.comparison
    return "" if state.is_valid else "nothing was compared yet; press Compare first"


class THENAR_OT_load_recording(computing.OpensFiles, bpy.types.Operator):
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
        path = bpy.path.abspath(self.filepath)
        if self.reads_beside(context):
            return self.hand_over(bpy.ops.thenar.read_recording, filepath=path)
        added = running.attempt(self, loading.load, context, path)
        return {"CANCELLED"} if added is None else _loaded(self, context, added)


class THENAR_OT_read_recording(computing.Computing, bpy.types.Operator):
    """Read a measurement file, a study or a handprint next to the window, and add it to the list"""

    bl_idname = "thenar.read_recording"
    bl_label = "Read Recording"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}
    noun = "Reading"

    filepath: bpy.props.StringProperty(name="File", description="The recording's file", subtype="FILE_PATH")

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_module(), polling.busy())

    def steps(self, context):
        found = yield partial(loading.read, bpy.path.abspath(self.filepath))
        return loading.add(context, found)

    def _report(self, context, added):
        return _loaded(self, context, added)


def _loaded(operator, context, added):
    """Guess where a mat lies, and report."""
    _guess_size(context, settings.chosen(context))
    frames.settle(context)
    tabs.open_tab(context, tabs.RECORD)
    operator.report({"INFO"}, languages.report("Loaded {files}", files=", ".join(added)))
    return {"FINISHED"}


def _guess_size(context, item):
    """Begin with the product's own long axis and width, once; where there is no product yet, the defaults stay."""
    if item.kind == settings.STUDY or item.placing.is_sized:
        return
    try:
        seat = comparing.seat_of(context)
    except Refusal:
        return
    item.placing.axis = laying.long_axis(seat, item.placing.axis)
    item.placing.diameter_mm = laying.diameter_mm(seat, item.placing.axis)


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


class THENAR_OT_show_recording(bpy.types.Operator):
    """Show the recording in its colors on the product, and next to it what the mat would read of the contact"""

    bl_idname = "thenar.show_recording"
    bl_label = "Show Recording"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context):
        problems = (polling.no_module(), _no_map(context), polling.no_hand(context), polling.no_product(context))
        return polling.allows(cls, *problems, polling.busy(), polling.live(context), polling.wrong_mode(context))

    def execute(self, context):
        _guess_size(context, settings.chosen(context))
        shown = running.attempt(self, showing.put, context)
        running.redraw(context)
        return {"CANCELLED"} if shown is None else {"FINISHED"}


class THENAR_OT_show_residual(bpy.types.Operator):
    """Show measured minus simulated on the opened hand"""

    bl_idname = "thenar.show_residual"
    bl_label = "Residual"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, _no_comparison(context), polling.no_hand(context), polling.busy())

    def execute(self, context):
        held = context.scene.thenar.hand.data.attributes
        kind = PRINT if names.PRINT_RESIDUAL in held else RESIDUAL
        try:
            bpy.ops.thenar.show_map(kind=kind)
        except RuntimeError as error:
            self.report({"ERROR"}, languages.reported(error))
            return {"CANCELLED"}
        if bpy.ops.thenar.look.poll():
            bpy.ops.thenar.look(kind="OPENED")
        return {"FINISHED"}


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
        self._was_shown = showing.is_shown(context)
        _guess_size(context, settings.chosen(context))
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
        if self._was_shown and bpy.ops.thenar.show_recording.poll():
            running.attempt(self, showing.put, context)
        running.redraw(context)
        self.report({"INFO"}, sentences.shown(comparison.sentence))
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
    THENAR_OT_read_recording,
    THENAR_OT_remove_recording,
    THENAR_OT_outline_mat,
    THENAR_OT_show_recording,
    THENAR_OT_show_residual,
    THENAR_OT_compare,
    THENAR_OT_select_place,
)
