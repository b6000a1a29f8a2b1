"""The order of a grasp fit in a scene: read hand and product, fit, write angles and places back."""

import re
from contextlib import ExitStack
from dataclasses import dataclass, replace

import numpy as np
from mathutils import Matrix

from .. import native, workflow
from ..grasp_choices import facts
from ..grasp_fit import fitter, walls
from ..grasp_fit.task import Goal, Task
from ..hand import capsules, pads
from ..hand_bones import bodies, channels, constrained, reading, roles
from ..hand_look import normals
from ..hand_shape import framing
from ..ownership import own
from ..product_objects import bringing, copies
from ..scene import checks, mesh, read, regions, sizes, units
from . import force, hooks, polishing, search, settings, settling, ways
from .stage import stage_of

_PALM = re.compile("palm|thenar")
TOTALS_N = {"LIGHT": 60.0, "FIRM": 200.0}
"""Sum of forces over the skin by strength, N. Maximal grips sum to 337, 260 and 122 N on 48, 60 and 100 mm as a mat
reads them (Xie Table 6): firm is about two thirds of one on a common handle, light a third of that."""

PINCHES_N = {"LIGHT": 9.0, "FIRM": 30.0}
"""The same of a pinch, 15 N from each side where it is firm: palmar pinches are 70 to 110 N at most (Mathiowetz 1985),
and objects are lifted with a few newtons."""

HUNG_N = {"LIGHT": 30.0, "FIRM": 100.0}
"""The weight that hangs in a hook: a bag of 3 and of 10 kg."""

SETTLE_ROUNDS = 10
"""Rounds of pressing and fitting again, at most."""

MOST_FRICTION = 99.0
"""A grasp that no friction holds is kept with this one: a property of Blender holds no infinity that is shown well."""

MOVES = ("AUTO", "HAND", "PRODUCT", "FINGERS")
"""What a fit may carry through the world: AUTO the product where the hand is part of a body, else the hand; with
FINGERS hand and product both stay."""


@dataclass(frozen=True)
class Fit:
    """A fit that was read from the scene; no Blender object is in it, so any thread may run it.

    `press` is the contact job that a force target repeats; None without one. `frame_mm` (4, 4): the
    product's own axes and origin in the world, mm for its local units.
    """

    hand: fitter.Hand
    product: object
    product_mm: tuple
    wish: fitter.Wish
    force_n: float | None
    press: object
    names: tuple
    frame_mm: np.ndarray | None = None


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
    with own.without_own_output(context, hand_object, parts):
        product = read.read_product(context, parts, scale, np.zeros(3))
        frame = np.array(parts[0].matrix_world, dtype=np.float64)
    gap = native.module.Product(product.vertices_mm, product.triangles)
    press = workflow.read_job(context, hand_object, parts) if force_n or is_searched(wish) else None
    armature = reading.armature_of(hand_object)
    if wish.is_placed:
        wish = replace(wish, angles=reading.read_angles(armature, hand.rig, hand.joints))
    found = (hand_object.name, armature.name, tuple(part.name for part in parts))
    frame[:3] *= scale
    return Fit(hand, gap, (product.vertices_mm, product.triangles), wish, force_n, press, found, frame)


def read_hand(context, hand_object):
    """The `fitter.Hand` of a mesh on an armature: bones by role, pads from the regions listed under Materials."""
    rig, role_names = reading.read_free_rig(context, hand_object)
    armature = reading.armature_of(hand_object)
    joints = roles.resolve(rig, role_names, reading.own_limits(armature, rig))
    rig = replace(rig, normals=normals.outward_normals(rig.vertices, mesh.triangles(hand_object.data)))
    skin = read_skin(context, hand_object, rig, joints)
    bodies = capsules.build(rig, joints, reading.tails(rig, armature))
    return fitter.Hand(rig, joints, pads.pads_of(rig, joints, skin), bodies)


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
    """The grasp of a `Fit`. `cancel` has `is_set()`; `progress(stage, fraction)`. Raises `fitter.GraspError`."""
    watch = fitter.Watch(progress or fitter.ALONE.report, cancel)
    found = fitter.fit(fit.hand, fit.product, fit.product_mm[0], fit.wish, watch)
    if fit.force_n is None:
        return found
    return force.reach(fit, found, watch)


