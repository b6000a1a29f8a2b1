"""The result in the sidebar: totals, fingers, regions, quality, time."""

import bpy

from .. import maps, status, tabs
from ..curves import panel as over_time
from ..curves import tables
from ..languages import iface
from ..product_objects.parts import product_parts
from ..results import grades
from ..scene import baked
from . import text
from .lists import FINGER_SHARE, SHARE, brief, columns
from .main import Physics, Tab, draw_looks, has_result


class THENAR_PT_result(Tab, bpy.types.Panel):
    """Totals of the last contact."""

    bl_label = "Result"
    bl_parent_id = "THENAR_PT_main"
    bl_order = 1

    @classmethod
    def poll(cls, context):
        return not status.native_problem and has_result(context) and tabs.shows(context, tabs.RESULT)

    def draw(self, context):
        layout, result = self.layout, context.scene.thenar.result
        draw_looks(layout)
        if not result.is_valid:
            draw_maps(layout, context.scene.thenar)
            return
        _draw_grade(layout, context, result)
        box = layout.box().column(align=True)
        _pair(box, "Force", f"{result.force_n:.1f} N")
        _pair(box, "Contact area", f"{result.area_mm2 / 100:.2f} cm²")
        _pair(box, "Peak pressure", f"{result.peak_kpa:.0f} kPa")
        _pair(box, "Peak over 24 mm²", f"{result.patch_peak_kpa:.0f} kPa")
        _pair(box, "Mean pressure", f"{result.mean_kpa:.1f} kPa")
        _pair(box, "Max. overlap", f"{result.depth_mm:.2f} mm")
        if result.offset_mm:
            _pair(box, "Product offset", f"{result.offset_mm:+.2f} mm")
        if result.grip_mm:
            _pair(box, "Grip yields", f"{result.grip_mm:.2f} mm ({result.grip_share:.0%})")
        if result.shear_n:
            _pair(box, "Shear force", f"{result.shear_n:.1f} N")
            _pair(box, "Peak shear", f"{result.shear_peak_kpa:.0f} kPa")
            _pair(box, "Slipping area", iface("{share:.0%} of the area", share=result.slipping))
        if result.is_held_known:
            _draw_holding(layout.box().column(align=True), result)
        draw_maps(layout, context.scene.thenar)


def _draw_holding(box, result):
    """How well the product is held: force closure, and the wrench that is resisted in every direction."""
    closed = "yes" if result.is_force_closed else "no"
    _pair(box, "Force closure", f"{iface(closed)}, μ {result.held_friction:.2f}")
    if result.is_force_closed:
        _pair(box, "Smallest wrench", iface("{share:.0%} of the grip", share=result.held_share))
        _pair(box, "In any direction", f"{result.held_n:.0f} N, {result.held_n * result.held_arm_mm / 1e3:.2f} N m")


def _draw_grade(layout, context, result):
    """The grade before any number, with its reason and where that is."""
    if not result.grade:
        return
    box = layout.box()
    box.alert = result.grade == grades.DO_NOT
    icon = {grades.GOOD: "CHECKMARK", grades.READ: "ERROR"}.get(result.grade, "CANCEL")
    box.label(text=grades.title(result.grade), icon=icon)
    if not result.reason:
        return
    heading = grades.heading(result.reason_kind)
    if heading and iface(heading) != heading and text.spoken(result.reason) == result.reason:  # it stays English
        text.paragraph(box, context, heading)
    text.paragraph(box, context, result.reason)
    if result.reason_vertex >= 0:
        box.operator("thenar.show_place", icon="RESTRICT_SELECT_OFF")
    if grades.asks_for_finer_skin(result.reason_kind, result.passes_between):
        box.operator("thenar.refine_skin", icon="MOD_SUBSURF")


def draw_maps(layout, settings):
    """A button for each map; faint where the hand does not carry it."""
    hand = settings.hand
    if hand is None or hand.type != "MESH":
        return
    flow = layout.grid_flow(row_major=True, columns=2, even_columns=True, align=True)
    for view in maps.MAPS.values():
        cell = flow.row(align=True)
        cell.active = view.attribute in hand.data.attributes or view.kind == maps.THICKNESS
        is_shown = hand.thenar.shows_pressure and settings.maps.shown == view.kind
        cell.operator("thenar.show_map", text=view.title, depress=is_shown).kind = view.kind


