"""The grasp search: many starts from the product's own shape, the best fitted, balanced, and scored.

Hand and product are taken into the product's own frame first, so that neither's place in the scene counts.
"""

import time
from dataclasses import dataclass, replace

import numpy as np

from .. import native
from ..grasp_fit import fitter, thumb
from ..grasp_fit.least_squares import minimize
from ..grasp_fit.task import Task
from ..scene.checks import Refusal
from . import polishing, settling, ways
from .settings import FRICTION
from .stage import stage_of

THINNED = 3
"""A rough fit looks at each third vertex of a pad, and at each twelfth of the other skin."""

BAR_COST = 15.0
"""Residual, mm2, that a bar's cost of one adds: a bar as a hand likes it goes before a better fit on another part."""

ROUGH_FACING_MM = 4.0
"""What the thumb's facing weighs in a rough fit, as `thumb.WEIGHT_FACING`: with all of it a thin part of the product,
which is easily opposed, goes before the one that fits the hand."""

ROUGH, ROUGH_EVALUATIONS = 6, 20
FINE, FINE_EVALUATIONS, FINE_ROUNDS = 4, 30, 2
LAST, LAST_ROUNDS = 3, 5
UNSETTLED, OFF_BALANCE = 2.0, 0.1
SLIPS = 2.0
POOR = 8.0
HOPELESS = 14.0
BEHIND = 1.05
OPPOSED = 1.5
BARE = 3.0
LOST = 0.4
TOO_HARD_MPA = 0.6
"""So many starts are fitted roughly; of them so many are pressed and balanced a little; the best one is settled, and
the next where that one does not. What is not settled counts `UNSETTLED` more, and
`OFF_BALANCE` for each tolerance that it misses, or a way that was balanced a little would go before one that was
balanced nearly; what slips counts `SLIPS`; a power grip that
counts more than `POOR` is compared with pinches; where the best one that is balanced a little counts more than
`HOPELESS`, pinches are tried first. What was only balanced a little counts at least `BEHIND` times what the best held
one counts that was balanced to the end. A thumb whose pad faces away from the index finger's counts `OPPOSED`
for each unit that the cosine lacks of `thumb.FACING`, among power grips alone: against a pinch the share of the best
one is not counted. A hook counts `BARE` for the share of pads that it leaves out, as for pads that hang clear.
What leaves more than `LOST` of its forces over, or presses a vertex harder than `TOO_HARD_MPA`, is no grasp."""


@dataclass(frozen=True)
class Asked:
    """What a search is to find: the sum of forces around a bar and between two sides, N, or None for whatever comes; at
    which `end` of a bar's axis the thumb shall be (1 or -1; 0: either); the `kind`, one of `ways`, or AUTO; the weight
    `hung_n` that hangs in a hook, N."""

    total_n: float | None = None
    pinch_n: float | None = None
    end: int = 0
    kind: str = "AUTO"
    hung_n: float = 100.0


@dataclass(frozen=True)
class Found:
    """A grasp of the search with what was found of it, and the `way` it began. `score` counts against it; `friction`
    suffices to hold it; `pose` is angles (b, 3) and place (4, 4) in the product's own frame; `asked_n` the sum of
    forces that was asked for, of a hook the weight; `causes` what the score is the sum of, by cause."""

    grasp: fitter.Grasp
    state: settling.State
    score: float
    way: ways.Way
    friction: float
    pose: tuple
    asked_n: float | None
    causes: dict


def search(fit, watch=fitter.ALONE, asked=None):
    """Grasps of a `fitting.Fit`, best first, in the scene's frame; at least one.

    A power grip is sought first, and a pinch as well where none holds or the best is poor, unless `asked` names the
    kind. Raises `GraspError` if none holds.
    """
    began, asked = time.perf_counter(), asked or Asked()
    stage, begun, found, refusals = stage_of(fit), {}, [], {}
    plan = [(ways.POWER, HOPELESS), (ways.PINCH, np.inf), (ways.POWER, np.inf)]
    for kind, most in plan if asked.kind == "AUTO" else [(asked.kind, np.inf)]:
        if _is_enough(found, kind):
            continue
        wanted_n = {ways.POWER: asked.total_n, ways.HOOK: asked.hung_n}.get(kind, asked.pinch_n)
        aim = settling.Aim(np.zeros(3), np.zeros(3), wanted_n)
        try:
            if kind not in begun:
                begun[kind] = []
                begun[kind] = _begun(ways.of_kind(kind, stage, asked.end), aim, watch)
            if begun[kind] and begun[kind][0].score <= most:
                other = []
                if kind == ways.POWER:
                    powers = ways.powers(stage, asked.end)
                    other = [[change(way) for way in powers] for change in (ways.steep, ways.slid)]
                found += _ended_or_other(begun[kind], other, (aim, most), watch)
        except (Refusal, native.module.SolveError) as refusal:
            fitter.leave_if_cancelled(watch)
            refusals[kind] = refusal
    if not found:
        raise refusals.get(ways.POWER) or next(iter(refusals.values()))
    found.sort(key=lambda one: in_steps(one.score))
    return [_finished(one, time.perf_counter() - began) for one in found]


