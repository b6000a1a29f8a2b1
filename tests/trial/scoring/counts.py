"""The rows of the trial's table: what of every verdict is counted against its label, what must be and what is aimed at.

Rows of shares have Wilson's 95 % bounds, rows of medians and means those of the order statistics and of the normal law.
`answers` are verdicts by case; cases without one say nothing. Every row has a `key` by which others refer to it.
"""

from collections import Counter
from dataclasses import dataclass, field

import numpy as np
from trial import places
from trial.scoring.findings import TISSUE

SILENT = {"verdict": "insufficient_data", "findings": []}
REACHED = 0.9  # of a severity: cases whose truth could not be made so severe count where they are
CONCEALED = 0.98
Z = 1.959963984540054
SCATTERS = ("normal", "outliers", "slow", "wide", "maps")
GOOD = 0.75  # of the reducible error
RICH = 0.9  # of the oracle's draws that give the answer: recordings that hold it


@dataclass(frozen=True)
class Row:
    """How many of how many, or the middle of what was measured; what it must be, and what is aimed at."""

    key: str
    name: str
    value: float
    of: int
    bounds: tuple[float, float]
    must: float | None = None
    goal: float | None = None
    is_ceiling: bool = False
    hits: int | None = None

    def holds(self):
        """Whether it is what it must be; None where it need not be anything or no case is of this kind."""
        return self._meets(self.must)

    def reaches(self):
        """Whether it is what is aimed at; None as above."""
        return self._meets(self.goal)

    def _meets(self, aim):
        if aim is None or not self.of:
            return None
        return self.value <= aim if self.is_ceiling else self.value >= aim


@dataclass(frozen=True)
class Answers:
    """What one diagnosis said: of every case, and of those to which a protocol was added, as advised and at random.

    `foretold`: by case, how often the advice that was followed says that it settles the matter.
    """

    said: dict
    followed: dict = field(default_factory=dict)
    at_random: dict = field(default_factory=dict)
    could_follow: frozenset = frozenset()
    foretold: dict = field(default_factory=dict)


def wilson(hits, of, z=Z):
    """Bounds of a share (Wilson 1927)."""
    if of == 0:
        return float("nan"), float("nan")
    share, spread = hits / of, z * z / of
    middle = (share + spread / 2.0) / (1.0 + spread)
    half = z / (1.0 + spread) * np.sqrt(share * (1.0 - share) / of + spread / (4.0 * of))
    return max(0.0, float(middle - half)), min(1.0, float(middle + half))


def median_bounds(values):
    """95 % bounds of the median: the order statistics between which it lies (binomial, by the normal law)."""
    values, count = np.sort(values), len(values)
    reach = 0.5 * Z * np.sqrt(count)
    low, high = int(np.floor(0.5 * count - reach)), int(np.ceil(0.5 * count + reach))
    return float(values[max(low, 0)]), float(values[min(high, count - 1)])


def named(verdict):
    """Effects that a verdict names."""
    return {finding["effect"] for finding in verdict.get("findings", [])}


def blames_skin(verdict):
    """Whether it claims that physics of the skin is missing, be it without telling which of several."""
    if verdict["verdict"] == "cannot_tell" and any(set(one) <= TISSUE for one in verdict.get("cannot_tell", [])):
        return True
    return verdict["verdict"] in ("missing_physics", "unlisted") or bool(named(verdict) & TISSUE)


def sets_of(verdict):
    """Sets of names kept at 90 %."""
    return [frozenset(one) if isinstance(one, list) else frozenset([one]) for one in verdict.get("names_90", [])]


def is_exact(label, verdict):
    """Those names and nothing else."""
    return named(verdict) == set(label["names"])


def is_refused(label, verdict):
    """Said to be on no list, and not named."""
    return verdict["verdict"] == "unlisted" and not named(verdict)