def _pair(column, name, value):
    split = column.split(factor=0.55)
    split.label(text=iface(name))
    right = split.row()
    right.alignment = "RIGHT"
    right.label(text=iface(value))


class THENAR_PT_physics_result(Physics, bpy.types.Panel):
    """The totals in the physics properties."""

    bl_label = "Result"
    bl_parent_id = "THENAR_PT_physics"
    bl_order = 1
    draw = THENAR_PT_result.draw

    @classmethod
    def poll(cls, context):
        return Physics.poll(context) and not status.native_problem and has_result(context)


class OfResult(Tab):
    """A panel under the result, shown where there is one."""

    bl_parent_id = "THENAR_PT_result"

    @classmethod
    def poll(cls, context):
        return context.scene.thenar.result.is_valid


class THENAR_PT_regions(OfResult, bpy.types.Panel):
    """The result by region and finger."""

    bl_label = "Regions"

    def draw(self, context):
        layout, result = self.layout, context.scene.thenar.result
        split = layout.split(factor=SHARE)
        split.label(text="Region")
        row = split.row()
        for unit in ("N", "cm²", "kPa"):
            cell = row.row()
            cell.alignment = "RIGHT"
            cell.label(text=unit)
        layout.template_list("THENAR_UL_regions", "", result, "regions", result, "region_index", rows=6)
        if not result.fingers:
            return
        column = layout.box().column(align=True)
        for finger in result.fingers:
            split = column.split(factor=FINGER_SHARE)
            split.label(text=iface(finger.name.capitalize()))
            columns(split, finger)


class THENAR_PT_reference(OfResult, bpy.types.Panel):
    """The fast result compared with the reference solve."""

    bl_label = "Reference"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, result = self.layout, context.scene.thenar.result
        layout.operator("thenar.certify", icon="CHECKMARK")
        reference = result.reference
        if not reference.is_valid:
            text.paragraph(layout, context, "Solves the tissue as a solid: minutes on a whole grasp")
            return
        box = layout.box().column(align=True)
        _compared(box, "", ("Fast", "Ref.", "Ratio"))
        _compared(box, "Force, N", _three(result.force_n, reference.force_n, ".1f"))
        _compared(box, "Area, cm²", _three(result.area_mm2 / 100, reference.area_mm2 / 100, ".1f"))
        _compared(box, "24 mm², kPa", _three(result.patch_peak_kpa, reference.patch_peak_kpa, ".0f"))
        box = layout.box().column(align=True)
        for row in result.regions:
            if row.force_n > 0.0 or row.reference_n > 0.0:
                _compared(box, iface(brief(row.name)), _three(row.force_n, row.reference_n, ".1f"))
        for note in filter(None, reference.note.split(". ")):
            text.paragraph(layout, context, note, "ERROR")


def _three(fast, reference, digits):
    ratio = f"{fast / reference:.2f}" if reference > 0.0 else "-"
    return f"{fast:{digits}}", f"{reference:{digits}}", ratio


def _compared(column, name, values):
    split = column.split(factor=0.4)
    split.label(text=iface(name))
    row = split.row()
    for value in values:
        cell = row.row()
        cell.alignment = "RIGHT"
        cell.label(text=iface(value))


class THENAR_PT_comfort(OfResult, bpy.types.Panel):
    """Pressure held against a threshold."""

    bl_label = "Comfort"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, settings = self.layout, context.scene.thenar
        layout.use_property_split = True
        layout.use_property_decorate = False
        given = settings.comfort
        layout.prop(given, "rule")
        if given.rule in {"DISCOMFORT", "OWN"}:
            column = layout.column(align=True)
            column.label(text="Your pain thresholds" if given.rule == "DISCOMFORT" else "Your thresholds")
            for part in ("finger", "palm", "thenar"):
                column.prop(given, f"{part}_kpa")
        if settings.result.comfort:
            icon = "ERROR" if settings.result.over_mm2 else "CHECKMARK"
            text.paragraph(layout, context, settings.result.comfort, icon)


