"""The operator that copies what a bug report needs: versions, platform, settings, last error, and no private path."""

import re

import bpy

from .. import languages, names, status
from ..operators import running
from ..product_objects.parts import product_parts
from ..scene import sizes

_PATH = re.compile(r"(?<![\w>])(?:[A-Za-z]:[\\/]|\\\\|~?/)(?:.*(?='(?:[\s;:.,)]|$))|.*)")
"""A path from a drive, a server, the home folder or the root on, to the line's last quote: it may hold any letter."""
_SHOWN = ("model", "use_force", "force_n", "range_kpa", "palette", "live", "accepted_mm", "added_mm")
_OF_RESULT = (
    "model",
    "grade",
    "reason_kind",
    "vertices",
    "force_n",
    "area_mm2",
    "peak_kpa",
    "penetration_mm",
    "effects",
)


class THENAR_OT_copy_debug_info(bpy.types.Operator):
    """Copy versions, platform, settings and the last error for a bug report; paths are left out"""

    bl_idname = "thenar.copy_debug_info"
    bl_label = "Copy Debug Info"
    bl_options = {"REGISTER"}

    def execute(self, context):
        text = written(context)
        context.window_manager.clipboard = text
        words = "Copied {count} lines; paste them into the report"
        self.report({"INFO"}, languages.report(words, count=len(text.splitlines())))
        running.redraw(context)
        return {"FINISHED"}


def written(context):
    """The text, one line for each fact; objects are named in the last error only."""
    settings = context.scene.thenar
    lines = [
        f"Thenar {names.VERSION}",
        f"Native module: {status.native_problem or 'loaded'}",
        f"Blender {bpy.app.version_string}, {bpy.app.build_hash.decode('ascii', 'replace')}",
        status.where(),
        f"Unit scale: {context.scene.unit_settings.scale_length:g}",
        *(f"{name}: {_value(getattr(settings, name))}" for name in _SHOWN),
        *_objects(context, settings),
    ]
    if settings.result.is_valid:
        lines += [f"result {name}: {_value(getattr(settings.result, name))}" for name in _OF_RESULT]
    lines.append(f"Last error: {status.last_error or 'none'}")
    return without_paths("\n".join(lines)) + "\n"


def without_paths(text):
    """The text with every path as `<path>/` and its last part's extension."""
    return _PATH.sub(lambda found: "<path>" + _extension(found[0]), text)


def _objects(context, settings):
    """Sizes and counts of hand and product."""
    hand, parts = settings.hand, product_parts(settings)
    if hand is not None and hand.type == "MESH":
        kinds = ", ".join(modifier.type for modifier in hand.modifiers) or "none"
        yield f"Hand: {len(hand.data.vertices)} vertices, modifiers {kinds}, {len(hand.thenar.materials)} regions"
        yield f"Effects: {', '.join(effect.name for effect in hand.thenar.effects if effect.is_on) or 'none'}"
    if parts:
        count = sum(len(part.data.vertices) for part in parts if part.type == "MESH")
        yield f"Product: {len(parts)} parts, {count} vertices; {sizes.measure(context.scene, hand, parts)}"


def _value(value):
    return f"{value:.6g}" if isinstance(value, float) else value


def _extension(path):
    found = re.search(r"\.\w{1,5}$", path.strip())
    return found[0] if found else ""


CLASSES = (THENAR_OT_copy_debug_info,)