def is_undecided(label, verdict):
    """The right set, and not one name."""
    told = [set(one) for one in verdict.get("cannot_tell", [])]
    return verdict["verdict"] == "cannot_tell" and set(label["names"]) in told and len(named(verdict)) != 1


def is_modest(label, verdict):
    """Says that too little was recorded to tell."""
    return verdict["verdict"] in ("insufficient_data", "cannot_tell") and not named(verdict)


def holds_answer(label):
    """Whether its recordings do, as far as the label tells: those of the first trial tell nothing."""
    return label.get("chance", 1.0) >= RICH


def table(sealed, answers):
    """Rows of the score, in their order."""
    answers = answers if isinstance(answers, Answers) else Answers(answers)
    pairs = [(label, answers.said.get(name, SILENT)) for name, label in sealed.items()]

    def of(*strata):
        return [(label, verdict) for label, verdict in pairs if label["stratum"] in strata]

    severe = [pair for pair in of("single") if pair[0]["kappa"] >= REACHED]
    mild = [pair for pair in of("single") if 0.5 * REACHED <= pair[0]["kappa"] < REACHED]
    told = [pair for pair in of("decoy") if holds_answer(pair[0])]
    found = [
        _share(("nulls", "nulls: a missing effect claimed"), of("null"), _blamed, (0.02, 0.01, True)),
        *(_nulls_of(kind, of("null")) for kind in SCATTERS),
        _share(("decoys", "decoys: blamed on the skin"), of("decoy"), _blamed, (0.05, 0.03, True)),
        _share(("instrument", "decoys: named as the instrument"), told, _told_instrument, (None, 0.9, False)),
        _share(("severe", "one effect, kappa >= 1: exact"), severe, is_exact, (0.85, 0.95, False)),
        _share(("mild", "one effect, kappa 0.5: exact"), mild, is_exact, (None, 0.8, False)),
        _share(("wrong", "a wrong name anywhere"), pairs, _wrong, (0.05, 0.02, True)),
        _share(("pairs", "two effects: the exact pair"), of("pair"), is_exact, (0.65, 0.8, False)),
        _share(("mixed", "effect and instrument: both"), of("mixed"), is_exact, (0.65, 0.8, False)),
        _share(("unlisted", "unlisted: refused as a name"), of("unlisted"), is_refused, (0.7, 0.85, False)),
        _share(
            ("ambiguous", "ambiguous: the right set, not one name"), of("ambiguous"), is_undecided, (0.75, 0.9, False)
        ),
        _share(("poor", "too little data: said so"), of("poor"), is_modest, (0.75, None, False)),
        _share(("beyond", "asked for nothing: a wrong name"), of("beyond"), _wrong, (None, None, True)),
    ]
    found += _followed(sealed, answers)
    listed = [pair for pair in of("single", "pair", "mixed", "decoy") if sets_of(pair[1])]
    found.append(_share(("sets", "90 % name sets hold the truth"), listed, _held, (0.85, 0.88, False)))
    sizes = [len(sets_of(verdict)) for _, verdict in listed]
    found.append(_mean(("sizes", "90 % name sets: mean size"), sizes, (None, 1.4, True)))
    return [*found, *_spots(of("local")), *_gains(severe), *_about(pairs, answers.said)]


def _share(names, group, test, aims):
    """A row of a share; `names`: key and name, `aims`: must, goal, whether these are ceilings."""
    hits = sum(bool(test(*pair)) for pair in group)
    return Row(*names, hits / len(group) if group else float("nan"), len(group), wilson(hits, len(group)), *aims, hits)


def _median(names, values, aims):
    if not values:
        return Row(*names, float("nan"), 0, wilson(0, 0), *aims)
    return Row(*names, float(np.median(values)), len(values), median_bounds(values), *aims)


def _mean(names, values, aims):
    if not values:
        return Row(*names, float("nan"), 0, wilson(0, 0), *aims)
    half = Z * float(np.std(values, ddof=1)) / np.sqrt(len(values)) if len(values) > 1 else float("nan")
    middle = float(np.mean(values))
    return Row(*names, middle, len(values), (middle - half, middle + half), *aims)


