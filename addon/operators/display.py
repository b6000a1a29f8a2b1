"""Operators of looks only: pressure shown or hidden, range, render preset. They change no result."""

import bpy

from .. import names, workflow
from ..scene import attributes, colors, copies, shading
from ..views import compositor
from . import polling, running


def shown_objects(context):
    """(object, is_skin) of everything that shows pressure: the hand, product parts that carry it, and copies."""
    settings = context.scene.thenar
    hand = settings.hand
    found = [(hand, True)] if hand is not None and hand.type == "MESH" else []
    for part in workflow.product_parts(settings):
        copy = copies.find_copy(part.name)
        if copy is not None:
            found.append((copy, False))
        elif part.type == "MESH":
            found.append((part, False))
    return [(obj, is_skin) for obj, is_skin in found if names.PRESSURE_KPA in obj.data.attributes]


def refresh(context):
    """Bring colours, overlay and legend to the current range and colour map."""
    if context is None or context.scene is None:
        return
    look = context.scene.thenar
    shading.update_group(look)
    for obj, is_skin in shown_objects(context):
        if obj.data.is_editable and obj.mode != "EDIT":
            colors.recolor(obj.data, look, colors.SKIN if is_skin else colors.BARE)
    compositor.update_legend(context.scene)
    running.redraw(context)


def show(context):
    """Overlay pressure on hand and product; copies stand in for products that cannot carry it."""
    look = context.scene.thenar
    objects = shown_objects(context)
    for obj, is_skin in objects:
        shading.show(obj, look, is_skin)
        if obj.thenar.copy_of:
            _swap(obj, True)
        index = obj.data.color_attributes.find(names.COLOR)
        if index >= 0:
            obj.data.color_attributes.active_color_index = index
    _solid_colors(context, "VERTEX")
    refresh(context)
    return objects


def hide(context):
    """Give materials and products back as they were before the pressure was shown."""
    for obj in context.scene.objects:
        if obj.thenar.shows_pressure:
            shading.hide(obj)
            if obj.thenar.copy_of:
                _swap(obj, False)
    _solid_colors(context, "MATERIAL")
    refresh(context)


def fitting_range(context):
    """A round pressure, kPa, above the largest on hand and product; 1, 1.5, 2, 3, 5 or 7.5 times a power of ten."""
    peaks = [attributes.read(obj.data, names.PRESSURE_KPA).max(initial=0.0) for obj, _ in shown_objects(context)]
    peak = max(peaks, default=0.0)
    if peak <= 0.0:
        return None
    steps = [factor * 10.0**power for power in range(-3, 6) for factor in (1.0, 1.5, 2.0, 3.0, 5.0, 7.5)]
    return next(step for step in steps if step >= peak)


def _swap(copy, shown):
    copy.hide_viewport = copy.hide_render = not shown
    part = bpy.data.objects.get(copy.thenar.copy_of)
    if part is None:
        return
    if shown:
        copy.thenar.was_hidden = part.hide_get()
        part.hide_set(True)
        copy.thenar.hid_render = not part.hide_render
        part.hide_render = True
    else:
        part.hide_set(copy.thenar.was_hidden)
        if copy.thenar.hid_render:
            part.hide_render = False


def _solid_colors(context, kind):
    manager = context.window_manager
    for window in manager.windows if manager is not None else ():
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                shader = area.spaces.active.shading
                if kind == "VERTEX" or shader.color_type == "VERTEX":
                    shader.color_type = kind


def _no_pressure(context):
    return "" if shown_objects(context) else "there is no pressure yet; press Solve first"


class THENAR_OT_show_pressure(bpy.types.Operator):
    """Colour hand and product by pressure, over their own materials, with one range for both"""

    bl_idname = "thenar.show_pressure"
    bl_label = "Show Pressure"
    bl_options = {"REGISTER", "UNDO"}

    show: bpy.props.BoolProperty(name="Show", description="Off gives the materials back", default=True)

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, _no_pressure(context))

    def execute(self, context):
        if self.show:
            show(context)
        else:
            hide(context)
        return {"FINISHED"}


class THENAR_OT_reset_range(bpy.types.Operator):
    """Fit the range of the colours to the largest pressure on hand and product"""

    bl_idname = "thenar.reset_range"
    bl_label = "Fit Range"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, _no_pressure(context))

    def execute(self, context):
        fitting = fitting_range(context)
        if fitting is None:
            self.report({"ERROR"}, "No pressure is above zero; solve a contact that touches first")
            return {"CANCELLED"}
        context.scene.thenar.range_kpa = fitting
        return {"FINISHED"}


class THENAR_OT_render_preset(bpy.types.Operator):
    """Set the render so that colours keep their values (Standard view, no denoiser) and carry the legend"""

    bl_idname = "thenar.render_preset"
    bl_label = "True Colours"
    bl_options = {"REGISTER", "UNDO"}

    restore: bpy.props.BoolProperty(name="Restore", description="Give the earlier settings back", default=False)

    def execute(self, context):
        if self.restore:
            compositor.restore_preset(context.scene)
        else:
            compositor.apply_preset(context.scene)
        return {"FINISHED"}


CLASSES = (THENAR_OT_show_pressure, THENAR_OT_reset_range, THENAR_OT_render_preset)
