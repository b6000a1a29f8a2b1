"""The sidebar tab: state, set-up, solve, display, export."""

import bpy

from .. import maps, names, status, tabs
from ..hand_bones import bonemap, roles
from ..languages import iface
from ..presets import kinds, menus
from ..product_objects.parts import product_parts
from ..properties import effect_settings
from ..results import grades
from ..scene.units import mm_per_unit
from . import manual, start, text
from .preferences import draw_state


class Tab:
    """Where the panels stand."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Thenar"

    def draw_header_preset(self, context):
        """A question mark that opens the panel's own heading of the guide."""
        manual.draw(self.layout, f"guide.html#{manual.heading_of(self.bl_label)}")


def has_hand(context):
    """Whether a hand is chosen that can be pressed."""
    hand = context.scene.thenar.hand
    return not status.native_problem and hand is not None and hand.type == "MESH"


def has_result(context):
    """Whether there is a result to read: of a solve, or of a bake that plays."""
    hand = context.scene.thenar.hand
    return context.scene.thenar.result.is_valid or (hand is not None and bool(hand.thenar.bake_path))


def has_map(context):
    """Whether the hand shows a map, or has one to show."""
    if not has_hand(context):
        return False
    hand = context.scene.thenar.hand
    return has_result(context) or hand.thenar.shows_pressure or names.PRESSURE_KPA in hand.data.attributes


class OfHand(Tab):
    """A closed part of the tab Set Up that is there once a hand is chosen."""

    bl_parent_id = "THENAR_PT_main"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return has_hand(context) and tabs.shows(context, tabs.SETUP)