def _nulls_of(kind, nulls):
    group = [pair for pair in nulls if pair[0].get("scatter") == kind]
    return _share((f"nulls, {kind}", f"  of these, scatter {kind}"), group, _blamed, (None, None, True))


def _blamed(label, verdict):
    return blames_skin(verdict)


def _told_instrument(label, verdict):
    return verdict["verdict"] == "instrument"


def _wrong(label, verdict):
    return bool(named(verdict) - set(label["names"]))


def _held(label, verdict):
    return frozenset(label["names"]) in sets_of(verdict)


def truth_of(label):
    """What a recording that settles it would show."""
    return {label["effect"]} if label["stratum"] == "ambiguous" else set(label["names"])


def _followed(sealed, answers):
    """Cases that could not be told and hold back protocols: whether the one advised settles them, or a random one."""
    advised = [name for name in sealed if name in answers.could_follow and sealed[name]["stratum"] != "poor"]

    def settled(after):
        return [({"truth": truth_of(sealed[name])}, after.get(name, SILENT)) for name in advised]

    def is_settled(label, verdict):
        return named(verdict) == label["truth"]

    recorded = [name for name in advised if name in answers.followed]
    return [
        _share(
            ("followed", "record this next, followed: settled"),
            settled(answers.followed),
            is_settled,
            (0.75, 0.9, False),
        ),
        _share(
            ("random", "  a random recording instead: settled"),
            settled(answers.at_random),
            is_settled,
            (None, None, False),
        ),
        _share(
            ("recorded", "  of those the trial can record: settled"),
            [pair for pair, name in zip(settled(answers.followed), advised, strict=True) if name in recorded],
            is_settled,
            (None, None, False),
        ),
        _mean(
            ("foretold", "  the same, as the advice foretold it"),
            [answers.foretold[name] for name in recorded if name in answers.foretold],
            (None, None, False),
        ),
    ]


def _spots(local):
    """Spots: whether they are named and nothing else, and of those named, where."""
    found = [(label, finding["where"]) for label, verdict in local for finding in places.of_spots(verdict)]
    misses = [places.miss(label, where) for label, where in found]
    overlaps = [places.overlap(label, where) for label, where in found if where.get("radius_mm")]
    sets = [pair for pair in found if places.has_set(pair[1])]
    return [
        _share(("spots", "spots: named, and nothing else"), local, is_exact, (0.85, 0.95, False)),
        _median(("miss", "spots: median miss, pitches"), misses, (1.0, 0.5, True)),
        _share(("spot sets", "spots: 90 % sets hold the place"), sets, places.is_in_set, (0.85, None, False)),
        _median(("overlap", "spots: median overlap (IoU)"), overlaps, (None, 0.5, False)),
    ]


def _gains(severe):
    """Reducible held-out error removed: where the right name was given, and wherever a gain is told."""

    def share(of):
        return (of.get("reducible_error_removed") or {}).get("value")

    def with_share(group):
        return [fit for _, verdict in group if share(fit := verdict.get("fit") or {}) is not None]

    def is_worse(_, of):
        return share(of) < 0.0

    exact = [pair for pair in severe if is_exact(*pair)]
    named = with_share(exact)
    checks = [(verdict.get("fit") or {}).get("by_contact_model") or {} for _, verdict in exact]
    asked = [by for by in checks if share(by) is not None]
    most_worse = (0.03, 0.01, True)
    return [
        _median(("removed", "named: reducible error removed, median"), list(map(share, named)), (0.75, 0.9, False)),
        _share(("worse", "named: held-out error made worse"), [({}, fit) for fit in named], is_worse, most_worse),
        _median(("removed by contact", "the same by the contact model"), list(map(share, asked)), (0.7, 0.9, False)),
        _share(
            ("worse by contact", "held-out error made worse by the contact model"),
            [({}, by) for by in asked],
            is_worse,
            most_worse,
        ),
        _share(
            ("worse switched on", "the same, where Switch On takes the finding"),
            [({}, by) for by in asked if not by.get("is_worse_than_without")],
            is_worse,
            most_worse,
        ),
        _median(
            ("removed by any", "kappa >= 1: removed, named or not, median"),
            list(map(share, with_share(severe))),
            (None, None, False),
        ),
    ]


