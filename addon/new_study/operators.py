"""Operators of a new study: choose its files, pick its place, write it, give it up; open a sample."""

from pathlib import Path

import bpy
from bpy_extras.view3d_utils import region_2d_to_origin_3d, region_2d_to_vector_3d

from .. import languages, steps, tabs
from ..operators import computing, polling, running
from ..recordings import loading
from ..scene.checks import Refusal
from . import drafting, making, settings, skins

SAMPLES = Path(__file__).resolve().parents[1] / "sample_studies"
KINDS = (
    ("nothing_missing", "Nothing Missing", "Balls pressed on gel, as Hertz and Sneddon say, with a laboratory's noise"),
    ("concealed_effect", "Something Missing", "The same, with one effect that the model does not have: which?"),
    ("held_handle", "Held Handle", "A hand holds a cylinder three times, with a mat and a force trace: what changed?"),
)


class _OfFiles:
    """An operator on recordings of one folder, chosen by name."""

    directory: bpy.props.StringProperty(name="Folder", description="Folder of the recordings", subtype="DIR_PATH")
    files: bpy.props.CollectionProperty(
        name="Files",
        description="Names of the recordings in the folder",
        type=bpy.types.OperatorFileListElement,
        options={"HIDDEN", "SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_module(), polling.busy())

    def steps(self, context):
        """The computation, see `drafting.steps`."""
        names = [each.name for each in self.files if each.name]
        return drafting.steps(context, bpy.path.abspath(self.directory), names)


class THENAR_OT_new_study(_OfFiles, computing.OpensFiles, bpy.types.Operator):
    """Choose recordings of a tool pressed on skin (CSV, text, workbook, JPK, Mach-1 ...): Thenar proposes the study \
to diagnose, and asks what the files do not state"""

    bl_idname = "thenar.new_study"
    bl_label = "New Study from Files"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: bpy.props.StringProperty(
        default="*.csv;*.txt;*.tsv;*.asc;*.dat;*.ddf;*.xlsx;*.xls;*.jpk-*", options={"HIDDEN"}
    )

    def execute(self, context):
        if self.reads_beside(context):
            chosen = [{"name": each.name} for each in self.files if each.name]
            return self.hand_over(bpy.ops.thenar.read_study_files, directory=self.directory, files=chosen)
        count = running.attempt(self, steps.at_once, self.steps(context))
        return {"CANCELLED"} if count is None else _opened(self, context, count)


class THENAR_OT_read_study_files(_OfFiles, computing.Computing, bpy.types.Operator):
    """Read the recordings of a new study next to the window, and open what the panel asks about them"""

    bl_idname = "thenar.read_study_files"
    bl_label = "Read Recordings"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}
    noun = "Reading"

    def _report(self, context, count):
        return _opened(self, context, count)


def _opened(operator, context, count):
    """Show the proposal, and report."""
    tabs.open_tab(context, tabs.RECORD)
    running.redraw(context)
    words = "{count} recordings; answer what New Study asks"
    words = "1 recording; answer what New Study asks" if count == 1 else words
    operator.report({"INFO"}, languages.report(words, count=count))
    return {"FINISHED"}


class _OfStudy:
    """An operator on the study that is being made."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        is_open = context.scene.thenar_new_study.is_open
        problem = "" if is_open else "no study is being made; press New Study from Files first"
        return polling.allows(cls, polling.no_module(), problem, polling.busy())


class THENAR_OT_write_study(_OfStudy, bpy.types.Operator):
    """Write study.toml and its skin next to the recordings, and load the study; then press Diagnose"""

    bl_idname = "thenar.write_study"
    bl_label = "Write Study"

    @classmethod
    def poll(cls, context):
        problems = (polling.no_module(), drafting.problem(context), polling.busy())
        return polling.allows(cls, *problems)

    def execute(self, context):
        title = running.attempt(self, making.make, context)
        if title is None:
            return {"CANCELLED"}
        tabs.open_tab(context, tabs.DIAGNOSE)
        running.redraw(context)
        words = "Study '{title}' is written and loaded; press Diagnose"
        self.report({"INFO"}, languages.report(words, title=title))
        return {"FINISHED"}


class THENAR_OT_discard_study(_OfStudy, bpy.types.Operator):
    """Close the proposal without writing a study; the recordings stay"""

    bl_idname = "thenar.discard_study"
    bl_label = "Discard"

    def execute(self, context):
        drafting.discard(context.scene.thenar_new_study)
        running.redraw(context)
        return {"FINISHED"}


class THENAR_OT_leave_out_file(_OfStudy, bpy.types.Operator):
    """Take this recording out of the study that is being made; the file stays"""

    bl_idname = "thenar.leave_out_file"
    bl_label = "Leave Out"

    number: bpy.props.IntProperty(name="Recording", description="Place in the list of recordings, from 0", min=0)

    def execute(self, context):
        if running.attempt(self, drafting.leave_out, context, self.number) is None:
            return {"CANCELLED"}
        running.redraw(context)
        return {"FINISHED"}


class THENAR_OT_pick_site(_OfStudy, bpy.types.Operator):
    """Click the place on the hand's skin where the tool pressed. Esc cancels"""

    bl_idname = "thenar.pick_site"
    bl_label = "Pick Site"

    @classmethod
    def poll(cls, context):
        is_open = context.scene.thenar_new_study.is_open
        problem = "" if is_open else "no study is being made; press New Study from Files first"
        return polling.allows(cls, problem, polling.no_hand(context), polling.wrong_mode(context), polling.busy())

    def invoke(self, context, event):
        if context.area is None or context.area.type != "VIEW_3D":
            self.report({"ERROR"}, "The site is picked in a 3D view; press this in its sidebar")
            return {"CANCELLED"}
        words = languages.iface("Click the skin where the tool pressed    Esc: cancel")
        context.workspace.status_text_set(words)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS":
            return self._end(context, {"CANCELLED"})
        problem = _gone(context)
        if problem:
            self.report({"ERROR"}, running.sentence(languages.report(problem)))
            return self._end(context, {"CANCELLED"})
        region = next((each for each in context.area.regions if each.type == "WINDOW"), None)
        inside = region is not None and 0 <= event.mouse_x - region.x < region.width
        inside = inside and 0 <= event.mouse_y - region.y < region.height
        if event.type != "LEFTMOUSE" or event.value != "PRESS" or not inside or _covers(context, event):
            return {"PASS_THROUGH"}
        place = (event.mouse_x - region.x, event.mouse_y - region.y)
        view = context.space_data.region_3d
        eye, ray = region_2d_to_origin_3d(region, view, place), region_2d_to_vector_3d(region, view, place)
        if running.attempt(self, take_site, context, eye, ray) is None:
            return {"RUNNING_MODAL"}
        return self._end(context, {"FINISHED"})

    def _end(self, context, result):
        context.workspace.status_text_set(None)
        context.area.tag_redraw()
        return result


def _gone(context):
    """What a place cannot be picked without any more: the study, or its hand in the scene; empty while both are."""
    if not context.scene.thenar_new_study.is_open:
        return "no study is being made any more; press New Study from Files first"
    hand = context.scene.thenar.hand
    if hand is None or hand.type != "MESH" or hand.name not in context.scene.objects:
        return "the hand is not in the scene any more; make or choose one, and press Pick Site again"
    return ""


def take_site(context, eye, ray):
    """The site where a ray (world, Blender's units) meets the hand. Returns its place there. Raises `Refusal`."""
    problem = _gone(context)
    if problem:
        raise Refusal(problem)
    hand, state = context.scene.thenar.hand, context.scene.thenar_new_study
    depsgraph = context.evaluated_depsgraph_get()
    into = hand.matrix_world.inverted_safe()
    is_hit, place, _, _ = hand.evaluated_get(depsgraph).ray_cast(into @ eye, into.to_3x3() @ ray)
    if not is_hit:
        raise Refusal(f"that is not on '{hand.name}'; click its skin")
    state.site_vertex, state.skin = skins.picked(context, hand, hand.matrix_world @ place), settings.HAND
    return place


def _covers(context, event):
    """Whether the sidebar or another region lies over the view at the mouse."""
    return any(
        each.type != "WINDOW"
        and each.x <= event.mouse_x < each.x + each.width
        and each.y <= event.mouse_y < each.y + each.height
        for each in context.area.regions
    )


class THENAR_OT_sample_study(bpy.types.Operator):
    """Open a small study to diagnose: its recordings do not come from Thenar's contact model"""

    bl_idname = "thenar.sample_study"
    bl_label = "Sample Study"
    bl_options = {"REGISTER", "UNDO"}

    kind: bpy.props.EnumProperty(name="Study", description="Which sample", items=KINDS)

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_module(), polling.busy())

    def execute(self, context):
        added = running.attempt(self, loading.load, context, str(SAMPLES / self.kind))
        if added is None:
            return {"CANCELLED"}
        tabs.open_tab(context, tabs.DIAGNOSE)
        running.redraw(context)
        self.report({"INFO"}, languages.report("Loaded {files}; press Diagnose", files=", ".join(added)))
        return {"FINISHED"}


CLASSES = (
    THENAR_OT_new_study,
    THENAR_OT_read_study_files,
    THENAR_OT_write_study,
    THENAR_OT_discard_study,
    THENAR_OT_leave_out_file,
    THENAR_OT_pick_site,
    THENAR_OT_sample_study,
)
