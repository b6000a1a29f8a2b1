"""The legend in the 3D view, while a map is shown."""

import itertools
import json

import blf
import bpy
import gpu
from bpy_extras.view3d_utils import location_3d_to_region_2d
from gpu_extras.batch import batch_for_shader
from mathutils import Vector

from ..languages import iface
from . import legend

_STEPS = 96
LEAST = 0.6
"""How much smaller words of neighbors may become."""
LABELS = "thenar_labels"
"""Property of a look's collection: JSON of places (x, y, z), texts, and whether the legend holds for them."""
_state = {"handle": None}


def _draw():
    context = bpy.context
    settings = getattr(context.scene, "thenar", None)
    if settings is None or not settings.show_legend or context.region is None:
        return
    if not context.space_data.overlay.show_overlays:
        return
    labels = _labels(context.scene)
    _draw_labels(context, labels)
    hand = settings.hand
    is_map = hand is not None and hand.thenar.shows_pressure and hand.mode != "WEIGHT_PAINT"  # it shows weights instead
    if not (labels.get("has_legend", False) or (is_map and not labels)):
        return
    left = next((region.width for region in context.area.regions if region.type == "TOOLS"), 0)
    height = min(context.region.height, 620)
    below = next((region.height for region in context.area.regions if region.type == "HUD"), 0)
    plan = legend.layout(settings, settings.result, height, left + 16)
    _draw_layout(legend.raised(plan, below if below > 1 else 0), settings)


def _labels(scene):
    """What the look at a recording says of its pictures; empty where there is none."""
    found = (home[LABELS] for home in scene.collection.children if LABELS in home)
    return json.loads(next(found, "{}"))


def _draw_labels(context, labels):
    """The words of each picture, on a plate above it; smaller where plates would meet."""
    places = [
        location_3d_to_region_2d(context.region, context.region_data, Vector(place))
        for place in labels.get("places", ())
    ]
    if not places or None in places:
        return
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    texts = [text.split("\n") for text in labels["texts"]]
    size = 13 * context.preferences.system.ui_scale
    widths = _widths(texts, size)
    apart = [abs(b.x - a.x) / (max(widths) + 1.5 * size) for a, b in itertools.pairwise(places)]
    size *= max(min([1.0, *apart]), LEAST)
    for at, lines, wide in zip(places, texts, _widths(texts, size), strict=True):
        left, low = at.x - 0.5 * wide, at.y + size
        gpu.state.blend_set("ALPHA")
        plate = (left - 0.6 * size, low - 0.6 * size, wide + 1.2 * size, (1.5 * len(lines) + 0.5) * size)
        _quads(shader, [(plate, legend.PLATE)])
        gpu.state.blend_set("NONE")
        for number, line in enumerate(reversed(lines)):
            blf.color(0, 0.95, 0.95, 0.95, 1.0)
            blf.position(0, left, low + 1.5 * number * size, 0)
            blf.draw(0, line)


def _widths(texts, size):
    """Width of the longest line of each text, pixels."""
    blf.size(0, size)
    return [max(blf.dimensions(0, line)[0] for line in lines) for lines in texts]


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
        blf.draw(0, iface(text))


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
