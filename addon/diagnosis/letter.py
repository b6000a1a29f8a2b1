"""The diagnosis as a letter: what a designer reads, in order, from the library's findings. Knows nothing of layout.

The sentence below the heading is the library's: `rust/diagnosis/src/verdict_sentence.rs`, for grasps `grasp/notes.rs`.
"""

from dataclasses import dataclass

from ..results import sentences
from ..scene.units import KPA_PER_MPA
from . import reading, wording

HEADINGS = {
    "nothing_missing": "Nothing is missing",
    "parameters": "Only parameters were off",
    "instrument": "It is the instrument",
    "missing_physics": "Physics is missing",
    "cannot_tell": "Cannot tell yet",
    "unlisted": "Not in the list",
    "insufficient_data": "Too few recordings",
}
UNNAMED = "No effect is named"
"""Instead, where nothing is named and more than noise is left."""

_UNSAID = {"nothing_missing", "parameters", "unlisted"}
"""Verdicts after which the list of what it might be says nothing: what is small enough is on it, or it is none."""
_SETS = 4
"""Sets of names that are told."""
UNMEASURED = "confidence not measured"
"""Of findings of a kind that too few calibration studies have shown."""


@dataclass(frozen=True)
class Row:
    """A word and what stands beside it."""

    label: str
    text: str


@dataclass(frozen=True)
class Entry:
    """One finding.

    `index` is its number, `sureness` 0 to 1 or None, `rows` its numbers and choices, `story` where and when it shows,
    `signs` what must show in the recordings if it is there, with whether it does, and `has_place` whether the skin can
    show it.
    """

    index: int
    effect: str
    title: str
    is_instrument: bool
    sureness: float | None
    meaning: str
    rows: tuple
    story: str
    signs: tuple
    has_place: bool


@dataclass(frozen=True)
class Bar:
    """An error as a bar: `share` of the longest, 0 to 1."""

    label: str
    text: str
    share: float


@dataclass(frozen=True)
class Advice:
    """A recording to make next."""

    text: str
    settles: str
    outlook: str


@dataclass(frozen=True)
class Letter:
    """The whole of it; tuples are empty where there is nothing to say."""

    verdict: str
    heading: str
    sentence: str
    entries: tuple
    depends: tuple
    depends_note: str
    phases: tuple
    rivals: tuple
    bars: tuple
    gain: tuple
    advice: tuple
    smallest: tuple
    moduli: tuple
    notes: tuple


def write(found):
    """The letter of parsed findings."""
    bars, gain = _fit(found.get("fit") or {})
    return Letter(
        verdict=found["verdict"],
        heading=_heading(found),
        sentence=found.get("sentence") or "",
        entries=tuple(_entry(found, index) for index in range(len(found.get("findings", ())))),
        depends=tuple(_depends(found.get("unlisted") or {})),
        depends_note=_depends_note(found.get("unlisted") or {}),
        phases=tuple(_phases(found)),
        rivals=tuple(_rivals(found)),
        bars=bars,
        gain=gain,
        advice=tuple(_advice(each) for each in found.get("record_next", ())),
        smallest=tuple(
            Row(wording.title(effect), wording.least(seen))
            for effect, seen in (found.get("smallest_seen") or {}).items()
        ),
        moduli=tuple(_moduli(found)),
        notes=tuple(text[:1].upper() + text[1:].rstrip(".") + "." for text in found.get("notes") or () if text),
    )


def _heading(found):
    is_more = found.get("is_more_than_noise")
    if is_more is None:  # findings of an earlier version, whose sentence says it alone
        is_more = (found.get("sentence") or "").startswith(UNNAMED)
    is_unnamed = is_more and found["verdict"] in ("nothing_missing", "parameters")
    return UNNAMED if is_unnamed else HEADINGS[found["verdict"]]