def wish_of(wish, kind):
    """The wish for a kind of grasp: a hook leaves out thumb and palm. Raises `checks.Refusal` where nothing is left."""
    if kind != ways.HOOK:
        return wish
    digits = tuple(digit for digit in hooks.FINGERS if wish.digits is None or digit in wish.digits)
    if not digits or not set(hooks.DEPTHS) & set(wish.targets_mm):
        raise checks.Refusal(
            "a hook takes the last and middle pads of fingers, and none takes part; tick a finger under Digits, "
            "and give its pads a depth"
        )
    return replace(wish, digits=digits)


def is_searched(wish):
    """Whether a wish leaves to the search where the product is held."""
    return not wish.is_placed and wish.axis is None


def can_search(fit):
    """Whether the hand that is pressed is the one that is posed: a subdivided one has other vertices."""
    return fit.press is not None and len(fit.press.reading.hand.posed_mm) == len(fit.hand.rig.vertices)


def search_all(fit, asked, cancel=None, progress=None):
    """The `search.Found` grasps of a `Fit`, best first. Raises `fitter.GraspError`.

    `asked`: a `search.Asked`; where not all pads take part a share of its sum is asked for.
    """
    watch = fitter.Watch(progress or fitter.ALONE.report, cancel)
    taking = np.isfinite(fitter.wanted_depths(fit.hand.pads, fit.wish)).mean()
    if asked.total_n is not None:
        asked = replace(asked, total_n=float(asked.total_n * taking))
    return search.search(fit, watch, asked)


def sums_of(name, own_n=0.0):
    """The sums of forces, N, of a power grip and of a pinch by the name of a strength; `own_n` for both if not 0."""
    return (own_n or TOTALS_N.get(name), own_n or PINCHES_N.get(name))


def asked_of(name, own_n=0.0, end=0, kind="AUTO"):
    """What a search is asked for by the name of a strength; `own_n` for all sums and the weight if not 0."""
    hung_n = own_n or HUNG_N.get(name, HUNG_N["FIRM"])
    return search.Asked(*sums_of(name, own_n), end, kind, hung_n)


def settle_here(fit, weight_n, total_n, cancel=None, progress=None):
    """The hand settled from where it is: `(grasp, state, friction)`, the first in the scene's frame.

    `weight_n` acts down the world's z at the middle of the product; `total_n` is the sum of forces to carry, None for
    what the hand carries as it is. Raises `fitter.GraspError` where nothing touches.
    """
    watch = fitter.Watch(progress or fitter.ALONE.report, cancel)
    stage = stage_of(fit)
    goal = Goal(np.full(len(fit.hand.pads), 1.0))
    task = Task(fit.hand, walls.Gauge(fit.product, stage.gauge.is_thin), goal, (np.eye(4), fit.wish.angles), fit.wish)
    first = stage.taken(fitter.grasp_of(task, task.start, 0, 0.0))
    depths = np.array([first.depths_mm[pad.name] for pad in fit.hand.pads])
    depths = np.where(depths > 0.0, depths, np.nan)
    weight = stage.world[:3, :3].T @ np.array([0.0, 0.0, -weight_n])
    aim = settling.Aim(np.zeros(3), weight, total_n, depths_mm=depths)
    if total_n is None:
        aim = replace(aim, total_n=max(settling.pressed(stage, first, aim, cancel).total_n, 2.0 * weight_n))
    state = polishing.polish(stage, settling.settle(stage, first, aim, SETTLE_ROUNDS, watch), aim, watch)
    return stage.carried(state.grasp), state, settling.friction_of(stage, state, aim)


def keep(context, fit, found):
    """Keep the grasps found in the scene, best first."""
    settings.keep(context.scene, named(fit), rows_of(found))


def rows_of(found):
    """Values of the scene's rows for `search.Found` grasps."""
    return [
        {
            "pose": settings.packed(*one.pose),
            "kind": one.way.kind,
            "total_n": one.state.total_n,
            "net_n": float(np.linalg.norm(one.state.net_n)),
            "friction": min(one.friction, MOST_FRICTION),
            "score": one.score,
            **facts.row_of(one),
        }
        for one in found
    ]


def named(fit):
    """What a grasp is kept for: the hand with its count of vertices, which goes with its size, and the product."""
    hand, _, parts = fit.names
    return f"{hand} of {len(fit.hand.rig.vertices)} vertices", "\n".join(parts)


