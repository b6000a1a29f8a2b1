"""Whether a hand is part of a body, and which skin of the body is the hand's."""

from itertools import compress
from types import SimpleNamespace

import bmesh
import numpy as np

from ..rigs.chains import Skeleton
from ..rigs.recognise import recognise
from ..scene import mesh, units
from ..scene.regions import group_weights
from . import bonemap, reading, roles
from .rig_axes import RigError

REACH = 9.0
"""Skin farther from the knuckles than so many times the distance of the outer knuckles belongs to a body. An elbow is
at 6.5 and a shoulder at 12.8 (hand after Buchholz 1992, arm after Drillis & Contini 1966): a forearm is no body."""

ONE_FINGER_MM = 55.0
"""Distance taken for a hand with one knuckle."""

LEAST_SHARE = 0.5
"""Skin is the hand's where the wrist and the bones below carry at least this share of its weight."""


def is_part_of_body(context, hand, parts=()):
    """Whether the armature of `hand` carries another hand, or skin beyond a forearm; `parts` are no skin."""
    try:
        armature = reading.armature_of(hand)
    except RigError:
        return False
    found = recognise(_skeleton(armature, hand), bonemap.side_of(armature))
    knuckles = _knuckles(armature, _known(armature, found))
    if not len(knuckles):
        return False
    limit = REACH * _breadth(context, armature, knuckles)
    into = np.linalg.inv(np.array(armature.matrix_world))
    for skin in _skins(context, armature, hand):
        if skin in parts:
            continue
        matrix = into @ np.array(skin.matrix_world)
        points = _surface(skin.data) @ matrix[:3, :3].T + matrix[:3, 3]
        if (np.linalg.norm(points - knuckles.mean(axis=0), axis=1) > limit).any():
            return True
    # A file of one hand may keep the other one's groups, without skin.
    return len(found.hands) > 1 and len(recognise(reading.skeleton_of(context, hand)).hands) > 1


def along_fingers(hand):
    """World direction (3) from the knuckles to the last bones of the fingers at rest; None where they are not known."""
    try:
        rig = reading.armature_of(hand)
    except RigError:
        return None
    known, bones = _known(rig, recognise(_skeleton(rig, hand), bonemap.side_of(rig))), rig.data.bones
    pairs = [(known.get(f"{finger}_proximal", ""), known.get(f"{finger}_distal", "")) for finger in roles.FINGERS]
    found = [np.array(bones[b].head_local - bones[a].head_local) for a, b in pairs if a in bones and b in bones]
    return np.array(rig.matrix_world)[:3, :3] @ np.mean(found, axis=0) if found else None


def hand_skin(context, hand, surface):
    """Which vertices (n,) of a mesh with the groups of `hand` are its hand's: wrist and bones below carry them."""
    armature = reading.armature_of(hand)
    known = bonemap.get_map(armature) or _known(armature, recognise(_skeleton(armature, hand)))
    own = _below(armature, known)
    groups = [bone.name for bone in armature.data.bones if bone.use_deform and bone.name in hand.vertex_groups]
    weights = group_weights(context, SimpleNamespace(data=surface), groups)
    inside = weights[[name in own for name in groups]].sum(axis=0)
    return inside >= LEAST_SHARE * np.maximum(weights.sum(axis=0), 1e-6)


def hand_points(context, hand):
    """World positions (n, 3) of the hand's skin as it is posed, units; of a body that of its hand alone."""
    count = len(hand.data.vertices)
    posed = mesh.evaluated_positions(hand, context.evaluated_depsgraph_get(), count)
    world = np.array(hand.matrix_world)
    if is_part_of_body(context, hand):
        found = hand_skin(context, hand, hand.data)
        posed = posed[found] if found.any() else posed
    return posed @ world[:3, :3].T + world[:3, 3]


def cut_out(context, hand, surface):
    """Remove from a still mesh with the groups of `hand` all that is not its hand; the order of the rest stays."""
    found = hand_skin(context, hand, surface)
    if not found.any():
        return
    work = bmesh.new()
    try:
        work.from_mesh(surface)
        bmesh.ops.delete(work, geom=list(compress(work.verts, ~found)), context="VERTS")
        work.to_mesh(surface)
    finally:
        work.free()


def _known(armature, found):
    return bonemap.get_map(armature) or (found.chosen.roles if found.chosen is not None else {})


def _skeleton(armature, hand):
    """The armature's bones; each that has a vertex group of the hand's mesh carries the same share of skin."""
    bones = reading.ordered(armature)
    names = tuple(bone.name for bone in bones)
    places = {name: number for number, name in enumerate(names)}
    parents = np.array([places[bone.parent.name] if bone.parent else -1 for bone in bones])
    heads = np.array([bone.head_local for bone in bones], dtype=np.float64)
    skin = np.array([float(bone.use_deform and bone.name in hand.vertex_groups) for bone in bones])
    return Skeleton(names, parents, heads, skin)


def _knuckles(armature, known):
    """Rest places (k, 3) of the fingers' knuckles in the armature's space."""
    named = [known.get(f"{finger}_proximal", "") for finger in roles.FINGERS]
    found = [armature.data.bones[name].head_local for name in named if name in armature.data.bones]
    return np.array(found, dtype=np.float64).reshape(-1, 3)


def _breadth(context, armature, knuckles):
    """Distance of the outer knuckles in the armature's space."""
    if len(knuckles) > 1:
        return float(np.linalg.norm(knuckles[0] - knuckles[-1]))
    size = np.cbrt(abs(np.linalg.det(np.array(armature.matrix_world)[:3, :3]))) or 1.0
    return ONE_FINGER_MM / units.mm_per_unit(context.scene) / size


def _skins(context, armature, hand):
    """The meshes that the armature, or an armature that carries it, bends; the hand's first."""
    rigs, above = {armature}, armature.parent
    while above is not None:
        if above.type == "ARMATURE":
            rigs.add(above)
        above = above.parent
    yield hand
    for obj in context.scene.objects:
        if obj.type != "MESH" or obj == hand or obj.thenar.copy_of:
            continue
        if any(modifier.type == "ARMATURE" and modifier.object in rigs for modifier in obj.modifiers):
            yield obj


def _surface(data):
    """Positions (n, 3) of the vertices that faces use."""
    points = mesh.positions(data).astype(np.float64)
    return points[mesh.is_used(mesh.triangles(data), len(points))]


def _below(armature, known):
    """Names of the wrist and every bone below; without a wrist, of the bone that all digits hang on."""
    bones = armature.data.bones
    tops = [bones[known[roles.WRIST]]] if known.get(roles.WRIST, "") in bones else []
    if not tops:
        digits = [bones[name] for name in known.values() if name in bones]
        above = [each for each in digits[0].parent_recursive if all(each in one.parent_recursive for one in digits)]
        tops = above[:1] or digits
    return {each.name for top in tops for each in (top, *top.children_recursive)}
