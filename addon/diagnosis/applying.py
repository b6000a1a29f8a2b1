"""Takes a finding over: the effect on the scene's hand with the finding's numbers, and into the study's model."""

import json
from dataclasses import dataclass

import numpy as np

from .. import languages, names, native
from ..properties import effect_settings
from ..results import sentences
from ..scene import matching
from ..scene.checks import Refusal
from ..scene.units import KPA_PER_MPA
from . import freshness, reading, wording

EVERYWHERE = {"", "default", names.WHOLE_SKIN}
"""What studies call skin that is not sorted into regions."""
PARAMETER = "region_stiffness"
"""What a diagnosis of grasps names that is a material's number."""
_AXES = "xyz"
_MOVED = 0.05
"""Part by which a modulus has to differ from the fit's to be said."""


@dataclass(frozen=True)
class Taken:
    """What was done: a sentence, and a doubt about it; empty if there is none."""

    sentence: str
    doubt: str


@dataclass(frozen=True)
class _Wanted:
    """An effect as it will stand on the hand."""

    row: dict
    region: str
    amplitude: float | None
    numbers: dict
    choices: dict


def apply(context, index):
    """Switch the finding of that number on. Returns `Taken`. Raises `Refusal`, with the scene as it was."""
    state = context.scene.thenar_diagnosis
    found = reading.parse(state.findings)
    finding = reading.finding(found, index)
    _refuse_parameter(finding)
    _refuse_unnamed(found, finding)
    doubt = " ".join(filter(None, (freshness.problem(state), _shows_less(found, finding), _moduli(found, finding))))
    row = next((row for row in native.effects() if row["name"] == finding["effect"]), None)
    if row is None:
        raise Refusal(f"Thenar has no effect '{finding['effect']}' to switch on; correct it by hand")
    title = wording.title(row["name"])
    if row["kind"] == "instrument":
        _to_model(state, finding)
        return Taken(f"{title} is the instrument's: nothing on the skin is changed; it is in the study's model", doubt)
    _refuse_worse(found, finding)
    hand = _hand(context)
    wanted = _wanted(context, found, finding, row)
    effect = _switch_on(hand, wanted)
    _to_model(state, finding)
    where = f"for '{sentences.region_title(effect.region)}'" if effect.region else "for all skin"
    where = "at its location" if "center_x_mm" in wanted.numbers else where
    is_over_time = effect_settings.acts_over_time(effect.name, effect_settings.chosen(effect))
    waits = "; it acts over time: bake to see it" if is_over_time else "; solve to see it"
    return Taken(f"{title} is on {where}{waits}", doubt)


def _shows_less(found, finding):
    """A doubt where the contact model, with what is switched on, predicts held-out recordings worse than the fit."""
    tried = reading.by_contact_model(found)
    check = (found.get("fit") or {}).get("by_contact_model") or {}
    if tried is None or not _was_tried(found, finding) or not check.get("is_behind_the_fit"):
        return ""
    if tried <= 0.0:
        return languages.iface(
            "The contact model with what is named predicts held-out recordings no better than without"
        )
    return languages.iface(
        "The contact model with what is named removes {share} of the error of held-out recordings, the fit {fit}: "
        "simulations show less than was found",
        share=wording.share(tried),
        fit=wording.share(check.get("removed_by_the_fit")),
    )


def _refuse_worse(found, finding):
    """Refuse what makes the contact model worse, beyond noise: simulations with it would be wrong."""
    check = (found.get("fit") or {}).get("by_contact_model") or {}
    if not check.get("is_worse_than_without") or not _was_tried(found, finding):
        return
    after, before = (wording.number((check.get(name) or {}).get("rms")) for name in ("after", "before"))
    named = wording.listed(wording.name(each["name"]) for each in found["model"]["effects"])
    raise Refusal(
        f"with {named} the contact model predicts held-out recordings worse than without: its error is {after} instead "
        f"of {before} standard deviations of the noise. What was found holds; simulations with it are wrong for these "
        "tools. To try it all the same, add it under Effects with the numbers of the letter"
    )


