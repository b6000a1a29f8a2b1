"""The order of a grasp fit in a scene: read hand and product, fit, write angles and places back."""

import re
from dataclasses import dataclass, replace

import numpy as np

from .. import native, workflow
from ..scene import checks, mesh, read, regions, sizes, units
from . import capsules, force, grasp, normals, pads, reading, roles

_PALM = re.compile("palm|thenar")
MOVES = ("HAND", "PRODUCT", "FINGERS")
"""What a fit may carry through the world; with FINGERS hand and product both stay."""


@dataclass(frozen=True)
class Fit:
    """A fit that was read from the scene; no Blender object is in it, so any thread may run it.

    `press` is the contact job that a force target repeats; None without one.
    """

    hand: grasp.Hand
    product: object
    product_mm: tuple
    wish: grasp.Wish
    force_n: float | None
    press: object
    names: tuple


def prepare(context, hand_object, parts, wish, force_n=None):
    """Read a hand on its armature and a product of several `parts`.

    Raises `checks.Refusal` (also `RigError`, `RoleError`) with a sentence for the user.
    """
    problem = native.problem() if native.module is None else ""
    if problem:
        raise checks.Refusal(problem)
    checks.check_hand(context, hand_object)
    checks.check_product(context, parts, hand_object)
    sizes.check_product_size(context, hand_object, parts)
    hand = read_hand(context, hand_object)
    scale = units.mm_per_unit(context.scene)
    product = read.read_product(context, parts, scale, np.zeros(3))
    gap = native.module.Product(product.vertices_mm, product.triangles)
    press = workflow.read_job(context, hand_object, parts) if force_n else None
    armature = reading.armature_of(hand_object)
    if wish.is_placed:
        wish = replace(wish, angles=reading.read_angles(armature, hand.rig, hand.joints))
    found = (hand_object.name, armature.name, tuple(part.name for part in parts))
    return Fit(hand, gap, (product.vertices_mm, product.triangles), wish, force_n, press, found)


def read_hand(context, hand_object):
    """The `grasp.Hand` of a mesh on an armature: bones by role, pads from the regions listed under Materials."""
    rig, role_names = reading.read_free_rig(context, hand_object)
    armature = reading.armature_of(hand_object)
    joints = roles.resolve(rig, role_names, reading.own_limits(armature, rig))
    rig = replace(rig, normals=normals.outward_normals(rig.vertices, mesh.triangles(hand_object.data)))
    skin = read_skin(context, hand_object, rig, joints)
    bodies = capsules.build(rig, joints, reading.tails(rig, armature))
    return grasp.Hand(rig, joints, pads.pads_of(rig, joints, skin), bodies)


def read_skin(context, hand_object, rig, joints):
    """Regions of the hand: its listed vertex groups, else the palm side of every bone."""
    listed = [material for material in hand_object.thenar.materials if material.name in hand_object.vertex_groups]
    if not listed:
        facing = normals.vertex_normals(rig.vertices, mesh.triangles(hand_object.data))
        mirrored = np.linalg.det(rig.world_from_rig[:3, :3]) < 0.0
        return pads.skin_from_bones(rig, joints, -facing if mirrored else facing)
    names = tuple(material.name for material in listed)
    kinds = tuple("palm" if _PALM.search(name.lower()) else "finger" for name in names)
    thickness = tuple(material.thickness_mm or pads.DEEP_MM for material in listed)
    return pads.Skin(regions.vertex_regions(context, hand_object, names), names, kinds, thickness)


def compute(fit, cancel=None, progress=None):
    """The grasp of a `Fit`. `cancel` has `is_set()`; `progress(stage, fraction)`. Raises `grasp.GraspError`."""
    watch = grasp.Watch(progress or grasp.ALONE.report, cancel)
    found = grasp.fit(fit.hand, fit.product, fit.product_mm[0], fit.wish, watch)
    if fit.force_n is None:
        return found
    return force.reach(fit, found, watch)


def finish(context, fit, found, moves):
    """Write a grasp into the scene: bones, and the place of hand or product. Raises `checks.Refusal`."""
    hand_name, armature_name, part_names = fit.names
    objects = context.scene.objects
    missing = [name for name in (hand_name, armature_name, *part_names) if name not in objects]
    if missing:
        raise checks.Refusal(f"{missing[0]!r} was removed while the grasp was fitted; fit again")
    armature = objects[armature_name]
    scale = units.mm_per_unit(context.scene)
    reading.write_angles(armature, fit.hand.rig, fit.hand.joints, found.angles)
    if moves == "HAND":
        reading.move_object(armature, found.place, scale)
        if objects[hand_name].parent != armature and reading.top_of(objects[hand_name]) != reading.top_of(armature):
            reading.move_object(objects[hand_name], found.place, scale)
    elif moves == "PRODUCT":
        for top in {reading.top_of(objects[name]) for name in part_names}:
            reading.move_object(top, np.linalg.inv(found.place), scale)
    context.view_layer.update()
