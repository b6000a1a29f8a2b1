"""The legend in the 3D view, while a map is shown."""

import blf
import bpy
import gpu
from gpu_extras.batch import batch_for_shader

from . import legend

_STEPS = 96
_state = {"handle": None}


def _draw():
    context = bpy.context
    settings = getattr(context.scene, "thenar", None)
    if settings is None or not settings.show_legend or context.region is None:
        return
    hand = settings.hand
    if hand is None or not hand.thenar.shows_pressure or hand.mode == "WEIGHT_PAINT":  # painting shows weights instead
        return
    if not context.space_data.overlay.show_overlays:
        return
    left = next((region.width for region in context.area.regions if region.type == "TOOLS"), 0)
    height = min(context.region.height, 620)
    below = next((region.height for region in context.area.regions if region.type == "HUD"), 0)
    plan = legend.layout(settings, settings.result, height, left + 16)
    _draw_layout(legend.raised(plan, below if below > 1 else 0), settings)


def _draw_layout(plan, look):
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    gpu.state.blend_set("ALPHA")
    _quads(shader, [(plan.plate, legend.PLATE)])
    x, y, width, height = plan.bar
    step = height / _STEPS
    colors = legend.column_on_plate(look, _STEPS)
    _quads(shader, [((x, y + k * step, width, step), (*color, 1.0)) for k, color in enumerate(colors)])
    gpu.state.blend_set("NONE")
    for x, y, size, text in plan.texts:
        blf.size(0, size)
        blf.color(0, 0.95, 0.95, 0.95, 1.0)
        blf.position(0, x, y, 0)
        blf.draw(0, text)


def _quads(shader, boxes):
    corners, colors, indices = [], [], []
    for (x, y, width, height), color in boxes:
        first = len(corners)
        corners += [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]
        colors += [tuple(map(float, color))] * 4
        indices += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
    batch_for_shader(shader, "TRIS", {"pos": corners, "color": colors}, indices=indices).draw(shader)


def register():
    """Draw the legend in every 3D view; without a window there is nothing to draw on."""
    if not bpy.app.background:
        _state["handle"] = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_PIXEL")


def unregister():
    """Stop drawing."""
    if _state["handle"] is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_state["handle"], "WINDOW")
        _state["handle"] = None
