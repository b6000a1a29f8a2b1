"""From where parts are seen: turns into the page's frame, whose rows are across, up, and towards the eye."""

import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ..hand_bones import bodies
from ..scene import mesh, units

_GRIP_AWAY, _GRIP_UP = (0.15, 0.08, 0.98), (0.92, 0.32, -0.2)
"""The view of a grip in the opened hand's frame (thumb's side, fingers, palm): it sees fingers close over a product."""
_BACK_AWAY = (0.35, -0.25, -0.9)
"""The same where the product hides the hand from the palm's side."""
_LEAST_SEEN = 0.55
"""Share of the hand that a view has to show: of the samples, a 100 mm cylinder hides more, the others less."""
_SAMPLED = 600
_FRAMED = 0.1
"""Share of the picture's width that the hand spans in a camera that was placed for it."""


def turn(away, up):
    """Rows (3, 3) across, up and away of a view from `away` on which `up` points up; both are world directions."""
    away = np.asarray(away, float) / np.linalg.norm(away)
    up = np.asarray(up, float)
    up = up - away * (up @ away)
    if np.linalg.norm(up) < 1e-6:
        up = np.eye(3)[np.abs(away).argmin()]
        up = up - away * (up @ away)
    up /= np.linalg.norm(up)
    return np.stack([np.cross(up, away), up, away])


def long_axis(points):
    """The axis along which points (n, 3) reach furthest, or None where they reach about as far across."""
    centred = points - points.mean(axis=0)
    _, sizes, axes = np.linalg.svd(centred[:: max(1, len(centred) // 4000)], full_matrices=False)
    return axes[0] if sizes[0] > 1.3 * sizes[1] else None


def rotation(start, end):
    """The rotation (3, 3) that takes points `start` (n, 3) nearest to `end` (n, 3)."""
    a, b = start - start.mean(axis=0), end - end.mean(axis=0)
    u, _, v = np.linalg.svd(b.T @ a)
    return u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ v))]) @ v


def opened_frame(context, subject):
    """The opened hand's own frame: rows (3, 3) towards the thumb, along the fingers, out of the palm; world axes."""
    points, force = subject.opened.points_mm(subject.scale), subject.hand.field("contact_force_n")
    count = min(len(force), len(points))
    long = long_axis(points)
    long = np.array([0.0, 1.0, 0.0]) if long is None else long
    long = long * np.sign(long @ _towards_tips(context, points, force[:count]) or 1.0)
    palm = (subject.opened.normals()[:count] * force[:count, None]).sum(axis=0)
    palm = palm - long * (palm @ long)
    palm = palm / np.linalg.norm(palm) if np.linalg.norm(palm) > 1e-9 else turn(long, (0, 0, 1))[1]
    across = np.cross(long, palm)
    side = (points - points.mean(axis=0)) @ across
    return np.stack([across * (np.sign((side**3).mean()) or 1.0), long, palm])


def _towards_tips(context, points, force):
    along = bodies.along_fingers(context.scene.thenar.hand)
    if along is not None:
        return along
    for modifier in context.scene.thenar.hand.modifiers:
        if modifier.type == "ARMATURE" and modifier.object is not None:
            rig, bones = modifier.object, modifier.object.data.bones
            roots = [rig.matrix_world @ bone.head_local for bone in bones if bone.parent is None]
            tips = [rig.matrix_world @ bone.tail_local for bone in bones if not bone.children]
            return np.mean(tips, axis=0) - np.mean(roots, axis=0)
    middle = (points[: len(force)] * force[:, None]).sum(axis=0) / max(force.sum(), 1e-12)
    return middle - points.mean(axis=0)


def of_print(context, subject):
    """The view on the palm of the opened hand, fingers up."""
    _, long, palm = opened_frame(context, subject)
    return turn(palm, long)


def of_grip(context, subject):
    """The view on the gripping hand: of the scene's camera where it frames the hand, else over the closed fingers."""
    camera = _framing_camera(context, subject)
    if camera is not None:
        return camera
    frame = opened_frame(context, subject)
    start, end = subject.opened.points_mm(subject.scale), subject.hand.points_mm(subject.scale)
    count = min(len(start), len(end))
    turned = rotation(start[:count], end[:count]) @ frame.T
    found = turn(turned @ _GRIP_AWAY, turned @ _GRIP_UP)
    found = turn(found[2], _upright(subject, found))
    if seen_share(subject, found[2]) >= _LEAST_SEEN:
        return found
    return turn(turned @ _BACK_AWAY, found[1])


def _upright(subject, view):
    """The product's long axis where the view shows its length, else the view's own up."""
    long = long_axis(np.concatenate([part.points_mm(subject.scale) for part in subject.product]))
    if long is None or abs(long @ view[2]) > 0.5 or abs(long @ view[1]) < 0.5:
        return view[1]
    return long * np.sign(long @ view[1])


def seen_share(subject, away):
    """Share of the hand's corners that no opaque part hides from an eye far away in the direction `away`."""
    trees = [
        BVHTree.FromPolygons(part.points_mm(subject.scale).tolist(), mesh.triangles(part.mesh).tolist())
        for part in subject.product
        if not part.is_clear()
    ]
    points, normals = subject.hand.points_mm(subject.scale), subject.hand.normals()
    step = max(1, len(points) // _SAMPLED)
    points, facing = points[::step], normals[::step] @ away > 0.0
    direction = Vector(away)
    seen = [
        all(tree.ray_cast(Vector(point + 0.5 * away), direction)[0] is None for tree in trees)
        for point in points[facing]
    ]
    return float(np.mean(seen)) if seen else 0.0


def _framing_camera(context, subject):
    """The turn of the scene's camera, if the hand stands in its picture and spans enough of it."""
    scene, camera = context.scene, context.scene.camera
    if camera is None or camera.type != "CAMERA" or camera.data.type == "PANO":
        return None
    render = scene.render
    view = np.array(camera.matrix_world.normalized().inverted())
    lens = np.array(
        camera.calc_matrix_camera(context.evaluated_depsgraph_get(), x=render.resolution_x, y=render.resolution_y)
    )
    points = subject.hand.points_mm(subject.scale) / units.mm_per_unit(scene)
    seen = np.column_stack([points, np.ones(len(points))]) @ (lens @ view).T
    if (seen[:, 3] <= 0.0).any():
        return None
    flat = seen[:, :2] / seen[:, 3:]
    inside = (np.abs(flat) <= 1.0).all(axis=1).mean()
    if inside < 0.9 or np.ptp(flat[:, 0]) < 2.0 * _FRAMED:
        return None
    axes = np.array(camera.matrix_world.to_3x3().normalized())
    return turn(axes[:, 2], axes[:, 1])
