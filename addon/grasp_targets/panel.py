"""Layout of the target of a grasp. Knows nothing of the search."""

from ..grasp_targets import reasons, settings, stamp
from ..languages import iface
from ..panels import text

NAMES = ("thumb", "index", "middle", "ring", "little", "palm")


def draw(layout, context):
    """The fields of the target that is chosen, its button, and what was reached; those of a total force are others'."""
    stored = context.scene.thenar_targets
    if stored.kind == settings.FINGERS:
        _draw_fingers(layout, context, stored)
    elif stored.kind == settings.RECORDING:
        _draw_recording(layout, context, stored)


def _draw_fingers(layout, context, stored):
    column = layout.column(align=True)
    for part in NAMES:
        column.prop(stored, f"{part}_n")
    layout.operator("thenar.reach_target", text="Reach Forces", icon="CON_FLOOR")
    _draw_age(layout, context, stored.rows)
    for row in stored.rows:
        words = iface(
            "{part}: {have:.1f} of {wanted:.1f} N",
            part=iface(row.name.capitalize()),
            have=row.reached_n,
            wanted=row.wanted_n,
        )
        is_reached = row.reason == reasons.REACHED
        layout.label(text=words, icon="CHECKMARK" if is_reached else "ERROR")
        if not is_reached:
            text.faint(layout, context, reasons.why(row.reason))
    if stored.held:
        text.faint(layout, context, stored.held)


def _draw_age(layout, context, found):
    """Say where the scene is no more what the result holds for."""
    if found and not stamp.holds(context, context.scene.thenar_targets.stamp):
        text.faint(layout, context, iface("Of an earlier pose or target:"))


def _draw_recording(layout, context, stored):
    layout.operator("thenar.reach_target", text="Explain by Posture", icon="CON_FLOOR")
    _draw_age(layout, context, stored.explained)
    for line in stored.explained.splitlines():
        text.faint(layout, context, line)