class Physics:
    """The same panels once more, in the physics properties of a mesh, for those who hide the sidebar."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "physics"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "MESH"


class THENAR_PT_main(Tab, bpy.types.Panel):
    """The tabs; what is to be pressed, and the button that presses."""

    bl_label = "Thenar"
    bl_translation_context = "*"  # the name of the extension; in its own context it is the ball of the thumb

    def draw(self, context):
        layout = self.layout
        if status.native_problem:
            draw_state(layout, context)
            return
        if context.scene.thenar.hand is None:
            start.draw_cards(layout, context)
            return
        row = layout.row(align=True)
        row.prop(context.window_manager.thenar_tabs, "tab", expand=True)
        if tabs.shows(context, tabs.SETUP):
            _draw_set_up(layout, context)
        elif tabs.shows(context, tabs.RESULT):
            _draw_solved(layout, context)


def _draw_set_up(layout, context):
    settings = context.scene.thenar
    layout.use_property_split = True
    layout.use_property_decorate = False
    _draw_state(layout, context)
    column = layout.column()
    column.prop(settings, "hand")
    row = column.row(align=True)
    row.prop(settings, "product")
    row.operator("thenar.add_product", text="", icon="IMPORT")
    column.prop(settings, "product_collection")
    start.draw_sizes(layout, context)
    if not product_parts(settings):
        start.draw_add(layout)
        return
    layout.prop(settings, "model")
    _draw_force(layout, settings)
    _draw_next(layout, context)
    _draw_live(layout, context)
    _draw_facts(layout, context)


def _draw_solved(layout, context):
    """The state of the result, and the buttons that renew and end it."""
    _draw_state(layout, context)
    if not product_parts(context.scene.thenar):
        text.faint(layout, context, "Choose the product under Set Up first")
        return
    if not text.progress(layout):
        _draw_solve(layout)
    _draw_live(layout, context)
    _draw_ends(layout)


def _draw_ends(layout):
    """What ends a result."""
    if bpy.ops.thenar.clear.poll():
        row = layout.row(align=True)
        row.operator("thenar.clear", text="Clear", icon="TRASH")
        row.operator("thenar.apply", text="Apply", icon="CHECKMARK")


def _draw_facts(layout, context):
    """What only matters where something is wrong."""
    hand, column = context.scene.thenar.hand, layout.column(align=True)
    if hand.type != "MESH":
        return
    column.active = False
    count = sum(modifier.show_viewport for modifier in hand.modifiers)
    about = "{vertices:,} vertices, 1 modifier" if count == 1 else "{vertices:,} vertices, {count} modifiers"
    column.label(text=iface(about, vertices=len(hand.data.vertices), count=count), icon="MESH_DATA")
    column.label(text=iface("1 unit = {mm:g} mm", mm=mm_per_unit(context.scene)), icon="DRIVER_DISTANCE")


def _draw_state(layout, context):
    settings, column = context.scene.thenar, layout.column(align=True)
    hand = settings.hand
    if hand.type != "MESH":
        column.label(text="Choose a mesh as the hand", icon="INFO")
        return
    if settings.live:
        follower = status.live.get(context.scene.name)
        waits = follower is not None and follower.problem
        column.label(text="Live paused" if waits else "Live running", icon="PAUSE" if waits else "CHECKMARK")
    elif hand.thenar.bake_path:
        column.label(text="Playing a bake", icon="RENDER_ANIMATION")
    elif not settings.result.is_valid:
        column.label(text="Not solved yet", icon="DOT")
    elif status.is_stale(context.scene.name):
        row = column.row()
        row.alert = True
        row.label(text="Out of date: the scene changed", icon="ERROR")
    elif settings.result.grade in {"", grades.GOOD}:
        column.label(text="Result up to date: good", icon="CHECKMARK")
    else:
        row = column.row()
        row.alert = settings.result.grade == grades.DO_NOT
        icon = "CANCEL" if row.alert else "ERROR"
        row.label(text=iface("Result up to date: {grade}", grade=iface(settings.result.grade)), icon=icon)
    _draw_refusal(layout, context, settings.refusal)


def _draw_refusal(layout, context, refusal):
    """Why the last press gave no result, with what mends it."""
    if not refusal.text:
        return
    box = layout.box()
    text.alert(box, context, refusal.text)
    _draw_explained(box, refusal.text)
    row = box.row(align=True)
    row.operator("thenar.show_place", icon="RESTRICT_SELECT_OFF")
    if grades.says_finer_skin(refusal.text):
        box.operator("thenar.refine_skin", icon="MOD_SUBSURF")
    if bpy.ops.thenar.fit_grasp.poll():
        row.operator("thenar.grasp_lighter", text="Lighter Grasp", icon="HAND")


def _draw_explained(layout, message):
    """A button that opens the entry of Troubleshooting on a message, where there is one."""
    page = manual.page_of_message(message)
    if page:
        button = layout.operator("wm.url_open", text="Why, and What to Do", icon="HELP")
        button.url = manual.address(page)


def _draw_force(layout, settings):
    row = layout.row(heading="Force Target", align=True)
    row.prop(settings, "use_force", text="")
    value = row.row(align=True)
    value.active = settings.use_force
    value.prop(settings, "force_n", text="")
    if settings.use_force:
        column = layout.column()
        column.prop(settings, "direction_mode")
        if settings.direction_mode == "OWN":
            column.prop(settings, "direction", text=" ")


def _draw_next(layout, context):
    """The buttons to press next: a grasp while the hand is at rest, and Solve."""
    if text.progress(layout):
        return
    settings = context.scene.thenar
    waits = any([draw(layout, context) for draw in before_grasp])
    if not (waits or settings.result.is_valid or _is_posed(settings.hand)) and bpy.ops.thenar.fit_grasp.poll():
        row = layout.row()
        row.scale_y = start.BIG
        row.operator("thenar.fit_grasp", text="Grasp the Product", icon="CON_ARMATURE").place = "LAY"
    _draw_solve(layout)


def _draw_solve(layout):
    row = layout.row()
    row.scale_y = start.BIG
    row.operator("thenar.solve", text="Solve", icon="PLAY")


before_grasp = []
"""Functions `(layout, context)` that draw a step which the hand needs first; each returns whether a grasp waits."""


def _is_posed(hand):
    """Whether a bone of the fingers, or any where these are not known, was turned or moved from its rest."""
    rigs = [
        modifier.object for modifier in hand.modifiers if modifier.type == "ARMATURE" and modifier.object is not None
    ]
    bones = [bone for rig in rigs if rig.pose is not None for bone in _fingers(rig)]
    return any(bone.matrix_basis.to_quaternion().angle > AT_REST or bone.location.length > AT_REST for bone in bones)


def _fingers(rig):
    """Pose bones of the assigned fingers; all of a rig that has none assigned: the arm of a body may be posed."""
    named = [name for role, name in bonemap.get_map(rig).items() if role != roles.WRIST]
    return [rig.pose.bones[name] for name in named if name in rig.pose.bones] or list(rig.pose.bones)


AT_REST = 1e-3
"""Turn (rad) and move (units) of a bone up to which it rests."""


def _draw_live(layout, context):
    scene = context.scene
    follower = status.live.get(scene.name)
    row = layout.row()
    row.use_property_split = False
    row.prop(scene.thenar, "live", toggle=True, icon="RADIOBUT_ON" if scene.thenar.live else "RADIOBUT_OFF")
    if not scene.thenar.live or follower is None:
        return
    if follower.problem:
        text.alert(layout, context, follower.problem)
    else:
        words = iface("{rate:.0f} updates/s, {ms:.0f} ms each", rate=follower.rate, ms=follower.ms)
        layout.label(text=words, icon="TIME")


class THENAR_PT_display(Tab, bpy.types.Panel):
    """How the map on the skin looks."""

    bl_label = "Display"
    bl_parent_id = "THENAR_PT_main"
    bl_order = 2

    @classmethod
    def poll(cls, context):
        return has_map(context) and tabs.shows(context, tabs.RESULT)

    def draw(self, context):
        layout, settings = self.layout, context.scene.thenar
        layout.use_property_split = True
        layout.use_property_decorate = False
        shown = settings.hand is not None and settings.hand.thenar.shows_pressure
        view = maps.shown(settings)
        button = layout.operator(
            "thenar.show_pressure",
            text=iface("Hide {map}", map=iface(view.title)) if shown else "Show Pressure",
            icon="HIDE_ON" if shown else "SHADING_RENDERED",
            depress=shown,
        )
        button.show = not shown
        place = maps.setting(view, settings)
        if place is not None:
            line = layout.row(align=True)
            line.prop(*place)
            line.operator("thenar.reset_range", text="", icon="FULLSCREEN_EXIT")
        menus.draw_row(layout, kinds.LOOK)
        layout.prop(settings, "palette")
        layout.prop(settings.maps, "contour")
        layout.prop(settings, "show_legend")
        kept = bool(settings.preset_before)
        button = layout.operator(
            "thenar.render_preset",
            text="Restore Render Settings" if kept else "Set Up Render Colors and Legend",
            icon="LOOP_BACK" if kept else "RESTRICT_RENDER_OFF",
        )
        button.restore = kept


def draw_looks(layout):
    """The view buttons, and the way back."""
    flow = layout.grid_flow(row_major=True, columns=2, even_columns=True, align=True)
    for kind, title in LOOKS:
        flow.operator("thenar.look", text=title).kind = kind
    if bpy.ops.thenar.look_back.poll():
        layout.operator("thenar.look_back", icon="LOOP_BACK")


LOOKS = (("OPENED", "Hand Opened"), ("PALM", "Palm"), ("PRODUCT", "Product"), ("APART", "Apart"))
"""The view buttons in their order."""


class THENAR_PT_physics(Physics, bpy.types.Panel):
    """The sidebar's main panel in the physics properties, without tabs."""

    bl_label = "Thenar"
    bl_translation_context = "*"

    def draw(self, context):
        layout = self.layout
        if status.native_problem:
            draw_state(layout, context)
        elif context.scene.thenar.hand is None:
            start.draw_cards(layout, context)
        else:
            _draw_set_up(layout, context)
            _draw_ends(layout)


