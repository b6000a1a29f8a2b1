"""The picture *Wrapped and unrolled*: the product in the hand, and its surface unrolled about its long axis."""

import bpy
import numpy as np

from .. import names
from ..picture_stage import laying, page, stage, views
from ..scene import mesh
from ..scene.checks import Refusal
from . import grip_and_print
from . import order as orders

_WRAPPED, _FLAT = (60.0, 128.0, 900.0, 750.0), (980.0, 128.0, 880.0, 750.0)
_END = 0.75
"""Least share of a normal along the axis at which a face belongs to an end, which does not unroll."""
_NARROW = 12.0
"""How much nearer pressure weighs where the seam is placed: half as much 20 degrees away."""
_RELIEF = 0.02
"""Height of what is drawn over its distance from the axis: outer faces cover inner ones."""


def draw(order, subject, context):
    """The page, whose units are 1/1080 of its height."""
    view = views.of_grip(context, subject)
    flat, radius = unrolled(subject, view[1])
    sheet = page.Page(grip_and_print.WIDTH, grip_and_print.HEIGHT, stage.PAGE)
    parts = ((_WRAPPED, subject.gripped(), view), (_FLAT, [flat], np.eye(3)))
    mm = grip_and_print.lay(sheet, (subject, context), parts, orders.Progress(order))
    words = ("Wrapped", f"Unrolled about its long axis, seen from outside; arcs at a radius of {radius:.1f} mm")
    for part, caption in zip(parts, words, strict=True):
        box = part[0]
        sheet.text((box[0] + box[2] / 2.0, box[1] + 2.0, "center"), 22.0, caption, page.FAINT)
    grip_and_print.head(sheet, context, order.is_stale)
    page.add_scale_bar(sheet, (grip_and_print.MARGIN, 52.0), mm * order.factor, 220.0)
    page.add_legend(sheet, context.scene.thenar, grip_and_print.LEGEND)
    return sheet


def unrolled(subject, up):
    """The product's surface unrolled, as a `laying.Solid` in the page's frame, and the radius of its arcs, mm.

    `up` (3,): which end of the axis is up. The seam lies where least is pressed. Raises
    `Refusal` where nothing is pressed.
    """
    parts = [part for part in subject.product if part.has_map]
    if not parts:
        raise Refusal("the product carries no pressure; press Solve again")
    points = np.concatenate([part.points_mm(subject.scale) for part in parts])
    pressure = np.concatenate([part.field(names.PRESSURE_KPA) for part in parts])
    if pressure.sum() <= 0.0:
        raise Refusal("nothing presses on the product, so there is nothing to unroll; solve a contact that touches")
    frame = _frame(points, pressure, up)
    local = (points - points.mean(axis=0)) @ frame.T
    distance = np.hypot(local[:, 0], local[:, 2])
    radius = float(np.average(distance, weights=pressure))
    faces = _sides(parts, points, frame[1])
    angle = np.arctan2(local[:, 0], local[:, 2])[faces]
    angle = angle[:, :1] + (angle - angle[:, :1] + np.pi) % (2.0 * np.pi) - np.pi  # a face stays whole at the seam
    places = np.stack([radius * angle, local[faces, 1], _RELIEF * distance[faces]], axis=-1)
    edge = np.concatenate([part.field(names.EDGE_MM) for part in parts])
    made = _mesh(places.reshape(-1, 3) / subject.scale)
    for name, values in ((names.PRESSURE_KPA, pressure), (names.EDGE_MM, edge)):
        made.attributes.new(name, "FLOAT", "POINT").data.foreach_set("value", values[faces.ravel()].astype(np.float32))
    for material in list(parts[0].mesh.materials)[:1]:
        made.materials.append(material)
    return laying.Solid(made, np.eye(4), "product", True), radius


def _frame(points, pressure, up):
    """Rows (3, 3): across, along the long axis, and from the axis away from the seam."""
    long = views.long_axis(points)
    long = np.asarray(up, float) if long is None else long
    long = long * (np.sign(long @ up) or 1.0)
    across = views.turn(long, np.eye(3)[np.abs(long).argmin()])
    seen = (points - points.mean(axis=0)) @ across.T
    angle = np.arctan2(seen[:, 1], seen[:, 0])
    seam = _seam(angle[pressure > 0.0], pressure[pressure > 0.0])
    middle = -(np.cos(seam) * across[0] + np.sin(seam) * across[1])
    return np.stack([np.cross(long, middle), long, middle])


def _seam(angle, pressure):
    """The angle around which least is pressed."""
    tried = np.arange(0.0, 2.0 * np.pi, np.radians(1.0))
    near = np.exp(_NARROW * (np.cos(tried[:, None] - angle[None, :]) - 1.0))
    return tried[(near @ pressure).argmin()]


def _sides(parts, points, axis):
    """Triangles (m, 3) of all parts that do not lie across the axis."""
    first, found = 0, []
    for part in parts:
        found.append(mesh.triangles(part.mesh) + first)
        first += len(part.mesh.vertices)
    faces = np.concatenate(found)
    a, b, c = (points[faces[:, corner]] for corner in range(3))
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    return faces[np.abs(normal @ axis) < _END * np.maximum(size, 1e-12)]


def _mesh(places):
    """A mesh of triangles that share no corners."""
    made = bpy.data.meshes.new("Thenar Unrolled")
    made.from_pydata(places.tolist(), [], np.arange(len(places)).reshape(-1, 3).tolist())
    return made