def use(context, index):
    """Write one of the grasps kept into the scene; the product may have been moved since. Raises `checks.Refusal`."""
    stored, chosen = context.scene.thenar_grasps, context.scene.thenar
    parts = workflow.product_parts(chosen)
    if not 0 <= index < len(stored.found):
        raise checks.Refusal(f"there are {len(stored.found)} grasps; there is no grasp {index + 1}")
    fit = prepare(context, chosen.hand, parts, fitter.Wish(pads.FIRM_MM, is_placed=True))
    if named(fit) != (stored.hand, stored.product):
        raise checks.Refusal("the grasps were found for another hand or product; press Grasp again")
    angles, place = settings.unpacked(stored.found[index].pose)
    if angles.shape != fit.wish.angles.shape:
        raise checks.Refusal("the hand's bones changed since the grasps were found; press Grasp again")
    stage = stage_of(fit)
    grasp = stage.carried(fitter.Grasp(angles, place, {}, {}, 0.0, 0, 0.0, (), stage.gauge))
    finish(context, fit, grasp, stored.placed())
    stored.shown = index
    return True


def moves_of(context, hand_object, parts, asked="AUTO"):
    """Which of `MOVES` a fit of these objects makes. Raises `checks.Refusal` for a product that cannot be moved."""
    if asked == "AUTO":
        asked = "PRODUCT" if bodies.is_part_of_body(context, hand_object, parts) else "HAND"
    if asked == "PRODUCT":
        checks.check_product(context, parts, hand_object)
        bringing.check(context, parts, (hand_object, reading.armature_of(hand_object)))
    return asked


def finish(context, fit, found, moves):
    """Write a grasp into the scene: bones, and the place of hand or product; all of it or nothing.

    Raises `checks.Refusal`.
    """
    hand_name, armature_name, part_names = fit.names
    objects = context.scene.objects
    missing = [name for name in (hand_name, armature_name, *part_names) if name not in objects]
    if missing:
        raise checks.Refusal(f"'{missing[0]}' was removed while the grasp was fitted; fit again")
    hand, armature = objects[hand_name], objects[armature_name]
    parts = [objects[name] for name in part_names]
    moves = moves_of(context, hand, parts, moves)
    scale = units.mm_per_unit(context.scene)
    back = Matrix(reading.in_units(np.linalg.inv(found.place), scale).tolist())
    with ExitStack() as undo:
        undo.callback(constrained.reset, armature, constrained.state_of(armature))
        for bone in [armature.pose.bones[fit.hand.rig.names[number]] for number in fit.hand.joints.bones.values()]:
            undo.callback(channels.restore, bone, channels.kept(bone))
        reading.write_angles(armature, fit.hand.rig, fit.hand.joints, found.angles)
        if moves == "PRODUCT":
            _bring(context, parts, (hand, armature), back, undo)
        undo.pop_all()
    if moves == "HAND":
        reading.move_object(armature, found.place, scale)
        if hand.parent != armature and reading.top_of(hand) != reading.top_of(armature):
            reading.move_object(hand, found.place, scale)
    context.view_layer.update()


def _bring(context, parts, stays, back, undo):
    """Carry the product by `back` from where it was put; what an earlier Solve moved it by is taken off."""
    context.view_layer.update()
    shown = [part.matrix_world.copy() for part in parts]
    for part in [part for part in parts if part.thenar.is_moved]:
        undo.callback(setattr, part.thenar, "is_moved", True)
        undo.callback(setattr, part, "delta_location", part.delta_location.copy())
        part.delta_location, part.thenar.is_moved = part.thenar.home, False
    context.view_layer.update()
    goals = [(part, back @ part.matrix_world) for part in parts]
    bringing.bring(context, bringing.carriers(parts, stays), goals, undo)
    for (part, goal), place in zip(goals, shown, strict=True):
        copy = copies.find_copy(part.name)
        if copy is not None:
            undo.callback(setattr, copy, "matrix_world", copy.matrix_world.copy())
            copy.matrix_world = goal @ place.inverted() @ copy.matrix_world


def bring_into_view(context):
    """Frame hand and product in every 3D view that does not show them well; of a body its hand alone."""
    settings = context.scene.thenar
    parts = workflow.product_parts(settings)
    if settings.hand is not None and parts:
        framing.frame_lost(context, lambda: bodies.hand_points(context, settings.hand), parts)