def _is_enough(found, kind):
    """Whether a kind need not be sought after the grasps `found`: it is among them, or the best one is held and, where
    it is no pinch, not poor."""
    if not found or found[0].friction > FRICTION:
        return any(one.way.kind == kind for one in found)
    return found[0].way.kind in (kind, ways.PINCH) or found[0].score <= POOR


def _best(ready, aim, watch):
    """The grasps that ways lead to, best first. Raises `Refusal` or `SolveError` where even the best one is none."""
    return _ended(_begun(ready, aim, watch), aim, watch)


def _begun(ready, aim, watch):
    """The grasps that ways lead to, balanced a little, best first. Raises `Refusal` or `SolveError` where none does."""
    if not ready:
        raise fitter.GraspError(
            "no two sides of the product can be pinched by the digits that take part; choose another kind of grasp, "
            "tick thumb and index finger under Digits, or make the product thinner"
        )
    out, refusals = [], []
    for count, (task, x, way) in enumerate(_rough(ready, watch)):
        watch.report("Fitting", 0.3 + 0.15 * count)
        fitter.leave_if_cancelled(watch)
        try:
            grasp = _fine(way, task, x, watch)
            state = settling.settle(way.stage, grasp, way.aim(aim), FINE_ROUNDS, watch)
        except (Refusal, native.module.SolveError) as refusal:
            refusals.append(refusal)
            continue
        out.append(_found(state, way.aim(aim), way))
    if not out:
        raise refusals[0] if refusals else fitter.GraspError("no way to hold the product was found")
    return sorted(out, key=lambda found: in_steps(found.score))


def _ended(begun, aim, watch, most=np.inf):
    """The grasps `begun` with the best ones balanced to the end, best first; after the first one those that count more
    than `most` stay as they are. Raises `Refusal` where even the best one is none."""
    out, worked = list(begun), 0
    for place in range(min(LAST, len(out))):
        one = out[place]
        own, passed = one.way.aim(aim), [one]
        if place > 0 and (one.score > most or _is_settled(out[place - 1], aim)):
            break
        worked = place + 1
        if _is_settled(one, aim):
            break
        watch.report("Balancing the forces", 0.8 + 0.05 * place)
        for further in (_settled, polishing.polish, _with_thumb_freed):
            if further is not _settled and _is_lost(one.state):
                break
            try:
                one = _found(further(one.way.stage, one.state, own, watch), own, one.way)
            except (Refusal, native.module.SolveError):
                fitter.leave_if_cancelled(watch)
            passed.append(one)
        out[place] = _best_balanced(passed, own)
    out = _behind(out[:worked], out[worked:])
    out[0] = _faced(out[0], aim, watch)
    _refuse_what_does_not_hold(out[0].state)
    averted = OPPOSED * _averted(out[0].way, out[0].state.grasp)
    return [replace(one, score=one.score - averted) for one in out]


def _ended_or_other(begun, other, asked, watch):
    """`_ended`, `asked` for an aim and a most; where that settles none, the best of each list of ways of `other`, until
    one settles.

    On a short bar a hand may have to slide along it; on a long one a hand that may ends at the bar's end.
    """
    aim, most = asked
    ended, refusal = [], None
    try:
        ended = _ended(begun, aim, watch, most)
    except (Refusal, native.module.SolveError) as error:
        fitter.leave_if_cancelled(watch)
        refusal = error
    for ready in other:
        if ended and _is_settled(ended[0], aim):
            break
        try:
            again = _best(ready, aim, watch)
            ended = min(ended or again, again, key=lambda found: in_steps(found[0].score))
        except (Refusal, native.module.SolveError):
            fitter.leave_if_cancelled(watch)
    if not ended:
        raise refusal
    return ended


def _is_settled(one, aim):
    """Whether a grasp found is settled as its way has the aim."""
    return settling.is_settled(one.state, one.way.aim(aim))


