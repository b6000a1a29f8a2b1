"""The recognised digits as coloured lines with their names in the 3D view, while *Show Digits* is on."""

import blf
import bpy
import gpu
from bpy_extras.view3d_utils import location_3d_to_region_2d
from gpu_extras.batch import batch_for_shader

from ..hand_bones import reading
from ..languages import iface
from ..scene.checks import Refusal
from . import assigning

COLORS = {
    "thumb": (0.90, 0.62, 0.00, 1.0),
    "index": (0.34, 0.71, 0.91, 1.0),
    "middle": (0.00, 0.62, 0.45, 1.0),
    "ring": (0.94, 0.89, 0.26, 1.0),
    "little": (0.80, 0.47, 0.65, 1.0),
}
"""Okabe and Ito's palette, safe for the color blind."""
_WIDTH, _SIZE = 4.0, 13
_state = {"handle": None}


def shown():
    """Digit -> world points of what is drawn now; empty if nothing is, as while a map is shown, which lines cover."""
    settings = getattr(bpy.context.scene, "thenar", None)
    if settings is None or settings.hand is None or settings.hand.thenar.shows_pressure:
        return {}
    try:
        armature = reading.armature_of(settings.hand)
    except Refusal:
        return {}
    return assigning.lines(armature) if armature.thenar_bones.show_digits else {}


def _draw():
    context = bpy.context
    if context.region is None or not context.space_data.overlay.show_overlays:
        return
    region, view = context.region, context.region_data
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    for digit, points in shown().items():
        places = [location_3d_to_region_2d(region, view, point) for point in points]
        if None in places:
            continue
        gpu.state.blend_set("ALPHA")
        batch = batch_for_shader(shader, "LINE_STRIP", {"pos": [(*place, 0.0) for place in places]})
        shader.bind()
        shader.uniform_float("viewportSize", (region.width, region.height))
        shader.uniform_float("lineWidth", _WIDTH * context.preferences.system.ui_scale)
        shader.uniform_float("color", COLORS[digit])
        batch.draw(shader)
        gpu.state.blend_set("NONE")
        blf.size(0, _SIZE * context.preferences.system.ui_scale)
        blf.enable(0, blf.SHADOW)
        blf.shadow(0, 3, 0.0, 0.0, 0.0, 1.0)
        blf.color(0, *COLORS[digit])
        blf.position(0, places[-1].x + 6, places[-1].y + 6, 0)
        blf.draw(0, iface(digit.capitalize()))
        blf.disable(0, blf.SHADOW)


def register():
    """Draw in every 3D view; without a window there is nothing to draw on."""
    if not bpy.app.background:
        _state["handle"] = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_PIXEL")


def unregister():
    """Stop drawing."""
    if _state["handle"] is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_state["handle"], "WINDOW")
        _state["handle"] = None