def _moduli(found, finding):
    """The moduli that an effect's numbers belong to, where they are not the fit's; empty otherwise."""
    check = (found.get("fit") or {}).get("by_contact_model") or {}
    factors = [factor for factor in check.get("moduli_over_the_fits") or () if factor is not None]
    materials = list(((found.get("model") or {}).get("materials") or {}).values())
    is_moved = any(abs(factor - 1.0) > _MOVED for factor in factors)
    if not is_moved or not materials or not _was_tried(found, finding):
        return ""
    g0, g_lim = (materials[0].get(name) for name in ("g0_mpa", "g_lim_mpa"))
    if g0 is None or g_lim is None:
        return ""
    return languages.iface(
        "Its numbers belong to G0 {g0} kPa and G Limit {g_lim} kPa under Materials",
        g0=wording.number(KPA_PER_MPA * g0),
        g_lim=wording.number(KPA_PER_MPA * g_lim),
    )


def _was_tried(found, finding):
    """Whether the contact model was asked about this finding: only about effects that curves name."""
    listed = (found.get("model") or {}).get("effects") or ()
    return finding.get("channel") in (None, "force") and any(e.get("name") == finding["effect"] for e in listed)


def _refuse_parameter(finding):
    """Refuse a region's stiffness: it is a material's number and no effect."""
    if finding["effect"] != PARAMETER:
        return
    region = sentences.region_title((finding.get("where") or {}).get("region") or "")
    numbers = finding.get("parameters") or {}
    value, factor = ((numbers.get(name) or {}).get("value") or 0.0 for name in ("g0_mpa", "factor"))
    raise Refusal(
        f"a region's stiffness is a parameter and no effect; set G0 of '{region}' to "
        f"{wording.number(value * KPA_PER_MPA)} kPa under Materials, and multiply its G Limit by {factor:.2f}"
    )


def _refuse_unnamed(found, finding):
    """Refuse what is no name: an unlisted cause, rivals that cannot be told apart, or too little data."""
    effect, verdict = finding["effect"], found["verdict"]
    rivals = reading.rivals(found, effect)
    next_text = next((told.get("text", "") for told in found.get("record_next", ())), "")
    remedy = (
        f"record this first: {next_text[:1].lower()}{next_text[1:]}".rstrip(".") if next_text else "record more first"
    )
    if verdict == "unlisted" or effect == "unlisted":
        raise Refusal(
            "what was found is not in Thenar's list of effects, so there is nothing to switch on; see the report"
        )
    if rivals:
        raise Refusal(
            f"these recordings cannot distinguish {wording.apart([effect, *rivals])}, "
            f"so neither is switched on; {remedy}"
        )
    if verdict not in reading.NAMED:
        word = {"cannot_tell": "cannot tell what is missing", "insufficient_data": "are too few to name anything"}
        told = word.get(verdict, "name no effect")
        raise Refusal(f"these recordings {told}, so {wording.name(effect)} is not switched on; {remedy}")


def _hand(context):
    hand = context.scene.thenar.hand
    if hand is None or hand.type != "MESH":
        raise Refusal("choose the hand's mesh under Hand first, so that the effect has skin to act on")
    if hand.library is not None or not hand.is_editable:
        raise Refusal(f"'{hand.name}' is linked from a library; use Object > Relations > Make Local > Selected & Data")
    return hand


def _wanted(context, found, finding, row):
    """The finding in the terms of the hand's properties. Raises `Refusal`.

    Its own numbers go before the model's, unless the contact model was held against held-out recordings with these.
    """
    amplitude, numbers, choices = reading.switched(found, finding["effect"])
    tried = reading.by_contact_model(found) is not None and _was_tried(found, finding)
    known = (set() if amplitude is None else {"amplitude"}) | numbers.keys() if tried else set()
    shapes = {shape["name"]: shape["unit"] for shape in row["shape"]}
    options = {choice["name"]: choice["options"] for choice in row["choices"]}
    for name, told in (finding.get("parameters") or {}).items():
        value, unit = told.get("value"), told.get("unit") or "1"
        if name in known:
            continue
        if name == "amplitude":
            amplitude = _checked(value, (finding, name))
        elif name in shapes:
            if unit != shapes[name]:
                raise Refusal(f"the finding gives {name} in {unit} and Thenar expects {shapes[name]}; diagnose again")
            numbers[name] = _checked(value, (finding, name))
        elif name in options:
            choices[name] = value
    numbers = {name: value for name, value in numbers.items() if name in shapes}
    choices = {name: value for name, value in choices.items() if value in options.get(name, ())}
    numbers |= _placed(context, finding, shapes)
    return _Wanted(row, _region(finding, context.scene.thenar.hand), amplitude, numbers, choices)