def _behind(ended, begun):
    """All of them, best first: ways that were only balanced a little count no better than the best one that was
    balanced to the end, if that one is held."""
    ended = sorted(ended, key=lambda found: in_steps(found.score))
    if ended[0].friction <= FRICTION and _why_none(ended[0].state) is None:
        least = BEHIND * ended[0].score
        begun = [
            replace(one, score=least, causes=one.causes | {"settled": one.causes["settled"] + least - one.score})
            if one.score < least
            else one
            for one in begun
        ]
    return sorted([*ended, *begun], key=lambda found: in_steps(found.score))


def _best_balanced(passed, aim):
    """Where one way was balanced best, a finger in a wall counted; the latest of those alike.

    By what balancing wants and not by the score, which would give up balance and the wanted sum for pads that touch.
    """
    return min(reversed(passed), key=lambda one: in_steps(settling.cost_of(one.state, aim)))


def _is_lost(state):
    """Whether small motions lead to no grasp: a finger stands in a thin wall, or bone deeper than they reach."""
    return fitter.CROSSED_TEXT in state.grasp.warnings or state.sunk_mm > polishing.MOST_MM


def _faced(one, aim, watch):
    """A power grip found with its thumb turned to the index finger, where that leaves it settled."""
    own = one.way.aim(aim)
    try:
        state = polishing.face(one.way.stage, one.state, own, watch)
    except (Refusal, native.module.SolveError):
        fitter.leave_if_cancelled(watch)
        return one
    return one if state is one.state else _found(state, own, one.way)


def _settled(stage, state, aim, watch):
    """A `State` after all rounds of settling."""
    return settling.settle(stage, state.grasp, aim, LAST_ROUNDS, watch)


def _with_thumb_freed(stage, state, aim, watch):
    """A `State` settled again with less asked of the thumb's facing, where that kept the forces out of balance."""
    if aim.bar is None or settling.is_settled(state, aim):
        return state
    eased = replace(aim, facing_mm=ROUGH_FACING_MM)
    after = settling.settle(stage, state.grasp, eased, LAST_ROUNDS, watch)
    after = polishing.polish(stage, after, eased, watch)
    return after if settling.cost_of(after, aim) < settling.cost_of(state, aim) else state


def _refuse_what_does_not_hold(state):
    """Raises `GraspError` where even the best way is none."""
    reason = _why_none(state)
    if reason is None:
        return
    raise fitter.GraspError(
        f"no way to hold the product was found: the best one {reason}. Put the product's origin where the hand shall "
        "close, or pose the hand there and press Light (current pose)"
    )


def _why_none(state):
    """Why a state is no grasp, or None."""
    peak = float(state.peaks_mpa.max())
    if fitter.CROSSED_TEXT in state.grasp.warnings:
        return "has a finger in a thin wall of the product"
    if state.sunk_mm > 0.0:
        return f"presses skin {state.sunk_mm:.1f} mm farther than it is thick"
    if state.imbalance > LOST:
        return f"leaves {state.imbalance:.0%} of the forces over"
    return f"presses an edge with {1e3 * peak:.0f} kPa" if peak > TOO_HARD_MPA else None


def _found(state, aim, way):
    """A grasp as a way led to it, with its score and what its holding takes."""
    held = settling.friction_of(way.stage, state, aim)
    causes = causes_of(state, aim) | {
        "slips": SLIPS if held > FRICTION else 0.0,
        "thumb": OPPOSED * _averted(way, state.grasp),
        "place": float(way.spot.cost),
    }
    if way.kind == ways.HOOK:
        causes["bare"] = BARE * float(
            np.isnan(fitter.wanted_depths(way.stage.fit.hand.pads, way.stage.fit.wish)).mean()
        )
    pose = state.grasp.angles, state.grasp.place
    asked_n = float(np.linalg.norm(aim.weight_n)) if way.kind == ways.HOOK else aim.total_n
    return Found(state.grasp, state, sum(causes.values()), way, held, pose, asked_n, causes)


def _averted(way, grasp):
    """What the cosine between the thumb pad's facing and the way to the index finger's pad lacks; 0 but in a power
    grip."""
    if way.bar is None:
        return 0.0
    return max(thumb.FACING - polishing.opposed(way.stage, grasp), 0.0)


def _finished(one, seconds):
    """A grasp found, in the scene's frame."""
    return replace(one, grasp=replace(one.way.stage.carried(one.grasp), force_n=one.state.total_n, seconds=seconds))


