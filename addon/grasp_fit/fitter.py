"""The grasp fitter: joint angles and the hand's place for which every pad lies as deep in the product as asked.

Knows nothing of Blender. What Xie et al. did by hand ("moving fingers until the force fitted") as least squares:
26 unknowns on the hand's own rig (16 finger, 5 thumb, 1 palm arch, up to 6 of the hand's place less its null motions).
"""

import time
from dataclasses import dataclass

import numpy as np

from ..hand import capsules as capsules_of_hand
from ..hand import pads as pads_of_hand
from ..hand.poses import OPEN
from ..hand.skinning import (
    pose_matrices,
    skin,
    skin_normals,
)
from ..hand_bones.roles import FINGERS, pose_angles
from ..scene.checks import Refusal
from . import closing, walls
from .least_squares import minimize
from .task import Goal, Task

CROSSED_TEXT = (
    "a finger stands in a thin wall of the product; pose each finger on the side it presses and keep the places"
)


class GraspError(Refusal):
    """The grasp cannot be fitted; the message says why and what to do."""


@dataclass(frozen=True)
class Hand:
    """What a fit is made of: `rig`, its `joints`, its `pads`, and its `capsules`; each `body_step`-th vertex of the
    skin outside the pads is looked at."""

    rig: object
    joints: object
    pads: list
    capsules: object
    body_step: int = 4


@dataclass(frozen=True)
class Grasp:
    """A fitted grasp. `angles` (b, 3) turns from rest, radians; `place` (4, 4) carries the hand through the world, mm.

    `depths_mm` and `targets_mm` by pad name; `seconds` the time taken; `warnings` texts; `gauge` what read the depths.
    """

    angles: np.ndarray
    place: np.ndarray
    depths_mm: dict
    targets_mm: dict
    deepest_body_mm: float
    evaluations: int
    seconds: float
    warnings: tuple
    gauge: walls.Gauge
    force_n: float | None = None


@dataclass(frozen=True)
class Wish:
    """What to fit: `targets_mm` by kind of pad; `digits` that take part (None: all, with the palm); `is_placed` keeps
    the hand's place within `free_mm` of where it stands and closes it from `angles`, otherwise the product is laid into
    the open palm; `axis` and `center` of the product (world mm) if its own long axis is not the one to grasp.
    `along_mm`: how far a hand around a bar may slide along it from where it was laid; farther costs."""

    targets_mm: dict
    digits: tuple = None
    is_placed: bool = False
    free_mm: float = 40.0
    angles: object = None
    axis: tuple = None
    center: tuple = None
    evaluations: int = 70
    along_mm: float = 20.0


@dataclass(frozen=True)
class Watch:
    """Called between evaluations: `report(text, fraction)`; `cancel` has `is_set()`, or is None."""

    report: object = lambda text, fraction: None
    cancel: object = None

    def cancelled(self):
        """Whether the fit shall end."""
        return self.cancel is not None and self.cancel.is_set()


ALONE = Watch()


def fit(hand, product, vertices, wish, watch=ALONE):
    """The best `Grasp` of `product` (gap_mm) with world `vertices` (k, 3), mm.

    Raises `GraspError` if no pad reaches the product.
    """
    began = time.perf_counter()
    wanted = wanted_depths(hand.pads, wish)
    gauge = walls.gauge_of(product, vertices, np.nanmax(wanted, initial=0.0))
    starts = []
    for count, placing in enumerate(_placings(hand, vertices, wish)):
        watch.report("Closing the fingers", 0.1 * count)
        leave_if_cancelled(watch)
        starts.append(start_of(hand, gauge, wanted, (placing, wish.angles)))
    tasks = [Task(hand, gauge, Goal(wanted), start, wish) for start in starts]
    tasks.sort(key=lambda task: task.first_cost)
    best, used = None, 0
    for count, task in enumerate(tasks[:2]):
        watch.report("Fitting", 0.3 + 0.35 * count)
        found = minimize(task.problem(), task.start, wish.evaluations, cancelled=watch.cancelled)
        used += found.evaluations
        if best is None or found.cost < best[0].cost:
            best = found, task
        leave_if_cancelled(watch)
    return grasp_of(best[1], best[0].x, used, time.perf_counter() - began)


def leave_if_cancelled(watch):
    """Raises `GraspError` once the watch is cancelled."""
    if watch.cancelled():
        raise GraspError("the fit was cancelled")


def refit(hand, found, wish, watch=ALONE, goal=None):
    """The `Grasp` from an earlier one with other target depths, or another `goal`; raises as `fit` does."""
    began = time.perf_counter()
    goal = goal or Goal(wanted_depths(hand.pads, wish))
    task = Task(hand, found.gauge, goal, (found.place, found.angles), wish)
    solved = minimize(task.problem(), task.start, wish.evaluations, cancelled=watch.cancelled)
    return grasp_of(task, solved.x, found.evaluations + solved.evaluations, found.seconds + time.perf_counter() - began)