def lines(letter):
    """The letter as plain lines of text."""
    yield letter.heading
    yield letter.sentence
    for entry in letter.entries:
        sure = UNMEASURED if entry.sureness is None else f"{wording.share(entry.sureness)} confidence"
        yield f"{entry.index + 1}. {entry.title}, {sure}"
        yield from (f"   {text}" for text in (entry.meaning, entry.story) if text)
        yield from (f"   {row.label}: {row.text}" for row in entry.rows)
        yield from (f"   {'Seen' if holds else 'Not seen'}: {sign}" for sign, holds in entry.signs)
    yield from (f"Depends on {bar.label.lower()}: {bar.text}" for bar in letter.depends)
    yield from (f"Evidence {bar.label}: {bar.text}" for bar in letter.phases)
    yield from letter.rivals
    yield from (f"{bar.label}: {bar.text}" for bar in letter.bars)
    yield from letter.gain
    for advice in letter.advice:
        yield f"Record next: {advice.text}"
        yield from (text for text in (advice.settles, advice.outlook) if text)
    yield from (f"Detection limit, {row.label.lower()}: {row.text}" for row in letter.smallest)
    yield from (f"Fitted, {row.label}: {row.text}" for row in letter.moduli)
    yield from letter.notes


def _entry(found, index):
    finding = found["findings"][index]
    where, when = finding.get("where") or {}, finding.get("when") or {}
    numbers = finding.get("parameters") or {}
    is_fitted = finding.get("channel") in (None, "force")  # a mat's ceiling and its dead cells are read
    rows = [Row(wording.number_title(key, numbers), wording.estimate(each, is_fitted)) for key, each in numbers.items()]
    _, _, choices = reading.switched(found, finding["effect"])
    rows += [Row(wording.title(name), wording.title(option)) for name, option in choices.items()]
    record = finding.get("track_record") or {}
    if record.get("stated"):
        counts = f"right in {record['right']} of {record['stated']} such findings of calibration studies"
        rows.append(Row("Track record", counts))
    story = (wording.place(where), wording.moment(when), wording.depends(finding.get("depends_on")))
    return Entry(
        index=index,
        effect=finding["effect"],
        title=wording.title(finding["effect"]),
        is_instrument=finding.get("kind") == "instrument",
        sureness=finding.get("confidence"),
        meaning=wording.meaning(finding["effect"]),
        rows=tuple(rows),
        story=" ".join(text for text in story if text),
        signs=tuple((each["sentence"], bool(each["holds"])) for each in finding.get("consequences") or ()),
        has_place=bool(where.get("center_mm") or where.get("vertices_csv") or where.get("region")),
    )


def _depends(unlisted):
    """What something without a name goes with: the share that a correction by it removes, or the rhythm of it."""
    for told in unlisted.get("depends_on") or ():
        removed = told.get("removed")
        if removed is not None:
            yield Bar(wording.depended(told["on"]), wording.share(removed), min(max(removed, 0.0), 1.0))
    rhythm = unlisted.get("rhythm")
    if rhythm:
        yield Bar("Periodic component", f"{wording.number(rhythm['hz'])} Hz, {rhythm['per_minute']:.0f}/min", 1.0)


def _depends_note(unlisted):
    if unlisted.get("correction"):
        return "Removed by an empirical correction on held-out protocols; it shows a dependence, not its cause"
    return "Found from differences between repeats; its phase differs in each" if unlisted.get("rhythm") else ""


def _phases(found):
    """The share of the evidence for what was named from force over depth that stands in each phase."""
    of_force = (each for each in found.get("findings", ()) if each.get("channel", "force") == "force")
    named = sorted(finding["effect"] for finding in of_force)
    tried = (each for each in found.get("rivals") or () if sorted(each.get("effects") or ()) == named and named)
    ledger = (next(tried, None) or {}).get("ledger") or {}
    gained = {phase: ledger.get(phase) or 0.0 for phase in wording.PHASES}
    whole = sum(value for value in gained.values() if value > 0.0)
    for phase, value in gained.items():
        if value > 0.0:
            yield Bar(wording.PHASES[phase], wording.share(value / whole), value / whole)


