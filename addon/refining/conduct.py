"""One refinement from start to end: read hand and product, plan, take the old contact off, cut the mesh."""

from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial

import numpy as np

from .. import cache, native, workflow
from ..hand_shape import editing
from ..ownership import own
from ..scene import read
from ..scene.checks import Refusal
from . import cutting, guards, planning


@dataclass(frozen=True)
class Refined:
    """What was done: vertices of the hand and median edge near the product, mm, each before and after."""

    hand_name: str
    part_names: tuple
    vertices: tuple
    spacing_mm: tuple


def steps(context, spacing_mm):
    """One refinement as the steps of a computation (`addon/steps.py`). Returns a `Refined`.

    `spacing_mm`: longest edge near the product, or 0 to halve the spacing where the product is finer than the skin. The
    contact on the hand is cleared. Raises `Refusal`; nothing has changed then.
    """
    hand, parts = workflow.check(context)
    guards.check(context, hand)
    listed = [material.name for material in hand.thenar.materials]
    workflow.check_groups(hand, listed)
    with ExitStack() as taken:
        # A product that a force target has moved is read where it stands: the contact is there.
        own.take_out(context, hand, (), taken)
        skin = read.read_hand(context, hand, listed)
        product = read.read_product(context, parts, skin.scale, skin.origin_mm)
    count, part_names = len(skin.rest_mm), tuple(part.name for part in parts)
    names = f"'{hand.name}'", ", ".join(f"'{name}'" for name in part_names)
    mesh = _mesh(hand, skin)
    found = yield partial(_planned, mesh, product, (names, spacing_mm))
    if context.scene.thenar.hand != hand or len(hand.data.vertices) != count:
        raise Refusal(f"'{hand.name}' was changed while its refinement was planned; press Refine Skin again")
    editing.clear_contact(context, hand)
    cutting.cut(hand, found.levels, (listed, _deforming(hand)))
    refusal = context.scene.thenar.refusal
    refusal.text = refusal.vertices = ""
    context.view_layer.update()
    vertices = count, len(hand.data.vertices)
    return Refined(hand.name, part_names, vertices, (found.before_mm, found.after_mm))


def _planned(mesh, product, asked, cancel=None, progress=None):
    prepared = cache.product(
        cache.content_hash(product.vertices_mm, product.triangles),
        lambda: native.module.Product(product.vertices_mm, product.triangles),
    )
    return planning.plan(mesh, prepared, asked, cancel, progress)


def _mesh(hand, skin):
    """The `planning.Mesh` of the hand as it was read."""
    data = hand.data
    owner = np.empty(len(data.loop_triangles), np.int32)
    data.loop_triangles.foreach_get("polygon_index", owner)
    corners = np.empty(len(data.polygons), np.int32)
    data.polygons.foreach_get("loop_total", corners)
    place = np.unique(read.rest_positions(hand), axis=0, return_inverse=True)[1].ravel()
    return planning.Mesh(skin.posed_mm, skin.triangles, owner, corners == 3, skin.regions, place)


def _deforming(hand):
    """Names of the bones that move the hand."""
    rigs = [modifier.object for modifier in hand.modifiers if modifier.type == "ARMATURE" and modifier.object]
    return {bone.name for rig in rigs for bone in rig.data.bones if bone.use_deform}
