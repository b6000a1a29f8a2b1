"""Why a part of the hand does not carry what was wanted of it, and how that is said. No Blender objects."""

from dataclasses import dataclass, replace

import numpy as np

from ..grasp import settling
from ..languages import iface, report
from . import parts, reaching

MISS, MISS_N = 0.05, 0.5
"""A force counts as reached within this share of the wanted one, or so many newtons."""

CLOSE_RAD = np.radians(0.5)
"""A joint this near its limit stands at it."""

MAIN = 0.3
"""Joints count whose slope is at least this share of the largest of their digit."""

SPARE_MM = 0.1
"""Tissue that may be pressed no deeper than this more is pressed as deep as it is thick."""

HARD = 0.93
"""A pad that presses with this share of the greatest pressure allowed cannot be pressed harder."""

ROUNDS = 4
"""Rounds without balance that show whether balance is the reason."""

REACHED, CLEAR, CLEAR_AT_LIMIT = "REACHED", "CLEAR", "CLEAR_AT_LIMIT"
LIMIT, TISSUE, HARD_SPOT, SIDE = "LIMIT", "TISSUE", "HARD_SPOT", "SIDE"
BALANCE, OTHER = "BALANCE", "OTHER"


@dataclass(frozen=True)
class Row:
    """What one of `parts.PARTS` carries: `wanted_n`, `reached_n`, and why the one is not the other."""

    part: str
    wanted_n: float
    reached_n: float
    reason: str


@dataclass(frozen=True)
class Search:
    """What a search was made of: the arguments of `reaching.reach`."""

    stage: object
    start: reaching.Start
    target: reaching.Target
    watch: object


def rows_of(search, reached, wanted_n):
    """A `Row` for every part of which a force is wanted (6,), N, NaN where none is."""
    stage, start, target = search.stage, search.start, search.target
    asked = np.flatnonzero(np.isfinite(wanted_n))
    slopes, freed, out = None, None, []
    for row, number in enumerate(asked):
        wanted, have = float(wanted_n[number]), float(reached.values[0][row])
        reason = REACHED
        if is_missed(wanted, have):
            slopes = reaching.slopes_of(stage, start, target, reached) if slopes is None else slopes
            reason = _cause(stage, number, (wanted, have), (slopes[row], reached))
        if reason == OTHER and is_balanced(reached.state):
            freed = _without_balance(search, reached) if freed is None else freed
            reason = OTHER if is_missed(wanted, float(freed[row])) else BALANCE
        out.append(Row(parts.PARTS[number], wanted, have, reason))
    return out


def is_balanced(state):
    """Whether a `settling.State` leaves no more over than a grasp that counts as settled."""
    return state.imbalance <= settling.BALANCED and state.lever <= settling.MOMENT


def is_missed(wanted_n, reached_n):
    """Whether a force is not the wanted one."""
    return abs(reached_n - wanted_n) > max(MISS * wanted_n, MISS_N)


def _cause(stage, number, forces, at):
    wanted, have = forces
    slopes, reached = at
    pads = [k for k, pad in enumerate(stage.hand.pads) if parts.part_of(pad) == parts.PARTS[number]]
    is_short = have < wanted
    if is_short and have <= 0.0:
        return CLEAR_AT_LIMIT if _is_closed(stage, parts.PARTS[number], reached) else CLEAR
    if is_short and reached.spare_mm[pads].min() < SPARE_MM:
        return TISSUE
    if is_short and reached.state.peaks_mpa[pads].max() > HARD * reaching.MOST_MPA:
        return HARD_SPOT
    if is_short and reached.spare_mm[-1] < SPARE_MM:
        return SIDE
    return LIMIT if _is_held(parts.PARTS[number], slopes if is_short else -slopes, reached) else OTHER


def _is_held(part, slopes, reached):
    """Whether every joint of a digit that changes its force much stands at the limit on that side."""
    task, x = reached.task, reached.x
    own = np.array([k for k, (_, _, role) in enumerate(task.dofs) if role.partition("_")[0] == part], int)
    main = [k for k in own if abs(slopes[k]) > MAIN * np.abs(slopes[own]).max()]
    ends = [task.bounds[k, 1] - x[k] if slopes[k] > 0.0 else x[k] - task.bounds[k, 0] for k in main]
    return bool(main) and max(ends) < CLOSE_RAD


def _is_closed(stage, part, reached):
    """Whether every joint of a digit that is clear of the product is bent as far as it goes."""
    task, x = reached.task, reached.x
    own = [k for k, (_, column, role) in enumerate(task.dofs) if role.partition("_")[0] == part and column == 0]
    own = [k for k in own if not task.dofs[k][2].endswith("metacarpal")]
    return bool(own) and max(task.bounds[k, 1] - x[k] for k in own) < CLOSE_RAD


def _without_balance(search, reached):
    """The forces that the target's parts reach where balance does not count."""
    loose = replace(search.target, balances_mm=(0.0,))
    begin = replace(search.start, x=reached.x)
    return reaching.reach(search.stage, begin, loose, search.watch, ROUNDS).values[0]


def sentence(rows):
    """Report level and sentence for `Row`s."""
    missed = [row for row in rows if row.reason != REACHED]
    if not missed:
        words = "{count} forces reached: {parts}"
        named = ", ".join(report("{part} {have:.1f} N", part=_name(row), have=row.reached_n) for row in rows)
        return "INFO", report(words, count=len(rows), parts=named)
    return "WARNING", "; ".join(line(row) for row in missed)


def line(row):
    """What is said of one part."""
    words = "{part} {wanted:.3g} N wanted, {have:.1f} N reached"
    text = report(words, part=_name(row), wanted=row.wanted_n, have=row.reached_n)
    return text if row.reason == REACHED else report("{text}: {why}", text=text, why=why(row.reason))


def _name(row):
    return iface(row.part.capitalize())


def why(reason):
    """What keeps a part from the force that is wanted of it, in words."""
    most_kpa = 1e3 * reaching.MOST_MPA
    return {
        CLEAR: report("it does not touch the product from here"),
        CLEAR_AT_LIMIT: report("its joints are at their limits before it touches the product"),
        LIMIT: report("its joints are at their limits"),
        TISSUE: report("its skin is pressed as deep as its tissue allows"),
        HARD_SPOT: report("its skin presses with {most:.0f} kPa, the most that is allowed", most=most_kpa),
        SIDE: report("skin outside its pads is in the product"),
        BALANCE: report("the forces on the product would be out of balance"),
        OTHER: report("no posture near this one carries it with the other forces"),
    }[reason]


def wanted_of(values):
    """Forces (6,) by `parts.PARTS`, NaN where a part is free, from newtons by part, 0 for free."""
    wanted = np.array([values[part] for part in parts.PARTS], float)
    return np.where(wanted > 0.0, wanted, np.nan)
