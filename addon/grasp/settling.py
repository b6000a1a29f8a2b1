"""Bends and moves a grasp until the forces on the product balance and no pad is pressed too hard. No Blender objects.

Each round presses the grasp with the contact model, gives every pad the stiffness that it showed, and fits again with
the balance among the residuals (`load`).
"""

from dataclasses import dataclass, replace

import numpy as np

from .. import native
from ..grasp_fit import fitter, sharing, thumb
from ..grasp_fit import load as loads
from ..grasp_fit.task import Goal
from ..hand.pads import TISSUE_SHARE
from ..hand.skinning import pose_matrices, skin, skin_normals
from ..scene.checks import Refusal
from . import friction

MOST_MPA = 0.4
"""No pad shall press harder: averages stay below 0.25 MPa with hand tools (Hall 1997), and pain begins below 0.2."""

MOST_N = 400.0
"""No grasp shall carry more unless it is asked to: maximal grips are 160 to 240 N in a dynamometer (PMC3855544), and
337 N as a mat sums them on 48 mm (Xie Table 6)."""

BALANCED = 0.02
"""Net force over the sum of forces at which a grasp counts as balanced."""

MOMENT = 0.05
"""Net moment over the sum of forces at `load.ARM_MM`."""

WEIGHT_MM = 60.0
"""1 % of the sum left over costs as much as 0.6 mm of a pad's depth."""

SHALLOW_MM = 4.0
"""A finger that hangs this far off the product is still drawn in; at 1 mm four of them stayed off a pistol grip."""

FORCE_MISS = 0.02
"""A wanted sum counts as reached within this share."""

EVALUATIONS, LATER_EVALUATIONS = 25, 15
"""Of the fit in the first round, and in the others."""

NEAR, FAR = 0.2, 0.6
MOST_LEFT = 0.3
LEVERS = np.array([1.0, 1.0, 1.0, loads.ARM_MM, loads.ARM_MM, loads.ARM_MM])
"""What earlier rounds left over counts in full where it is a small share of the sum of forces, `NEAR`, and not at all
from `FAR` on; up to `MOST_LEFT` of the sum; moments at `load.ARM_MM`."""

RISE = 1.3
"""Where a pad was too hard in a round, the sum rises again by no more in the next."""

SUNK = 5.0
"""Cost of each millimetre that skin is pressed farther than its tissue is thick: bone is then in the product."""

CROSSED = 20.0
"""Cost of a finger that stands in a thin wall: more than any balance gains that small motions bring."""

EVEN, UNEVEN = 0.1, 3.0
"""Rounds go on while a larger share of the fingers' force than `EVEN` is on the wrong fingers; all of it there counts
`UNEVEN` tolerances."""

LEAST_FACTOR = 0.6
"""The depth of a pad is eased by no more in one round."""


@dataclass(frozen=True)
class Aim:
    """What settling is to reach, in the product's own frame: `weight_n` (3) and where it acts, `about_mm` (3); a sum of
    forces, or None; `bar` as in `task.Goal`; `depths_mm` (p,) of the pads if not the
    wish's; `facing_mm` as in `task.Goal`.
    """

    about_mm: np.ndarray
    weight_n: np.ndarray
    total_n: float | None = None
    bar: tuple | None = None
    depths_mm: np.ndarray | None = None
    facing_mm: float = thumb.WEIGHT_FACING


@dataclass(frozen=True)
class State:
    """A pressed grasp of the own frame: `contact`, sum, net force (3) with the weight, net moment (3) about the aim,
    the greatest pressure of each pad (p,), MPa, and how much farther than its tissue is thick the deepest skin is
    pressed, mm; 0: no bone is in the product."""

    grasp: fitter.Grasp
    contact: object
    total_n: float
    net_n: np.ndarray
    moment_nmm: np.ndarray
    peaks_mpa: np.ndarray
    sunk_mm: float = 0.0

    @property
    def imbalance(self):
        """Net force over the sum of forces."""
        return float(np.linalg.norm(self.net_n)) / max(self.total_n, 1e-9)

    @property
    def lever(self):
        """Net moment over the sum of forces at `load.ARM_MM`."""
        return float(np.linalg.norm(self.moment_nmm)) / loads.ARM_MM / max(self.total_n, 1e-9)