def _checked(value, about):
    finding, name = about
    if not isinstance(value, int | float) or not np.isfinite(value):
        raise Refusal(f"the finding '{finding['effect']}' has no number for {name}; diagnose again")
    return float(value)


def _region(finding, hand):
    """The hand's region that the finding names; empty for all skin."""
    region = (finding.get("where") or {}).get("region") or ""
    if region in EVERYWHERE or not hand.thenar.materials:
        return ""
    if region not in hand.thenar.materials:
        raise Refusal(
            f"the finding lies in region '{region}', which '{hand.name}' does not list; "
            "give its vertex group and row under Materials that name, or choose the hand that the study was taken from"
        )
    return region


def _placed(context, finding, shapes):
    """Place and directions of the finding in the frame of the hand at rest. Raises `Refusal` where that is unknown."""
    told = {name: each.get("value") for name, each in (finding.get("parameters") or {}).items()}
    center = (finding.get("where") or {}).get("center_mm")
    has_center = "center_x_mm" in shapes
    if has_center and "center_x_mm" in told:
        center = [told.get(f"center_{axis}_mm", 0.0) for axis in _AXES]
    turned = [told.get(f"direction_{axis}", float(axis == "x")) for axis in _AXES]
    has_direction = "direction_x" in shapes and bool(told.get("slope"))
    if not has_center and not has_direction:
        return {}
    if has_center and center is None:
        raise Refusal(f"the finding '{finding['effect']}' does not say where it lies; look at its report")
    match = on_hand(context)
    placed = {}
    if has_center:
        point = match.point_mm(center)
        placed |= {f"center_{axis}_mm": float(point[k]) for k, axis in enumerate(_AXES)}
    if has_direction:
        direction = match.direction(turned)
        placed |= {f"direction_{axis}": float(direction[k]) for k, axis in enumerate(_AXES)}
    return placed


def on_hand(context):
    """How the study's skin lies on the scene's hand. Raises `Refusal` if it does not, or cannot be read."""
    hand, path = context.scene.thenar.hand, context.scene.thenar_diagnosis.path
    if hand is None or hand.type != "MESH":
        raise Refusal("choose the hand's mesh under Hand first, so that the place can be shown on it")
    match = matching.on_scene_hand(context, native.module.Study.load(path).skin.vertices_mm)
    if match is None:
        raise Refusal(
            f"the study's skin is not '{hand.name}', so the place is not known on it; "
            "choose the hand that the study was taken from"
        )
    return match


def _switch_on(hand, wanted):
    """Change the effect of that name and region, or add it."""
    name, listed = wanted.row["name"], hand.thenar.effects
    effect = next((each for each in listed if each.name == name and each.region == wanted.region), None)
    if effect is None:
        effect = listed.add()
        effect_settings.fill(effect, wanted.row)
        effect.region = wanted.region
    hand.thenar.effect_index = list(listed).index(effect)
    effect.is_on = True
    if wanted.amplitude is not None:
        effect.amplitude = wanted.amplitude
    for name, value in wanted.numbers.items():
        effect.numbers[name].value = value
    for name, value in wanted.choices.items():
        effect.choices[name].value = value
    return effect


def _to_model(state, finding):
    """The study's model with the finding; once for each effect."""
    row = next((row for row in state.model if row.name == finding["effect"]), None) or state.model.add()
    row.name, row.kind = finding["effect"], finding.get("kind") or ""
    row.parameters = json.dumps(finding.get("parameters") or {})


def is_on(context, effect):
    """Whether a finding's effect is taken over: on the hand, or for an instrument in the study's model."""
    hand = context.scene.thenar.hand
    if effect in effect_settings.offered():
        return hand is not None and effect_settings.is_on(hand, effect)
    return effect in context.scene.thenar_diagnosis.model
