"""The grasp search: many starts from the product's own shape, the best fitted, balanced, and scored.

Hand and product are taken into the product's own frame first, so that neither's place in the scene counts.
"""

import time
from dataclasses import dataclass, replace

import numpy as np

from .. import native
from ..grasp_fit import closing, fitter
from ..grasp_fit.least_squares import minimize
from ..grasp_fit.task import Task
from ..scene.checks import Refusal
from . import places, settling
from .stage import stage_of

ROLLS = 4
"""Directions around a bar from which the palm is tried."""

STOPS_DEG = {"thumb_proximal": 30.0, "thumb_distal": 25.0}
"""The thumb closes this far before a fit: further, its tip hooks into the palm and stays there."""

OBLIQUE_DEG = 12.0
ALONG = -0.25
"""The bar's axis against the line of the knuckles, and its place along the fingers in parts of the hand's breadth."""

THINNED = 3
"""A rough fit looks at each third vertex of a pad, and at each twelfth of the other skin."""

BAR_COST = 15.0
"""Residual, mm2, that a bar's cost of one adds: a bar as a hand likes it goes before a better fit on another part."""

ROUGH, ROUGH_EVALUATIONS = 6, 20
FINE, FINE_EVALUATIONS, FINE_ROUNDS = 4, 30, 2
LAST, LAST_ROUNDS = 2, 6
UNSETTLED = 2.0
LOST = 0.4
TOO_HARD_MPA = 0.6
"""So many starts are fitted roughly; of them so many are pressed and balanced a little; the best one is settled, and
the next where that one does not. One that is settled goes before another by `UNSETTLED` in its score. What leaves more
than `LOST` of its forces over, or presses a vertex harder than `TOO_HARD_MPA`, is no grasp."""


@dataclass(frozen=True)
class Found:
    """A grasp of the search with what was found of it. `score` counts against it; `spot` which bar, `end` which end of
    its axis is at the thumb (1 or -1), `roll` the palm's side; `friction` suffices to hold it; `pose` is angles (b, 3)
    and place (4, 4) in the product's own frame; `asked_n` the sum of forces that was asked for."""

    grasp: fitter.Grasp
    state: settling.State
    score: float
    spot: places.Spot
    end: int
    roll: int
    friction: float = np.inf
    pose: tuple = ()
    asked_n: float | None = None


def search(fit, watch=fitter.ALONE, aim=None, end=0):
    """Grasps of a `fitting.Fit`, best first, in the scene's frame; at least one.

    `end`: 1 or -1 keeps the thumb at that end of the bar's axis, 0 tries both. Raises `GraspError` if none holds.
    """
    began = time.perf_counter()
    stage = stage_of(fit)
    aim = aim or settling.Aim(np.zeros(3), np.zeros(3))
    out, refusals = [], []
    for count, (task, x, name) in enumerate(_rough(stage, end, watch)):
        watch.report("Fitting", 0.3 + 0.15 * count)
        fitter.leave_if_cancelled(watch)
        try:
            grasp = _fine(stage, task, x, watch)
            state = settling.settle(stage, grasp, replace(aim, bar=task.goal.bar), FINE_ROUNDS, watch)
        except (Refusal, native.module.SolveError) as refusal:
            refusals.append(refusal)
            continue
        out.append(Found(state.grasp, state, score_of(state, aim) + name[0].cost, *name))
    if not out:
        raise refusals[0] if refusals else fitter.GraspError("no way to hold the product was found")
    out.sort(key=lambda found: in_steps(found.score))
    for place in range(min(LAST, len(out))):
        if any(settling.is_settled(one.state, aim) for one in out):
            break
        watch.report("Balancing the forces", 0.8 + 0.05 * place)
        one = out[place]
        state = settling.settle(stage, one.grasp, replace(aim, bar=_bar(one.spot, one.end)), LAST_ROUNDS, watch)
        out[place] = replace(one, grasp=state.grasp, state=state, score=score_of(state, aim) + one.spot.cost)
    out.sort(key=lambda found: in_steps(found.score))
    _refuse_what_does_not_hold(out[0].state)
    return [_finished(stage, one, aim, time.perf_counter() - began) for one in out]


def _refuse_what_does_not_hold(state):
    """Raises `GraspError` where even the best way is none."""
    peak = float(state.peaks_mpa.max())
    if fitter.CROSSED_TEXT in state.grasp.warnings:
        reason = "has a finger in a thin wall of the product"
    elif state.imbalance > LOST:
        reason = f"leaves {state.imbalance:.0%} of the forces over"
    elif peak > TOO_HARD_MPA:
        reason = f"presses an edge with {1e3 * peak:.0f} kPa"
    else:
        return
    raise fitter.GraspError(
        f"no way to hold the product was found: the best one {reason}. Put the product's origin where the hand shall "
        "close, or pose the hand there and press Light (current pose)"
    )