def goal_of(wanted, bar, limits=None, load=None):
    """The goal of the fits of a search: depths (p,) of the pads, the bar, and what the last press adds."""
    return Goal(wanted, limits, load, bar, SHALLOW_MM, is_smooth=True)


def pressed(stage, found, aim, cancel=None):
    """The `State` of a grasp on a `Stage`. Raises `Refusal` where it cannot be pressed."""
    contact = stage.contact_of(found, cancel)
    forces, pressures = np.asarray(contact.force_n), np.asarray(contact.pressure_mpa)
    push = np.asarray(contact.total_force_n)
    moment = np.asarray(contact.total_moment_nmm) - np.cross(aim.about_mm, push)
    peaks = np.array([pressures[pad.rows].max() for pad in stage.hand.pads])
    depths = np.linalg.norm(contact.displacement_mm, axis=1)
    sunk = max(float(depths[pad.rows].max()) - pad.limit_mm / TISSUE_SHARE for pad in stage.hand.pads)
    return State(found, contact, float(forces.sum()), push + aim.weight_n, moment, peaks, max(sunk, 0.0))


def gaps_of(stage, grasp):
    """Gaps (n,) of the skin to the product as a grasp of the own frame is fitted, mm, before it is pressed."""
    rig = stage.hand.rig.moved(grasp.place)
    posed = pose_matrices(rig, grasp.angles)
    return grasp.gauge.gaps(skin(rig, posed), skin_normals(rig, posed) if grasp.gauge.is_thin else None)


def friction_of(stage, state, aim):
    """The coefficient of friction that suffices to hold what a state leaves over, once the fingers have eased it."""
    forces = np.asarray(state.contact.force_n)
    used = np.flatnonzero(forces > 0.0)
    rig = stage.hand.rig.subset(used).moved(state.grasp.place)
    points = skin(rig, pose_matrices(rig, state.grasp.angles)) + np.asarray(state.contact.displacement_mm)[used]
    push = -np.nan_to_num(np.asarray(state.contact.product_normal)[used]) * forces[used, None]
    points = points - aim.about_mm
    left = friction.eased(points, push, state.net_n, state.moment_nmm)
    return friction.needed(points, push, *left)


def settle(stage, first, aim, rounds, watch=fitter.ALONE):
    """The best `State` over `rounds` of pressing and fitting again, beginning with the grasp `first`.

    Pads are drawn to `aim.depths_mm`, or to the depths of the wish. Raises `Refusal` if not even the first grasp can be
    pressed.
    """
    areas = loads.vertex_areas(stage.fit.press.reading.hand.rest_mm, stage.fit.press.reading.hand.triangles)
    wanted = fitter.wanted_depths(stage.hand.pads, stage.fit.wish) if aim.depths_mm is None else aim.depths_mm
    limits = np.array([pad.limit_mm for pad in stage.hand.pads])
    best, least, found, left, reach = None, np.inf, first, np.zeros(6), aim.total_n
    fair = sharing.sharing_of(stage.hand.pads, np.isfinite(wanted), len(areas))
    for count in range(rounds):
        watch.report("Balancing the forces", count / rounds)
        fitter.leave_if_cancelled(watch)
        try:
            state = pressed(stage, found, aim, watch.cancel)
        except (Refusal, native.module.SolveError):
            if best is None:
                raise
            break
        force = np.asarray(state.contact.force_n)
        uneven = 0.0 if fair is None else fair.unevenness(force)
        cost = cost_of(state, aim) + UNEVEN * uneven
        if cost < least:
            best, least = state, cost
        if (is_settled(state, aim) and uneven < EVEN) or count == rounds - 1:
            break
        reach = _reach(state, aim, reach)
        now = replace(aim, total_n=reach)
        own, whole = eased(state, now)
        more = 1.0 if fair is None else fair.factors(stage.hand.pads, force)
        wanted = wanted * np.clip(own * whole * more, LEAST_FACTOR, 1.0 / LEAST_FACTOR)
        gap = gaps_of(stage, state.grasp)
        deepest = np.array([-gap[pad.rows].min() for pad in stage.hand.pads])
        limits = np.where(own < 1.0, np.minimum(limits, np.maximum(deepest, 0.3) * own), limits)
        share = np.clip((FAR - max(state.imbalance, state.lever)) / (FAR - NEAR), 0.0, 1.0)
        left = share * (left + np.concatenate([state.net_n, state.moment_nmm]))
        goal = goal_of(wanted, aim.bar, limits, _load(stage, (state, gap), (now, left, fair), areas))
        goal = replace(goal, facing_mm=aim.facing_mm, is_near=True)
        evaluations = EVALUATIONS if count == 0 else LATER_EVALUATIONS
        found = fitter.refit(stage.hand, found, replace(stage.fit.wish, evaluations=evaluations), watch, goal)
    return best


