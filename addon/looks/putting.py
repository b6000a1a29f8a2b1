"""Puts display-only stand-ins of hand and product into the scene, the real ones out of sight, and all of it back.

Stand-ins are still meshes in a collection of their own. They cannot be selected or rendered and are marked as copies,
so that no solve, picture or export sees them. Real objects stay evaluated: they are hidden by the eye, or drawn as a
box. The state is kept on the collection, so that undo takes stand-ins and state back together.
"""

import json
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix

from ..hand_bones import bodies
from ..operators import display
from ..picture_stage import laying, views
from ..product_objects import copies
from ..scene import mesh, units

SURFACES = laying.SURFACES
"""Types of objects that have a surface."""
GLASS, OPENED, PALM, PRODUCT, APART = "GLASS", "OPENED", "PALM", "PRODUCT", "APART"
COLLECTION = "Thenar View"
_MATERIAL = "Thenar Glass"
_STATE = "thenar_look"
_TINT = (0.75, 0.87, 0.95, 0.16)
_SUBDIVIDING = frozenset({"SUBSURF", "MULTIRES"})
_STAYING = {"LIGHT", "LIGHT_PROBE", "SPEAKER"}
_GAP = 0.12
"""Room between hand and product when they lie apart, as a share of the hand's width."""


@dataclass(frozen=True)
class View:
    """Where to look from: the turn (3, 3) with rows across, up and away, and the corners (n, 3) to frame, units."""

    turn: np.ndarray
    points: np.ndarray


def kind_shown(context):
    """Which look the scene has; empty if none."""
    home = home_of(context)
    return "" if home is None else json.loads(home[_STATE])["kind"]


def put(context, kind):
    """Show the look `kind` instead of the one before. Returns the `View` to turn to; of `GLASS` the one from the palm.

    Raises `Refusal` where there is no pressure to look at.
    """
    take_back(context)
    hand, parts = context.scene.thenar.hand, _parts(context)
    found = _Frame.of(context, hand, kind)
    try:
        home = bpy.data.collections.new(COLLECTION)
        context.scene.collection.children.link(home)
        hidden, boxed = _put_away(context, found.stands_for(kind), [hand, *parts])
        home[_STATE] = json.dumps({"kind": kind, "hidden": hidden, "boxed": boxed})
        shown = _stand_ins(context, kind, (hand, parts, found), home)
        return View(found.turn(kind), shown)
    finally:
        found.forget()
        context.view_layer.update()


renewed_by = {}
"""Kind of a look that another room builds -> `renew(context)` of that room."""


def put_own(context, kind, build):
    """Show a look that another room builds: all is hidden, and `build(home)` adds what is seen to a collection.

    Returns what `build` returns; where it raises, nothing stays.
    """
    take_back(context)
    context.view_layer.update()
    home = bpy.data.collections.new(COLLECTION)
    context.scene.collection.children.link(home)
    hidden = [obj for obj in context.view_layer.objects if not obj.hide_get()]
    for obj in hidden:
        obj.hide_set(True)
    home[_STATE] = json.dumps({"kind": kind, "hidden": [obj.name for obj in hidden], "boxed": {}})
    try:
        return build(home)
    except BaseException:
        take_back(context)
        raise
    finally:
        context.view_layer.update()


def take_back(context):
    """Remove the stand-ins and show the real objects as they were. Returns whether there was a look."""
    home = home_of(context)
    if home is None:
        return False
    state = json.loads(home[_STATE])
    for name in state["hidden"]:
        obj = context.view_layer.objects.get(name)
        if obj is not None:
            obj.hide_set(False)
    for name, kind in state["boxed"].items():
        obj = bpy.data.objects.get(name)
        if obj is not None:
            obj.display_type = kind
    gone = list(home.objects)
    bpy.data.batch_remove([*gone, *{obj.data for obj in gone}])
    bpy.data.collections.remove(home)
    return True


def renew(context):
    """Bring the look to the map that is shown now; without one, or without a map, nothing stays of it."""
    kind, hand = kind_shown(context), context.scene.thenar.hand
    if not kind:
        return
    if kind in renewed_by:
        renewed_by[kind](context)
        return
    is_live = context.scene.thenar.live  # then the hand itself moves, and stand-ins would lag behind
    if hand is not None and not is_live and hand.thenar.shows_pressure and display.shown_objects(context):
        put(context, kind)
    else:
        take_back(context)


@dataclass
class _Frame:
    """The hand as posed and as opened, and the opened hand's axes (thumb, fingers, palm) in the world. Of a body both
    are its hand alone, `is_cut`."""

    hand: laying.Solid
    opened: laying.Solid
    axes: np.ndarray
    posed: np.ndarray
    is_cut: bool

    @classmethod
    def of(cls, context, hand, kind):
        """Of the scene's hand; its two meshes are of this object until they are used or forgotten.

        Whole only where the look `kind` shows them: else Blender would subdivide one hand more, which takes seconds.
        """
        is_cut = bodies.is_part_of_body(context, hand, display.workflow.product_parts(context.scene.thenar))
        is_whole = kind == APART or is_cut
        posed = laying.still(context, hand, "hand", True) if is_whole else laying.glimpse(context, hand, "hand")
        opened = laying.opened(context, hand, frozenset() if kind == OPENED else _SUBDIVIDING)
        for solid in (posed, opened) if is_cut else ():
            bodies.cut_out(context, hand, solid.mesh)
        scale = units.mm_per_unit(context.scene)
        subject = laying.Subject(posed, opened, [], [], scale)
        axes = views.opened_frame(context, subject)
        start, end = opened.points_mm(scale), posed.points_mm(scale)
        count = min(len(start), len(end))
        return cls(posed, opened, axes, (views.rotation(start[:count], end[:count]) @ axes.T).T, is_cut)

    def turn(self, kind):
        """The turn (3, 3) of the view on that look, fingers up."""
        _, up, away = self.axes if kind == OPENED else self.posed
        return views.turn(-away if kind == PRODUCT else away, up)

    def stands_for(self, kind):
        """The look whose real objects are put away: with a body's hand cut out, none of them stays in sight."""
        return OPENED if self.is_cut and kind in {GLASS, PALM} else kind

    def forget(self):
        """Remove the meshes that nothing wears."""
        for solid in (self.hand, self.opened):
            if not solid.mesh.users:
                bpy.data.meshes.remove(solid.mesh)