def _finished(stage, one, aim, seconds):
    """A grasp found, in the scene's frame, with what its holding takes."""
    carried = replace(stage.carried(one.grasp), force_n=one.state.total_n, seconds=seconds)
    held = settling.friction_of(stage, one.state, aim)
    return replace(one, grasp=carried, friction=held, pose=(one.grasp.angles, one.grasp.place), asked_n=aim.total_n)


def score_of(state, aim):
    """What counts against a grasp, mm-like: pads that hang clear, imbalance, a missed sum, hard spots, sunk skin."""
    grasp = state.grasp
    misses = [max(want - grasp.depths_mm[name], 0.0) for name, want in grasp.targets_mm.items()]
    clear = [grasp.depths_mm[name] <= 0.0 for name in grasp.targets_mm]
    score = float(np.mean(np.minimum(misses, 5.0))) + 3.0 * float(np.mean(clear))
    score += 8.0 * min(state.imbalance, 1.0) + 3.0 * min(state.lever, 1.0)
    if aim.total_n is not None:
        score += 3.0 * min(abs(state.total_n / aim.total_n - 1.0), 1.0)
    score += 2.0 * max(float(state.peaks_mpa.max()) / settling.MOST_MPA - 1.0, 0.0)
    score += 0.3 * max(grasp.deepest_body_mm - 1.0, 0.0) + 5.0 * (fitter.CROSSED_TEXT in grasp.warnings)
    score += 0.0 if settling.is_settled(state, aim) else UNSETTLED
    return score + (10.0 if state.contact.grade == "do not use" else 0.0)


def _rough(stage, only, watch):
    """The best starts after a rough fit: (task, x, name), name is (spot, end, roll)."""
    hand, sparse = (_thinned(stage.hand, step) for step in (THINNED, 2 * THINNED))
    wish = stage.fit.wish
    wanted = fitter.wanted_depths(hand.pads, wish)
    bars = places.spots(stage.gauge.product, stage.vertices, stage.triangles, stage.mark)
    ways = [(bar, end, roll) for bar in bars for end in (1, -1) if only in (0, end) for roll in range(ROLLS)]
    tasks = []
    for number, name in enumerate(ways):
        watch.report("Trying where to hold it", 0.2 * number / len(ways))
        fitter.leave_if_cancelled(watch)
        start = fitter.start_of(sparse, stage.gauge, wanted, (_placing(hand, *name), None, STOPS_DEG))
        task = Task(hand, stage.gauge, settling.goal_of(wanted, _bar(*name[:2])), start, wish)
        tasks.append((task, name))
    tasks.sort(key=lambda task: in_steps(task[0].first_cost + BAR_COST * task[1][0].cost))
    fitted = []
    for task, name in tasks[:ROUGH]:
        watch.report("Fitting roughly", 0.2)
        fitter.leave_if_cancelled(watch)
        solved = minimize(task.problem(), task.start, ROUGH_EVALUATIONS, cancelled=watch.cancelled)
        fitted.append((solved.cost + BAR_COST * name[0].cost, task, solved.x, name))
    fitted.sort(key=lambda entry: in_steps(entry[0]))
    return _varied([entry[1:] for entry in fitted])[:FINE]


def _varied(fitted):
    """The best one, then the best on another bar, then the others: one bar shall not take all places."""
    others = [entry for entry in fitted[1:] if entry[2][0] is not fitted[0][2][0]]
    rest = [entry for entry in fitted[1:] if not others or entry is not others[0]]
    return [fitted[0], *others[:1], *rest]


def in_steps(cost):
    """A cost in steps of 2 %: of ways that are alike, as on a cylinder, the first one tried shall win everywhere."""
    return round(np.log(max(cost, 1e-9)) / 0.02)


def _thinned(hand, step):
    """The hand with every `step`-th vertex only."""
    pads = [replace(pad, rows=pad.rows[::step]) if len(pad.rows) > 8 * step else pad for pad in hand.pads]
    return replace(hand, pads=pads, body_step=hand.body_step * step)


def _bar(bar, end):
    """What the thumb closes around: center (3) and axis (3) of the bar, toward the thumb's side."""
    return bar.center, end * bar.axis


def _placing(hand, bar, end, roll):
    turn = 2.0 * np.pi * roll / ROLLS
    third = np.cross(bar.axis, bar.side)
    toward = np.cos(turn) * bar.side + np.sin(turn) * third
    return closing.Placing(bar.center, end * bar.axis, np.radians(OBLIQUE_DEG), ALONG * fitter.breadth_of(hand), toward)


def _fine(stage, rough, x, watch):
    """The grasp from a rough fit, with all vertices."""
    angles, place = fitter.motion_of(rough, x)
    goal = settling.goal_of(fitter.wanted_depths(stage.hand.pads, stage.fit.wish), rough.goal.bar)
    task = Task(stage.hand, stage.gauge, goal, (place, angles), stage.fit.wish)
    solved = minimize(task.problem(), task.start, FINE_EVALUATIONS, cancelled=watch.cancelled)
    return fitter.grasp_of(task, solved.x, solved.evaluations, 0.0)