class THENAR_PT_physics_display(Physics, bpy.types.Panel):
    """The sidebar's display panel in the physics properties."""

    bl_label = "Display"
    bl_parent_id = "THENAR_PT_physics"
    bl_order = 2
    draw = THENAR_PT_display.draw

    @classmethod
    def poll(cls, context):
        return Physics.poll(context) and has_map(context)


class THENAR_PT_output(Tab, bpy.types.Panel):
    """Frames and files."""

    bl_label = "Bake & Export"
    bl_parent_id = "THENAR_PT_main"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 5

    @classmethod
    def poll(cls, context):
        is_set = has_hand(context) and bool(product_parts(context.scene.thenar))
        return is_set and tabs.shows(context, tabs.RESULT)

    def draw(self, context):
        layout, scene = self.layout, context.scene
        button = layout.operator("thenar.bake", icon="RENDER_ANIMATION")
        button.frame_start, button.frame_end = scene.frame_start, scene.frame_end
        hand = scene.thenar.hand
        if hand is not None and effect_settings.needs_history(hand):
            column = layout.column(align=True)
            column.active = False
            rate = scene.render.fps / scene.render.fps_base
            column.label(text=iface("Frames keep history, {rate:g} fps", rate=rate), icon="TIME")
        layout.operator("thenar.export", icon="EXPORT")
        layout.operator("thenar.export_contact_map", icon="EXPORT")
        column = layout.column(align=True)
        column.active = False
        column.label(text=iface("Shape key: {name}", name=names.SHAPE_KEY))
        column.label(text=iface("Attribute: {name}", name=names.PRESSURE_KPA))


CLASSES = (THENAR_PT_main, THENAR_PT_display, THENAR_PT_output, THENAR_PT_physics, THENAR_PT_physics_display)
