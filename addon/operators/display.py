"""Operators of looks only: maps shown or hidden, range, render preset. They change no result."""

import bpy

from .. import languages, maps, names, status, tissue, workflow
from ..ownership import owned
from ..product_objects import copies
from ..properties import map_settings
from ..results import comfort
from ..scene import attributes
from ..skin_display import colors, shading
from ..views import compositor
from . import polling, running


def shown_objects(context, attribute=names.PRESSURE_KPA):
    """(object, is_skin) of everything that carries `attribute`: the hand, product parts, and copies of those."""
    settings = context.scene.thenar
    hand = settings.hand
    found = [(hand, True)] if hand is not None and hand.type == "MESH" else []
    for part in workflow.product_parts(settings):
        copy = copies.find_copy(part.name)
        if copy is not None:
            found.append((copy, False))
        elif part.type == "MESH":
            found.append((part, False))
    return [(obj, is_skin) for obj, is_skin in found if owned.is_own(obj.data, attribute)]


def refresh(context):
    """Bring colours, overlay and legend to the present map, range and colours; where a map went, to pressure."""
    if context is None or context.scene is None:
        return
    look = context.scene.thenar
    is_on = look.hand is not None and look.hand.thenar.shows_pressure
    if is_on and not shown_objects(context, maps.shown(look).attribute) and shown_objects(context):
        show(context, maps.PRESSURE)
        return
    carriers = shown_objects(context, maps.shown(look).attribute)
    if is_on and any(obj.thenar.copy_of and not obj.thenar.shows_pressure for obj, _ in carriers):
        show(context, look.maps.shown)  # a solve has made a new copy
        return
    shading.update_group(look)
    for obj, is_skin in shown_objects(context):
        if obj.data.is_editable and obj.mode != "EDIT":
            colors.recolor(obj, look, colors.SKIN if is_skin else colors.BARE)
    compositor.update_legend(context.scene)
    for follow in status.map_changed:
        follow(context)
    running.redraw(context)


def judge(context):
    """Judge comfort anew, and colour the skin by the verdict."""
    if context is not None and context.scene is not None:
        comfort.judge(context)
        refresh(context)


def show(context, kind=maps.PRESSURE):
    """Overlay a map on what carries it; copies stand in for products that cannot carry pressure."""
    look = context.scene.thenar
    look.maps.shown = kind
    hide_overlays(context)
    objects = shown_objects(context, maps.shown(look).attribute)
    for obj, is_skin in objects:
        shading.show(obj, look, is_skin)
        if obj.thenar.copy_of:
            copies.swap(obj, True)
    refresh(context)
    for obj, _ in objects:
        index = obj.data.color_attributes.find(names.COLOR if kind == maps.PRESSURE else names.MAP_COLOR)
        if index >= 0:
            obj.data.color_attributes.active_color_index = index
    solid_colors(context, "VERTEX")
    return objects


def look_hides(context):
    """Whether the hand is being painted, which hides materials."""
    hand = context.scene.thenar.hand
    return hand.mode == "WEIGHT_PAINT" and context.view_layer.objects.active == hand


def hide_overlays(context):
    """Give materials and products back as they were before a map was shown."""
    for obj in context.scene.objects:
        if obj.thenar.shows_pressure:
            shading.hide(obj)
            if obj.thenar.copy_of:
                copies.swap(obj, False)


def hide(context):
    """Show no map."""
    hide_overlays(context)
    solid_colors(context, "MATERIAL")
    refresh(context)


def fitting_range(context):
    """A round value above the largest of the map that is shown; 1, 1.5, 2, 3, 5 or 7.5 times a power of ten.

    Of the pressures of a bake that plays, the largest over all its frames counts.
    """
    name, hand = maps.shown(context.scene.thenar).attribute, context.scene.thenar.hand
    peaks = [abs(attributes.read(obj.data, name)).max(initial=0.0) for obj, _ in shown_objects(context, name)]
    if name == names.PRESSURE_KPA and hand is not None and hand.thenar.bake_path:
        peaks.append(hand.thenar.bake.peak_kpa)
    peak = max(peaks, default=0.0)
    if not 0.0 < peak < 1e9:
        return None
    steps = [factor * 10.0**power for power in range(-3, 10) for factor in (1.0, 1.5, 2.0, 3.0, 5.0, 7.5)]
    return next(step for step in steps if step >= peak)


