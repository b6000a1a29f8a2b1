"""The 3D view turned to what was just made, added or grasped."""

import bpy
import numpy as np
from mathutils import Vector

ROOM = 2.5
"""Distance of the view over half the longest side: all of it is seen at the lens of a new view."""
LEAST_SHARE = 0.2
"""Things that span less of a view's shorter side are not seen well."""
MOST_HANDS = 3.0
"""A product longer than so many hands need not be in view whole."""


def frame(context, *objects):
    """Frame `objects` in the 3D view in which it was asked for, or in all of the window; nothing in background."""
    if bpy.app.background or context.window is None:
        return
    asked = context.area
    areas = [asked] if asked is not None and asked.type == "VIEW_3D" else context.window.screen.areas
    points = corners(objects)
    for area in areas:
        if area.type == "VIEW_3D":
            _turn_to(area, points)


def frame_lost(context, hand_points, parts):
    """Frame a hand (`hand_points` gives (n, 3), world units) and product parts in the views that do not show them.

    Parts much longer than the hand do not count.
    """
    if bpy.app.background or context.window is None:
        return
    hand = hand_points()
    small = [part for part in parts if np.ptp(corners([part]), axis=0).max() <= MOST_HANDS * np.ptp(hand, axis=0).max()]
    points = np.concatenate([hand, corners(small)]) if small else hand
    box = _box(points)
    for area in context.window.screen.areas:
        if area.type == "VIEW_3D" and not is_seen(np.array(area.spaces.active.region_3d.perspective_matrix), box):
            _turn_to(area, points)


def is_seen(into_view, points):
    """Whether points (n, 3) lie within a view whose matrix (4, 4) leads from the world to its square, and fill enough
    of it."""
    flat = np.c_[points, np.ones(len(points))] @ into_view.T
    if (flat[:, 3] <= 0.0).any():
        return False
    flat = flat[:, :2] / flat[:, 3:]
    return bool((np.abs(flat) <= 1.0).all() and np.ptp(flat, axis=0).max() >= 2.0 * LEAST_SHARE)


def corners(objects):
    """World corners (n, 3) of the boxes of objects, units."""
    return np.array([obj.matrix_world @ Vector(corner) for obj in objects for corner in obj.bound_box])


def _box(points):
    """The eight corners of the box around points."""
    ends = np.stack([points.min(axis=0), points.max(axis=0)])
    return np.stack(np.meshgrid(*ends.T, indexing="ij"), axis=-1).reshape(8, 3)


def _turn_to(area, points):
    low, high = points.min(axis=0), points.max(axis=0)
    view = area.spaces.active.region_3d
    if view.view_perspective == "CAMERA":
        view.view_perspective = "PERSP"
    view.view_location = Vector((0.5 * (low + high)).tolist())
    view.view_distance = ROOM * 0.5 * float((high - low).max())
    area.tag_redraw()
