"""Takes hand, product and what belongs to them out of a scene as still meshes, posed and opened, with their map.

Changes the open file: it is called in a file that is thrown away afterwards.
"""

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from .. import names
from ..hand_bones import bodies
from ..operators import display
from ..ownership import own
from ..scene import mesh, units
from ..scene.checks import Refusal
from ..skin_display import shading

SURFACES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}
"""Types of objects that have a surface."""
_OURS = {names.LIVE_MODIFIER, names.SHOWN_MODIFIER, names.BAKE_MODIFIER}


@dataclass
class Solid:
    """A still mesh, its place (4, 4), world units, what it is (`hand`, `product` or `other`), and if it has a map."""

    mesh: Any
    matrix: Any
    kind: str
    has_map: bool

    def points_mm(self, scale):
        """Corners (n, 3) of its faces in the world, mm; `scale`: mm per unit."""
        found = mesh.positions(self.mesh).astype(np.float64)
        return (found @ self.matrix[:3, :3].T + self.matrix[:3, 3]) * scale

    def normals(self):
        """World normals (n, 3) of its vertices, of unit length."""
        out = np.empty(len(self.mesh.vertices) * 3, np.float32)
        self.mesh.vertex_normals.foreach_get("vector", out)
        turned = out.reshape(-1, 3) @ np.linalg.inv(self.matrix[:3, :3])
        return turned / np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-12)

    def field(self, name):
        """Values (n,) of a point attribute; zeros where it has none."""
        attribute = self.mesh.attributes.get(name)
        out = np.zeros(len(self.mesh.vertices), np.float32)
        if attribute is not None and attribute.domain == "POINT" and attribute.data_type == "FLOAT":
            attribute.data.foreach_get("value", out)
        return out

    def is_clear(self):
        """Whether light passes through one of its materials, so that what lies behind is seen."""
        trees = [material.node_tree for material in self.mesh.materials if material is not None and material.node_tree]
        return any(
            node.type in {"BSDF_TRANSPARENT", "BSDF_GLASS", "BSDF_REFRACTION"}
            or (node.type == "BSDF_PRINCIPLED" and node.inputs["Transmission Weight"].default_value > 0.5)
            for tree in trees
            for node in tree.nodes
        )


@dataclass
class Subject:
    """What a picture shows: the gripping hand, the hand opened, product parts, and what is joined to them."""

    hand: Solid
    opened: Solid
    product: list
    others: list
    scale: float
    """mm per unit."""

    def gripped(self):
        """Everything as it stands in the scene."""
        return [self.hand, *self.product, *self.others]


def gather(context):
    """The scene's `Subject`. Raises `Refusal` where hand or pressure are missing."""
    settings = context.scene.thenar
    carriers = dict(display.shown_objects(context))
    hand = settings.hand
    if hand is None or hand not in carriers:
        raise Refusal("there is no pressure yet; press Solve first")
    display.hide(context)
    context.view_layer.update()
    product = [_product(context, obj) for obj, is_skin in carriers.items() if not is_skin]
    copied = {obj.thenar.copy_of for obj in carriers}
    plain = [part for part in display.workflow.product_parts(settings) if part not in carriers]
    product += [still(context, part, "product", False) for part in plain if part.name not in copied]
    parts = display.workflow.product_parts(settings)
    is_body = bodies.is_part_of_body(context, hand, parts)
    # Clothes, eyes and hair hang on a body: of it the hand alone is shown.
    tops = {_top(obj) for obj in (hand, *parts)} - ({_top(hand)} if is_body else set())
    taken = {hand, *carriers, *parts}
    others = [
        still(context, obj, "other", False)
        for obj in context.scene.objects
        if obj.type in SURFACES and obj not in taken and _top(obj) in tops and not obj.hide_render and obj.visible_get()
    ]
    shown = [still(context, hand, "hand", True), opened(context, hand)]
    if is_body:
        for solid in shown:
            bodies.cut_out(context, hand, solid.mesh)
    return Subject(*shown, product, others, units.mm_per_unit(context.scene))


def _product(context, obj):
    if not obj.thenar.copy_of:
        return still(context, obj, "product", True)
    return Solid(obj.data.copy(), np.array(obj.matrix_world, float), "product", True)


def still(context, obj, kind, has_map):
    """The object as it is evaluated now."""
    graph = context.evaluated_depsgraph_get()
    made = bpy.data.meshes.new_from_object(obj.evaluated_get(graph), preserve_all_data_layers=True, depsgraph=graph)
    _dress(made, shading.own_materials(obj) if obj.type == "MESH" else [slot.material for slot in obj.material_slots])
    return Solid(made, np.array(obj.matrix_world, float), kind, has_map)


def glimpse(context, obj, kind):
    """The same for its points and fields alone: Blender then gives what it has, and evaluates nothing again."""
    graph = context.evaluated_depsgraph_get()
    made = bpy.data.meshes.new_from_object(obj.evaluated_get(graph), depsgraph=graph)
    return Solid(made, np.array(obj.matrix_world, float), kind, True)


def opened(context, hand, without=frozenset()):
    """The hand in its rest pose, without the contact's shape and without modifiers of the types `without`."""
    copy = hand.copy()
    copy.data = hand.data.copy()
    context.scene.collection.objects.link(copy)
    try:
        for modifier in list(copy.modifiers):
            if modifier.type in {"ARMATURE", *without} or modifier.name in _OURS:
                copy.modifiers.remove(modifier)
        key = own.contact_key(copy)
        if key is not None:
            key.mute = True
        context.view_layer.update()
        return still(context, copy, "hand", True)
    finally:
        data = copy.data
        bpy.data.objects.remove(copy)
        bpy.data.meshes.remove(data)


def _dress(made, materials):
    """The user's own materials in the mesh's slots; what stood there before goes."""
    indices = np.zeros(len(made.polygons), np.int32)
    made.polygons.foreach_get("material_index", indices)
    made.materials.clear()
    for material in materials:
        made.materials.append(material)
    made.polygons.foreach_set("material_index", np.minimum(indices, max(len(materials) - 1, 0)))


def _top(obj):
    while obj.parent is not None:
        obj = obj.parent
    return obj
