"""The listed regions of the hand as colors on its skin in the 3D view, until the button is pressed again."""

import colorsys

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from ..operators import polling
from ..scene import mesh, regions

OPACITY = 0.75
LIFT = 0.002
"""How far in front of the skin the colors lie, in parts of the hand's size, so that both do not flicker."""
_state = {"handle": None, "hand": None, "numbers": None}


def show(hand, numbers):
    """Color `hand` by region `numbers` (n,), -1 for none."""
    _state.update(hand=hand.name_full, numbers=np.asarray(numbers))


def hide():
    """Take the colors off."""
    _state.update(hand=None, numbers=None)


def is_shown(hand):
    """Whether the regions of `hand` are drawn."""
    return hand is not None and _state["hand"] == hand.name_full


def colors(count):
    """`count` colors (k, 4), neighbors in the list far apart in hue."""
    hues = (np.arange(count) * 0.381966) % 1.0  # the golden section
    return np.array([(*colorsys.hsv_to_rgb(hue, 0.65, 0.9), OPACITY) for hue in hues], np.float32).reshape(-1, 4)


def painted(context):
    """World corners (3 m, 3) and colors (3 m, 4) of the triangles drawn now; None if nothing is."""
    settings = getattr(context.scene, "thenar", None)
    hand = settings.hand if settings is not None else None
    if not is_shown(hand) or hand.hide_get():
        return None
    shape = hand.evaluated_get(context.evaluated_depsgraph_get()).data
    numbers = _state["numbers"]
    if len(shape.vertices) != len(numbers):
        return None
    positions = mesh.positions(shape).astype(np.float64)
    facing = np.empty(3 * len(numbers), np.float32)
    shape.vertices.foreach_get("normal", facing)
    positions += LIFT * np.ptp(positions, axis=0).max() * facing.reshape(-1, 3)
    world = np.array(hand.matrix_world)
    positions = positions @ world[:3, :3].T + world[:3, 3]
    triangles = mesh.triangles(shape)
    triangles = triangles[(numbers[triangles] >= 0).all(axis=1)]
    table = colors(numbers.max(initial=0) + 1)
    return positions[triangles.ravel()].astype(np.float32), table[numbers[triangles.ravel()]]


def _draw():
    context = bpy.context
    if not context.space_data.overlay.show_overlays:
        return
    found = painted(context)
    if found is None:
        return
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("LESS_EQUAL")
    batch_for_shader(shader, "TRIS", {"pos": found[0], "color": found[1]}).draw(shader)
    gpu.state.depth_test_set("NONE")
    gpu.state.blend_set("NONE")


class THENAR_OT_show_regions(bpy.types.Operator):
    """Color the skin by the regions listed under Materials; press again to take the colors off"""

    bl_idname = "thenar.show_regions"
    bl_label = "Show Regions"

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, polling.no_hand(context), polling.no_regions(context))

    def execute(self, context):
        hand = context.scene.thenar.hand
        if is_shown(hand):
            hide()
        else:
            names = [material.name for material in hand.thenar.materials if material.name in hand.vertex_groups]
            show(hand, regions.vertex_regions(context, hand, names))
        for window in context.window_manager.windows:
            for area in window.screen.areas:
                area.tag_redraw()
        return {"FINISHED"}


CLASSES = (THENAR_OT_show_regions,)


def register():
    """Draw in every 3D view; without a window there is nothing to draw on."""
    hide()
    if not bpy.app.background:
        _state["handle"] = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW")


def unregister():
    """Stop drawing."""
    if _state["handle"] is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_state["handle"], "WINDOW")
        _state["handle"] = None
    hide()