def _reach(state, aim, before):
    """The sum of forces to go for next: the wanted one, or as much of it as the hardest pad can bear."""
    peak = state.peaks_mpa.max() / MOST_MPA
    if aim.total_n is None or peak > 1.0:
        return None if aim.total_n is None else min(aim.total_n, state.total_n / peak)
    return min(aim.total_n, max(before, RISE * state.total_n))


def is_settled(state, aim):
    """Whether forces balance, no pad is pressed too hard, no finger stands in a thin wall, and the sum is the wanted
    one or not too large."""
    if fitter.CROSSED_TEXT in state.grasp.warnings or state.sunk_mm > 0.0 or state.peaks_mpa.max() > MOST_MPA:
        return False
    if state.imbalance > BALANCED or state.lever > MOMENT:
        return False
    if aim.total_n is None:
        return state.total_n <= MOST_N
    return abs(state.total_n / aim.total_n - 1.0) <= FORCE_MISS


LEAST_COST = 3.0
"""`cost_of` a settled state."""


def cost_of(state, aim):
    """How far a state is from settled: 1 for each tolerance that it misses by its own size, at least `LEAST_COST`."""
    cost = max(state.imbalance / BALANCED, 1.0) + max(state.lever / MOMENT, 1.0)
    cost += 10.0 * max(state.peaks_mpa.max() / MOST_MPA - 1.0, 0.0) + SUNK * state.sunk_mm
    cost += CROSSED * (fitter.CROSSED_TEXT in state.grasp.warnings)
    if aim.total_n is None:
        return cost + 1.0 + 10.0 * max(state.total_n / MOST_N - 1.0, 0.0)
    return cost + max(abs(state.total_n / aim.total_n - 1.0) / FORCE_MISS, 1.0)


def eased(state, aim):
    """Factors for depths: of every pad (p,), at most 1, where it is pressed too hard; of all, for the sum of forces."""
    too_hard = np.maximum(state.peaks_mpa / (0.9 * MOST_MPA), 1e-6)
    own = np.clip(too_hard ** (-1.0 / loads.POWER), LEAST_FACTOR, 1.0)
    goal = min(state.total_n, 0.97 * MOST_N) if aim.total_n is None else aim.total_n
    whole = (goal / max(state.total_n, 1e-3 * max(goal, 1.0))) ** (1.0 / loads.POWER)
    return own, whole


def _load(stage, pressed_at, aim, areas):
    """What the next fit shall balance, and how fingers shall share the force. What earlier rounds left over is added
    to it, or some of it would always stay: the fit weighs balance against depths."""
    (state, gap), (aim, left, fair) = pressed_at, aim
    most = MOST_LEFT * state.total_n
    left = np.clip(left, -most * LEVERS, most * LEVERS)
    stiffness = loads.stiffness_of(stage.hand.pads, areas, gap, np.asarray(state.contact.force_n))
    total = aim.total_n
    if total is None and state.total_n > MOST_N:
        total = 0.97 * MOST_N
    outer = aim.weight_n + left[:3]
    return loads.Load(stiffness, aim.about_mm, max(state.total_n, 1.0), WEIGHT_MM, outer, left[3:], total, fair)
