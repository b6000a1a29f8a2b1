"""The operators of the view buttons; they leave no undo step, for they change nothing but what is looked at."""

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix, Vector
from mathutils.bvhtree import BVHTree

from .. import languages, names
from ..operators import display, polling, running
from ..scene import attributes, mesh
from . import putting

KINDS = (
    (putting.OPENED, "Hand Opened", "The hand in its rest pose with the map on it, seen from the palm", 1),
    (putting.PALM, "Palm", "The gripping hand seen from its palm, through the product as glass", 2),
    (putting.PRODUCT, "Product", "The product alone with its map, from the side of the hand", 3),
    (putting.APART, "Apart", "Hand and product next to each other, both with the side that was pressed", 4),
    (putting.GLASS, "Glass", "The product as glass; the view turns to the palm where it sees nothing of the print", 5),
)
_ROOM, _WIDE = 1.15, 1.3
"""Distance of the view over the height of what is seen, and over its width: the sidebar covers a part."""
SEEN, FACED = 0.1, 0.2
"""Least share of the pressed skin that a view shall see, and from which cosine skin faces it."""
RAYS, OFF = 600, 2e-3
"""How many vertices are looked at, and how far off the skin a line of sight begins, as a share of its length."""
_before = {}
"""Area -> the view before the first look, to give back."""


class THENAR_OT_look(bpy.types.Operator):
    """Look at the result from another side; hand, product and result stay as they are"""

    bl_idname = "thenar.look"
    bl_label = "Look At"
    bl_options = {"REGISTER"}

    kind: bpy.props.EnumProperty(name="Look At", description="What is looked at", items=KINDS)

    @classmethod
    def description(cls, context, properties):
        """The look's own meaning as the tooltip."""
        return languages.tip(next(row[2] for row in KINDS if row[0] == properties.kind))

    @classmethod
    def poll(cls, context):
        problems = (polling.no_hand(context), no_map(context), polling.busy(), polling.live(context))
        return polling.allows(cls, *problems, polling.wrong_mode(context))

    def execute(self, context):
        if not context.scene.thenar.hand.thenar.shows_pressure:
            display.show(context)
        view = running.attempt(self, putting.put, context, self.kind)
        if view is not None and not (self.kind == putting.GLASS and is_print_seen(context)):
            turn_to(context, view)
        running.redraw(context)
        return {"FINISHED"}


class THENAR_OT_look_back(bpy.types.Operator):
    """Show hand and product as they are in the scene, and turn the view back"""

    bl_idname = "thenar.look_back"
    bl_label = "Back to Scene"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context):
        return polling.allows(cls, "" if putting.kind_shown(context) else "the scene is shown as it is")

    def execute(self, context):
        putting.take_back(context)
        for view, (rotation, location, distance, perspective) in _views(context):
            view.view_rotation, view.view_location, view.view_distance = rotation, location, distance
            view.view_perspective = perspective
        _before.clear()
        running.redraw(context)
        return {"FINISHED"}


def no_map(context):
    """Nothing carries pressure."""
    return "" if display.shown_objects(context) else "there is no pressure yet; press Solve first"


def is_print_seen(context):
    """Whether a 3D view sees at least `SEEN` of the pressed skin, by pressure; true where there is no window."""
    if bpy.app.background or context.window is None:
        return True
    hand = context.scene.thenar.hand
    with mesh.evaluated_mesh(hand, context.evaluated_depsgraph_get()) as shown:
        skin = Skin(mesh.positions(shown), np.empty((len(shown.vertices), 3), np.float32), mesh.triangles(shown))
        shown.vertex_normals.foreach_get("vector", skin.normals.reshape(-1))
        pressed = attributes.read(shown, names.PRESSURE_KPA)
    if pressed is None or len(pressed) != len(skin.points):
        return True
    into = np.array(hand.matrix_world)[:3, :3]
    places = [area.spaces.active.region_3d for area in context.window.screen.areas if area.type == "VIEW_3D"]
    return any(seen_share(skin, pressed, np.array(place.view_matrix)[2, :3] @ into) >= SEEN for place in places)


@dataclass(frozen=True)
class Skin:
    """Points (n, 3), vertex normals (n, 3) and triangles (m, 3) of a surface."""

    points: np.ndarray
    normals: np.ndarray
    triangles: np.ndarray


def seen_share(skin, pressure, away):
    """Share, by pressure (n,), of a `Skin` that an eye sees which is far off in the direction `away` (3): it faces the
    eye, and no other skin is in between. At most `RAYS` vertices are looked at."""
    tree = BVHTree.FromPolygons(skin.points.tolist(), skin.triangles.tolist())
    used = np.flatnonzero(pressure > 0.0)
    used = used[:: max(len(used) // RAYS, 1)]
    away = away / max(np.linalg.norm(away), 1e-12)
    off = OFF * float(np.ptp(skin.points, axis=0).max())
    seen = [
        bool(skin.normals[k] @ away > FACED)
        and tree.ray_cast(Vector((skin.points[k] + off * skin.normals[k]).tolist()), Vector(away.tolist()))[0] is None
        for k in used
    ]
    return float(pressure[used][seen].sum() / max(pressure[used].sum(), 1e-12))


def turn_to(context, view):
    """Turn the 3D view of the button, else all, to the look, and remember how it was."""
    if bpy.app.background or context.window is None:
        return
    asked = context.area
    areas = [asked] if asked is not None and asked.type == "VIEW_3D" else context.window.screen.areas
    low, high = view.points.min(axis=0), view.points.max(axis=0)
    wide, tall = ((view.points @ axis).max() - (view.points @ axis).min() for axis in view.turn[:2])
    for area in areas:
        if area.type != "VIEW_3D":
            continue
        place = area.spaces.active.region_3d
        kept = (place.view_rotation.copy(), place.view_location.copy(), place.view_distance, place.view_perspective)
        _before.setdefault(area.as_pointer(), kept)
        if place.view_perspective == "CAMERA":
            place.view_perspective = "PERSP"
        place.view_rotation = Matrix(view.turn.T.tolist()).to_quaternion()
        place.view_location = Vector((0.5 * (low + high)).tolist())
        place.view_distance = _ROOM * float(max(_WIDE * wide, tall))


def _views(context):
    """(3D view, how it was) of every view that was turned and is still there."""
    for area in context.window.screen.areas if context.window is not None else ():
        if area.type == "VIEW_3D" and area.as_pointer() in _before:
            yield area.spaces.active.region_3d, _before[area.as_pointer()]


CLASSES = (THENAR_OT_look, THENAR_OT_look_back)