def _rivals(found):
    """What cannot be distinguished, what is suspected only, and what else the name may be at 90 %."""
    for effects in found.get("cannot_tell", ()):
        yield f"These recordings cannot distinguish {wording.apart(effects)}."
    suspected = found.get("suspected")
    if suspected:
        words = wording.listed(wording.name(effect) for effect in suspected)
        yield f"Suspected only, not a finding: {words}. See the notes for what would settle it."
    sets = found.get("names_90") or []
    if len(sets) > 1 and found["verdict"] not in _UNSAID:
        words = [wording.listed(wording.name(effect) for effect in effects) or "nothing" for effects in sets]
        more = f"; and {len(words) - _SETS} more" if len(words) > _SETS else ""
        yield f"At 90 % the explanation is one of: {'; '.join(words[:_SETS])}{more}."


def _fit(fit):
    """Bars of the error before, after and at the noise floor, and sentences on what was gained."""
    told = [("Before", fit.get("before")), ("After", fit.get("after")), ("Noise floor", fit.get("noise_floor"))]
    told = [(label, each) for label, each in told if each and each.get("rms") is not None]
    longest = max((each["rms"] for _, each in told), default=0.0)
    bars = tuple(
        Bar(label, wording.value({**each, "value": each["rms"]}), each["rms"] / longest if longest > 0.0 else 0.0)
        for label, each in told
    )
    return bars, tuple(_gain(fit))


def _moduli(found):
    """Both shear moduli of each region of the study's skin as they were fitted, kPa."""
    for region, numbers in ((found.get("model") or {}).get("materials") or {}).items():
        both = [numbers.get(name) for name in ("g0_mpa", "g_lim_mpa")]
        told = [wording.number(KPA_PER_MPA * value) for value in both if value is not None]
        if told:
            yield Row(sentences.region_title(region), f"G {' to '.join(told)} kPa")


def _gain(fit):
    removed = fit.get("reducible_error_removed")
    if removed and removed.get("value") is not None:
        low, high = removed.get("low"), removed.get("high")
        between = "" if low is None or high is None else f" ({wording.share(low)} to {wording.share(high)})"
        if low is not None and low < 0.0:
            yield "The share of the reducible error that is removed cannot be given: noise is larger than the effect."
        else:
            yield f"{wording.share(removed['value'])}{between} of the reducible error is removed."
    check = fit.get("by_contact_model") or {}
    tried = check.get("reducible_error_removed") or {}
    if check.get("is_worse_than_without"):
        yield "The contact model with what is named predicts held-out recordings worse than without."
    elif tried.get("high") is not None and tried["high"] <= 0.0:
        yield "The contact model with what is switched on predicts them no better than without."
    elif tried.get("low") is not None and tried["low"] >= 0.0:
        yield f"With what is switched on the contact model itself removes {wording.share(tried['value'])}."
    score = fit.get("log_score")
    if score and score.get("value") is not None:
        text = f"The log predictive density of held-out recordings rises by {wording.number(score['value'])}"
        if score.get("placebo") is not None:
            most = wording.number(max(score["placebo"], 0.0))
            text += f"; by the same change on the wrong recordings and moments (negative control) by {most} at most"
        yield f"{text}."
    held_out = fit.get("held_out")
    if held_out:
        count = len(held_out)
        plural = "" if count == 1 else "s"
        yield f"Evaluated on {count} held-out recording{plural}: {wording.some(held_out)}."


def _advice(told):
    settles = told.get("settles") or []
    words = wording.apart([each if isinstance(each, str) else " and ".join(each) for each in settles])
    outlook = []
    if told.get("probability") is not None:
        outlook.append(f"settles it in {wording.share(told['probability'])} of cases")
    if told.get("minutes") is not None:
        outlook.append(f"{wording.number(told['minutes'])} min")
    return Advice(
        text=told.get("text") or "",
        settles=f"Distinguishes {words}." if words else "",
        outlook=", ".join(outlook)[:1].upper() + ", ".join(outlook)[1:],
    )