def solid_colors(context, kind):
    """Color the Solid view by `kind`; by MATERIAL only where it was by VERTEX."""
    manager = context.window_manager
    for window in manager.windows if manager is not None else ():
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                shader = area.spaces.active.shading
                if kind == "VERTEX" or shader.color_type == "VERTEX":
                    shader.color_type = kind


def _no_pressure(context):
    return "" if shown_objects(context) else maps.MAPS[maps.PRESSURE].missing


def _no_map(context):
    view = maps.shown(context.scene.thenar)
    if not view.limit:
        return languages.tip("the range of {map} is fixed", map=languages.inside(view.title))
    return "" if shown_objects(context, view.attribute) else view.missing


class THENAR_OT_show_pressure(bpy.types.Operator):
    """Color hand and product by pressure, over their own materials, with one range for both"""

    bl_idname = "thenar.show_pressure"
    bl_label = "Show Pressure"
    bl_options = {"REGISTER", "UNDO"}

    show: bpy.props.BoolProperty(name="Show", description="Off restores the materials", default=True)

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, _no_pressure(context))

    def execute(self, context):
        if self.show:
            show(context)
        else:
            hide(context)
        return {"FINISHED"}


class THENAR_OT_show_map(bpy.types.Operator):
    """Color the skin by a map, over its own material"""

    bl_idname = "thenar.show_map"
    bl_label = "Show Map"
    bl_options = {"REGISTER", "UNDO"}

    kind: bpy.props.EnumProperty(name="Map", description="Quantity that the colors show", items=map_settings.KINDS)

    @classmethod
    def description(cls, context, properties):
        """The map's own meaning as the tooltip."""
        return languages.tip(maps.MAPS[properties.kind].meaning)

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_hand(context), polling.busy())

    def execute(self, context):
        view = maps.MAPS[self.kind]
        if self.kind == maps.THICKNESS and running.attempt(self, tissue.write_thickness, context) is None:
            return {"CANCELLED"}
        if not shown_objects(context, view.attribute):
            self.report({"ERROR"}, running.sentence(languages.report(view.missing)))
            return {"CANCELLED"}
        if look_hides(context):
            bpy.ops.object.mode_set(mode="OBJECT")
        show(context, self.kind)
        return {"FINISHED"}


class THENAR_OT_reset_range(bpy.types.Operator):
    """Fit the color range to the largest value of the map; while a bake plays, over all its frames"""

    bl_idname = "thenar.reset_range"
    bl_label = "Fit Range"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, _no_map(context))

    def execute(self, context):
        fitting, look = fitting_range(context), context.scene.thenar
        if fitting is None:
            name = languages.inside(maps.shown(look).title)
            words = "No {map} is above zero; solve a contact that touches first"
            self.report({"ERROR"}, languages.report(words, map=name))
            return {"CANCELLED"}
        setattr(*maps.setting(maps.shown(look), look), fitting)
        return {"FINISHED"}


class THENAR_OT_render_preset(bpy.types.Operator):
    """Render with the Standard view transform, without denoiser and with legend: map colors keep their values"""

    bl_idname = "thenar.render_preset"
    bl_label = "Set Up Render Colors"
    bl_options = {"REGISTER", "UNDO"}

    restore: bpy.props.BoolProperty(name="Restore", description="Restore the earlier settings", default=False)

    def execute(self, context):
        if self.restore:
            compositor.restore_preset(context.scene)
        else:
            compositor.apply_preset(context.scene)
        return {"FINISHED"}


CLASSES = (THENAR_OT_show_pressure, THENAR_OT_show_map, THENAR_OT_reset_range, THENAR_OT_render_preset)