def wanted_depths(pads, wish):
    """Target depth per pad, NaN where the pad does not take part."""

    def takes_part(pad):
        part = "palm" if pad.kind == "palm" else pad.role.partition("_")[0]
        return pad.kind in wish.targets_mm and (wish.digits is None or part in wish.digits)

    return np.array([wish.targets_mm.get(pad.kind, np.nan) if takes_part(pad) else np.nan for pad in pads])


def _placings(hand, vertices, wish):
    if wish.is_placed:
        return [None]
    center, axis = closing.product_axis(vertices)
    center = center if wish.center is None else np.array(wish.center, float)
    axis = axis if wish.axis is None else np.array(wish.axis, float) / np.linalg.norm(wish.axis)
    breadth = breadth_of(hand)
    return [
        closing.Placing(center, axis, np.radians(oblique), along * breadth)
        for oblique in (6.0, 18.0)
        for along in (-0.35, -0.1)
    ]


def breadth_of(hand):
    """Distance between the outer knuckles, mm; 55 for a hand with one finger."""
    size = np.linalg.norm(hand.rig.world_from_rig[:3, :3], axis=0).mean()
    bones = [hand.joints.bones[f"{f}_proximal"] for f in FINGERS if f"{f}_proximal" in hand.joints.bones]
    heads = hand.rig.rest[bones, :3, 3]
    return size * np.linalg.norm(heads[0] - heads[-1]) if len(heads) > 1 else 55.0


def start_of(hand, gauge, wanted, begin):
    """Place (4, 4) and angles (b, 3) from which a fit begins; `begin`: a `closing.Placing` or None, angles or None
    for the open hand, and perhaps degrees by role at which a joint stops to close."""
    placing, angles, *stops = begin
    pads = [pad for pad, target in zip(hand.pads, wanted, strict=True) if np.isfinite(target)]
    place = np.eye(4)
    if placing is not None:
        place = closing.lay_into_palm(hand.rig, hand.joints, hand.pads, gauge, placing)
    moved = hand.rig.moved(place)
    opened = pose_angles(hand.rig, hand.joints, OPEN) if angles is None else angles
    if gauge.is_thin:
        opened = closing.clear_fingers(moved, hand.joints, hand.capsules, gauge, opened)
    return place, closing.close_fingers(moved, hand.joints, pads, gauge, (opened, *stops))


def motion_of(task, x):
    """Angles (b, 3) and place (4, 4) of the hand at the vector `x` of a `Task`."""
    angles, turn, shift = task.pose(x)
    motion = np.eye(4)
    motion[:3, :3] = turn
    motion[:3, 3] = task.pivot + shift - turn @ task.pivot
    return angles, motion @ task.place


def grasp_of(task, x, used, seconds):
    """The `Grasp` at the vector `x` of a `Task`. Raises `GraspError` if no pad reaches the product."""
    angles, place = motion_of(task, x)
    rig = task.hand.rig.moved(place)
    posed = pose_matrices(rig, angles)
    body = np.ones(len(rig.vertices), bool)
    for pad in task.hand.pads:
        body[pad.rows] = False
    normals = np.where(body[:, None], 0.0, skin_normals(rig, posed)) if task.gauge.is_thin else None
    gap = task.gauge.gaps(skin(rig, posed), normals)
    depths = {pad.name: pads_of_hand.pad_depth(gap[pad.rows]) for pad in task.hand.pads}
    wanted = zip(task.hand.pads, task.wanted, strict=True)
    targets = {pad.name: float(want) for pad, want in wanted if np.isfinite(want)}
    if max(depths[name] for name in targets) < 0.0:
        raise GraspError("the product is out of the hand's reach; move it into the open hand, or make it smaller")
    missed = [name for name, want in targets.items() if depths[name] < 0.0 < want]
    warnings = (f"does not touch: {', '.join(missed)}",) if missed else ()
    if _is_crossed(task.hand, (rig, posed), task.gauge):
        warnings += (CROSSED_TEXT,)
    return Grasp(
        angles, place, depths, targets, float(-gap[body].min(initial=0.0)), used, seconds, warnings, task.gauge
    )


def is_crossed(hand, grasp):
    """Whether a finger of a `Grasp` stands in a thin wall of the product, from its angles and its place alone."""
    rig = hand.rig.moved(grasp.place)
    return _is_crossed(hand, (rig, pose_matrices(rig, grasp.angles)), grasp.gauge)


def _is_crossed(hand, posed, gauge):
    return gauge.is_thin and gauge.is_crossed(capsules_of_hand.center_points(hand.capsules, *posed))