class THENAR_PT_bake(Tab, bpy.types.Panel):
    """What the bake that plays has found over its frames."""

    bl_label = "Bake"
    bl_parent_id = "THENAR_PT_result"

    @classmethod
    def poll(cls, context):
        hand = context.scene.thenar.hand
        return hand is not None and bool(hand.thenar.bake_path)

    def draw(self, context):
        layout, hand = self.layout, context.scene.thenar.hand
        stored, takes = hand.thenar.bake, baked.take_names(hand)
        for note in baked.notes(hand, product_parts(context.scene.thenar)):
            text.paragraph(layout, context, note, "ERROR")
        if len(takes) > 1:
            column = layout.column(align=True)
            for take in takes:
                icon = "RADIOBUT_ON" if baked.is_playing(hand, take) else "RADIOBUT_OFF"
                column.operator("thenar.play_take", text=take or "Bake", icon=icon).take = take
        has_curves = over_time.draw(layout, context, tables.BAKE)
        box = layout.box().column(align=True)
        if not has_curves:
            _pair(box, "Force", f"{stored.force_n:.1f} N")
            _pair(box, "Contact area", f"{stored.area_mm2 / 100:.2f} cm²")
            _pair(box, "Peak pressure", f"{stored.frame_peak_kpa:.0f} kPa")
        _pair(box, "Frames", iface("{first} to {last}", first=stored.frame_start, last=stored.frame_end))
        _pair(box, "History kept", "yes" if stored.follows else "no")
        _pair(box, "Max. force", f"{stored.peak_force_n:.1f} N")
        _pair(box, "Max. pressure", f"{stored.peak_kpa:.0f} kPa")
        if stored.follows:
            _draw_energy(box, stored)
        layout.operator("thenar.export_bake", icon="EXPORT")


def _draw_energy(box, stored):
    if stored.peak_shear_n:
        _pair(box, "Max. shear force", f"{stored.peak_shear_n:.1f} N")
        _pair(box, "Slip dissipation", f"{stored.slip_loss_mj:.3g} mJ")
    _pair(box, "Work on skin", f"{stored.work_mj:.3g} mJ")
    if stored.cycles:
        _pair(
            box,
            iface("Loss per cycle ({cycles})", cycles=stored.cycles),
            f"{stored.cycle_loss_mj:.3g} mJ, {stored.cycle_loss_share:.0%}",
        )


class THENAR_PT_notes(Tab, bpy.types.Panel):
    """What to know about the result before it is used."""

    bl_label = "Notes"
    bl_parent_id = "THENAR_PT_result"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        result = context.scene.thenar.result
        return result.is_valid and len(result.warnings) > 0

    def draw_header(self, context):
        self.layout.label(text=f"({len(context.scene.thenar.result.warnings)})")

    def draw(self, context):
        for note in context.scene.thenar.result.warnings:
            text.paragraph(self.layout, context, note.name, "ERROR")
        if grades.is_cut(context.scene.thenar.result.shown_between_mm):
            self.layout.operator("thenar.refine_skin", icon="MOD_SUBSURF")


class THENAR_PT_quality(OfResult, bpy.types.Panel):
    """How well the contact is solved and written, and where the time went."""

    bl_label = "Quality and Time"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, result = self.layout, context.scene.thenar.result
        box = layout.box().column(align=True)
        _pair(box, "Penetration", f"{result.penetration_mm * 1000:.1f} µm")
        _pair(box, "Write-back error", f"{result.write_error_mm * 1000:.1f} µm")
        _pair(box, "Complementarity", f"{result.complementarity:.0e}")
        _pair(box, "Model", result.model.capitalize())
        box = layout.box().column(align=True)
        for stage in result.stages:
            _pair(box, _stage(stage.name), f"{stage.seconds * 1000:.0f} ms")


def _stage(name):
    """A stage's name, `read`, or `press: solve` for a part of the press, in the user's language."""
    whole, _, part = name.partition(": ")
    return iface("Press: {stage}", stage=iface(part)) if part else iface(whole.capitalize())


CLASSES = (
    THENAR_PT_result,
    THENAR_PT_physics_result,
    THENAR_PT_regions,
    THENAR_PT_reference,
    THENAR_PT_comfort,
    THENAR_PT_bake,
    THENAR_PT_notes,
    THENAR_PT_quality,
)