def score_of(state, aim):
    """What counts against a grasp, mm-like: the sum of its `causes_of`."""
    return sum(causes_of(state, aim).values())


def causes_of(state, aim):
    """What counts against a grasp by cause, mm-like: pads that hang clear (`touch`), forces and moments left over
    (`balance`), a missed `sum`, hard spots (`peak`), skin and bone too `deep`, what is not `settled`, and what nobody
    should use (`refused`)."""
    grasp = state.grasp
    misses = [max(want - grasp.depths_mm[name], 0.0) for name, want in grasp.targets_mm.items()]
    clear = [grasp.depths_mm[name] <= 0.0 for name in grasp.targets_mm]
    short = 0.0 if aim.total_n is None else min(abs(state.total_n / aim.total_n - 1.0), 1.0)
    deep = 0.3 * max(grasp.deepest_body_mm - 1.0, 0.0) + 5.0 * (fitter.CROSSED_TEXT in grasp.warnings)
    missed = 0.0
    if not settling.is_settled(state, aim):
        missed = UNSETTLED + OFF_BALANCE * (settling.cost_of(state, aim) - settling.LEAST_COST)
    return {
        "touch": float(np.mean(np.minimum(misses, 5.0))) + 3.0 * float(np.mean(clear)),
        "balance": 8.0 * min(state.imbalance, 1.0) + 3.0 * min(state.lever, 1.0),
        "sum": 3.0 * short,
        "peak": 2.0 * max(float(state.peaks_mpa.max()) / settling.MOST_MPA - 1.0, 0.0),
        "deep": deep + settling.SUNK * state.sunk_mm,
        "settled": missed,
        "refused": 10.0 if state.contact.grade == "do not use" else 0.0,
    }


def _rough(ready, watch):
    """The best of the ways after a rough fit: (task, x, way)."""
    tasks = []
    hand, sparse = (_thinned(ready[0].stage.hand, step) for step in (THINNED, 2 * THINNED))
    for number, way in enumerate(ready):
        watch.report("Trying where to hold it", 0.2 * number / len(ready))
        fitter.leave_if_cancelled(watch)
        wanted = fitter.wanted_depths(hand.pads, way.stage.fit.wish)
        goal = replace(settling.goal_of(wanted, way.bar), facing_mm=ROUGH_FACING_MM)
        tasks.append((Task(hand, way.stage.gauge, goal, way.start(sparse, wanted), way.stage.fit.wish), way))
    tasks.sort(key=lambda task: in_steps(task[0].first_cost + BAR_COST * task[1].spot.cost))
    fitted = []
    for task, way in tasks[:ROUGH]:
        watch.report("Fitting roughly", 0.2)
        fitter.leave_if_cancelled(watch)
        solved = minimize(task.problem(), task.start, ROUGH_EVALUATIONS, cancelled=watch.cancelled)
        fitted.append((solved.cost + BAR_COST * way.spot.cost, task, solved.x, way))
    fitted.sort(key=lambda entry: in_steps(entry[0]))
    return _varied([entry[1:] for entry in fitted])[:FINE]


def _varied(fitted):
    """The best one, then the best on another bar, then the others: one bar shall not take all places."""
    others = [entry for entry in fitted[1:] if entry[2].spot is not fitted[0][2].spot]
    rest = [entry for entry in fitted[1:] if not others or entry is not others[0]]
    return [fitted[0], *others[:1], *rest]


def in_steps(cost):
    """A cost in steps of 2 %: of ways that are alike, as on a cylinder, the first one tried shall win everywhere."""
    return round(np.log(max(cost, 1e-9)) / 0.02)


def _thinned(hand, step):
    """The hand with every `step`-th vertex only."""
    pads = [replace(pad, rows=pad.rows[::step]) if len(pad.rows) > 8 * step else pad for pad in hand.pads]
    return replace(hand, pads=pads, body_step=hand.body_step * step)


def _fine(way, rough, x, watch):
    """The grasp from a rough fit, with all vertices."""
    angles, place = fitter.motion_of(rough, x)
    hand, wish = way.stage.hand, way.stage.fit.wish
    goal = settling.goal_of(fitter.wanted_depths(hand.pads, wish), way.bar)
    task = Task(hand, way.stage.gauge, goal, (place, angles), wish)
    solved = minimize(task.problem(), task.start, FINE_EVALUATIONS, cancelled=watch.cancelled)
    return fitter.grasp_of(task, solved.x, solved.evaluations, 0.0)