def _about(pairs, said):
    """What the trial itself is: how well its truths hide, and how much of it was answered."""
    hidden = [pair for pair in pairs if pair[0]["stratum"] not in ("null", "poor", "local", "faint", "beyond")]
    return [
        _share(
            ("concealed", "concealed: R2 >= 0.98 after refitting the base"),
            hidden,
            lambda label, _: label["r2"] >= CONCEALED,
            (0.6, 0.6, False),
        ),
        Row(
            "answered", "answered", len(said) / len(pairs), len(pairs), wilson(len(said), len(pairs)), 1.0, 1.0, False,
            len(said),
        ),
    ]  # fmt: skip


def by_stratum(sealed, said):
    """Lines (stratum, kind, severity asked for, right, of) for every stratum."""
    rules = {
        "ambiguous": is_undecided,
        "unlisted": is_refused,
        "poor": is_modest,
        "null": lambda _, v: not blames_skin(v),
    }
    found = {}
    for name, label in sealed.items():
        right = rules.get(label["stratum"], is_exact)(label, said.get(name, SILENT))
        kind = label.get("effect") or label.get("distortion") or label.get("scatter", "")
        line = (label["stratum"], kind, label.get("wanted_kappa", 0.0))
        hits, of = found.get(line, (0, 0))
        found[line] = (hits + right, of + 1)
    return sorted((*line, *counts) for line, counts in found.items())


def wrong_names(sealed, said):
    """Lines (what it is, what else was named, whether beside the truth, how often)."""
    found = {}
    for name, label in sealed.items():
        verdict = said.get(name, SILENT)
        false = named(verdict) - set(label["names"])
        if false:
            truth = " + ".join(label["names"]) or label["stratum"]
            line = (truth, " + ".join(sorted(false)), bool(named(verdict) & set(label["names"])))
            found[line] = found.get(line, 0) + 1
    return sorted((*line, often) for line, often in found.items())


def among(sealed, said, rich):
    """Lines (row's key, right, of) of the cases that `rich` lists by row."""
    rules = {"instrument": _told_instrument, "ambiguous": is_undecided}
    for key, names in rich.items():
        if key != "followed":
            right = rules.get(key, is_exact)
            yield key, sum(right(sealed[name], said.get(name, SILENT)) for name in names), len(names)


def endings(sealed, said):
    """Lines (verdict or what was named, how often) of the ambiguous cases, the most frequent first."""
    found = Counter(_ending(label, said.get(name, SILENT)) for name, label in sealed.items() if _is_ambiguous(label))
    return found.most_common()


def _is_ambiguous(label):
    return label["stratum"] == "ambiguous"


def _ending(label, verdict):
    if is_undecided(label, verdict):
        return "the right set"
    false = named(verdict) - truth_of(label)
    if not named(verdict):
        return verdict["verdict"].replace("_", " ")
    if not false:
        return "named what is true"
    return "named what imitates it" if false <= set(label["names"]) else "named something else"


def exact_by_effect(sealed, said):
    """Lines (effect, right, of) of the cases of one effect that are as severe as the noise or more."""
    found = {}
    for name, label in sealed.items():
        if label["stratum"] == "single" and label["kappa"] >= REACHED:
            hits, of = found.get(label["effect"], (0, 0))
            found[label["effect"]] = (hits + is_exact(label, said.get(name, SILENT)), of + 1)
    return sorted((effect, *counts) for effect, counts in found.items())