def _stand_ins(context, kind, scene, home):
    """Make what is shown instead of the real objects. Returns the corners (n, 3) that are to be seen, units."""
    hand, parts, found = scene
    if kind == OPENED:
        return _corners([_stand_in(home, hand, found.opened.mesh, Matrix(found.opened.matrix))])
    if kind == PRODUCT:
        return _corners(parts)
    if kind in {GLASS, PALM}:
        for part in parts:
            stand_in = _stand_in(home, part, still(context, part), part.matrix_world.copy())
            stand_in.data.materials.clear()
            stand_in.data.materials.append(_glass())
            for name in [each.name for each in stand_in.data.color_attributes]:
                stand_in.data.color_attributes.remove(stand_in.data.color_attributes[name])
        if found.is_cut:
            hand = _stand_in(home, hand, found.hand.mesh, Matrix(found.hand.matrix))
        return _corners([hand])
    shown = [_stand_in(home, hand, found.hand.mesh, Matrix(found.hand.matrix))]
    half_turn = _half_turn(found.posed, _corners(shown if found.is_cut else [hand]), _corners(parts))
    shown += [_stand_in(home, part, still(context, part), half_turn @ part.matrix_world) for part in parts]
    return _corners(shown)


def _half_turn(axes, hand, product):
    """Turns the product to show the side that the hand pressed, and lays it at the hand's far side from the thumb."""
    across, up, _ = axes
    middle = product.mean(axis=0)
    turn = 2.0 * np.outer(up, up) - np.eye(3)
    widths = np.ptp(hand @ across), np.ptp(product @ across)
    shift = (hand @ across).min() - _GAP * widths[0] - 0.5 * widths[1] - middle @ across
    moved = Matrix.Identity(4)
    for row in range(3):
        moved[row][:3] = turn[row].tolist()
    moved.translation = (middle + shift * across - turn @ middle).tolist()
    return moved


def _stand_in(home, obj, still, matrix):
    """A still mesh shown for `obj`, with the materials and colors that `obj` shows now."""
    stand_in = bpy.data.objects.new(f"{obj.name} (view)", still)
    still.materials.clear()
    for slot in obj.material_slots:
        still.materials.append(slot.material)
    if obj.type == "MESH" and obj.data.color_attributes.active_color is not None:
        index = still.color_attributes.find(obj.data.color_attributes.active_color.name)
        still.color_attributes.active_color_index = max(index, 0)
    stand_in.matrix_world = matrix
    stand_in.thenar.copy_of = obj.name
    stand_in.hide_select = stand_in.hide_render = True
    home.objects.link(stand_in)
    return stand_in


def still(context, obj):
    """A new mesh of the object as it is shown."""
    graph = context.evaluated_depsgraph_get()
    return bpy.data.meshes.new_from_object(obj.evaluated_get(graph), preserve_all_data_layers=True, depsgraph=graph)


def _put_away(context, kind, objects):
    """Take real objects out of sight. Returns the names of those hidden, and {name: display type} of those boxed."""
    if kind in {GLASS, PALM}:
        boxed = {obj.name: obj.display_type for obj in objects[1:]}
        for obj in objects[1:]:
            obj.display_type = "BOUNDS"
        return [], boxed
    stays = set(objects[1:]) if kind == PRODUCT else set()
    hidden = [
        obj
        for obj in context.view_layer.objects
        if obj.type not in _STAYING and obj not in stays and not obj.hide_get()
    ]
    for obj in hidden:
        obj.hide_set(True)
    return [obj.name for obj in hidden], {}


def _parts(context):
    """The product as it is seen: the copy that carries a part's map instead of the part."""
    found = []
    for part in display.workflow.product_parts(context.scene.thenar):
        copy = copies.find_copy(part.name)
        shown = copy if copy is not None and not copy.hide_viewport else part
        if shown.type in SURFACES:
            found.append(shown)
    return found


def _corners(objects):
    """World points (n, 3) of meshes and boxes, units."""
    found = []
    for obj in objects:
        matrix = np.array(obj.matrix_world)
        local = mesh.positions(obj.data) if obj.type == "MESH" and obj.thenar.copy_of else np.array(obj.bound_box)
        found.append(local @ matrix[:3, :3].T + matrix[:3, 3])
    return np.concatenate(found)


def _glass():
    material = bpy.data.materials.get(_MATERIAL)
    if material is None:
        material = bpy.data.materials.new(_MATERIAL)
        if material.node_tree is None:
            material.use_nodes = True
        shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
        shader.inputs["Base Color"].default_value = (*_TINT[:3], 1.0)
        shader.inputs["Roughness"].default_value = 0.1
        shader.inputs["Alpha"].default_value = _TINT[3]
        material.diffuse_color = _TINT
        material.surface_render_method = "BLENDED"
    return material


def home_of(context):
    """The collection of stand-ins that the scene shows, or None."""
    homes = context.scene.collection.children
    return next((home for home in homes if home.name.startswith(COLLECTION) and _STATE in home), None)
