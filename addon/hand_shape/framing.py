"""The 3D view turned to what was just made or added."""

import bpy
import numpy as np
from mathutils import Vector

ROOM = 2.5
"""Distance of the view over half the longest side: all of it is seen at the lens of a new view."""


def frame(context, *objects):
    """Frame `objects` in the 3D view in which it was asked for, or in all of the window; nothing in background."""
    if bpy.app.background or context.window is None:
        return
    asked = context.area
    areas = [asked] if asked is not None and asked.type == "VIEW_3D" else context.window.screen.areas
    corners = np.array([obj.matrix_world @ Vector(corner) for obj in objects for corner in obj.bound_box])
    low, high = corners.min(axis=0), corners.max(axis=0)
    for area in areas:
        if area.type == "VIEW_3D":
            view = area.spaces.active.region_3d
            if view.view_perspective == "CAMERA":
                view.view_perspective = "PERSP"
            view.view_location = 0.5 * (low + high)
            view.view_distance = ROOM * 0.5 * float((high - low).max())
            area.tag_redraw()
