"""Comfort: where pressure lies over a threshold, by region. Every threshold has a source, or is the user's own.

No pain or discomfort threshold of the hand in kPa by region was found that could be checked, so none is built in.
"""

from dataclasses import dataclass

import numpy as np
from bpy.types import Context

from .. import names
from ..scene import attributes
from ..scene.units import KPA_PER_MPA, cm2
from . import result, sentences

OFF, BLOOD_FLOW, DISCOMFORT, OWN = "OFF", "BLOOD_FLOW", "DISCOMFORT", "OWN"
BLOOD_FLOW_KPA = 50.0
"""Skin blood flow on palm and fingers stops at about this: The Hand in Manual Work, thesis, Chalmers 2004, abstract."""
DISCOMFORT_SHARES = {"finger": 0.38, "palm": 0.40, "thenar": 0.22}
"""Discomfort over pain threshold at pressed points: Perception of Surface Pressure Applied to the Hand, abstract."""
SOURCES = {
    BLOOD_FLOW: "skin blood flow stops at about 50 kPa (The Hand in Manual Work, thesis, Chalmers 2004)",
    DISCOMFORT: "discomfort at 38 % (finger), 40 % (palm), 22 % (thenar) of your pain thresholds "
    "(Perception of Surface Pressure Applied to the Hand)",
    OWN: "thresholds that you entered",
}
_NAMED = 3
"""Regions that the sentence names."""


@dataclass(frozen=True)
class Verdict:
    """What lies over the thresholds: kPa (0: none known) and mm² by region, and the sentence for a designer."""

    thresholds_kpa: tuple
    over_mm2: tuple
    sentence: str


def part_of(region_name):
    """The part of the hand whose threshold counts for a region: finger, palm, thenar; empty if its name tells none."""
    words = region_name.lower().replace(".", "_").replace("-", "_").replace(" ", "_").split("_")
    if "thenar" in words:
        return "thenar"
    finger = result.finger_of(region_name)
    return finger if finger == "palm" else ("finger" if finger in result.FINGERS or "finger" in finger else "")


def threshold_kpa(region_name, given):
    """The region's threshold under `scene.thenar.comfort`, kPa; 0 where none is known.

    A region whose name tells no part of the hand takes the lowest that is known.
    """
    if given.rule == BLOOD_FLOW:
        return BLOOD_FLOW_KPA
    shares = DISCOMFORT_SHARES if given.rule == DISCOMFORT else dict.fromkeys(DISCOMFORT_SHARES, 1.0)
    known = {part: share * getattr(given, f"{part}_kpa") for part, share in shares.items()}
    part = part_of(region_name)
    return known[part] if part else min((value for value in known.values() if value > 0.0), default=0.0)


def judge(context: Context) -> None:
    """Judge the result on the hand: rows of the result table, the sentence, and the attribute of the map."""
    settings = context.scene.thenar
    hand, outcome, given = settings.hand, settings.result, settings.comfort
    mesh = hand.data if hand is not None and hand.type == "MESH" and hand.mode != "EDIT" else None
    needed = () if given.rule == OFF or mesh is None else (names.PRESSURE_KPA, names.FORCE_N, names.REGION)
    fields = [attributes.read(mesh, name) for name in needed]
    if not fields or not outcome.is_valid or any(field is None for field in fields):
        if outcome.comfort_source:  # else nothing was judged since, and every row still says so
            outcome.comfort_source = ""
            _write(outcome, Verdict((0.0,) * len(outcome.regions), (0.0,) * len(outcome.regions), ""))
        if mesh is not None and mesh.is_editable:
            attributes.remove(mesh, [names.THRESHOLD_SHARE])
        return
    thresholds = [threshold_kpa(row.name, given) for row in outcome.regions]
    verdict = judged([row.name for row in outcome.regions], thresholds, fields)
    outcome.comfort_source = SOURCES[given.rule]
    _write(outcome, verdict)
    pressure, _, region = fields
    share = np.zeros(len(pressure))
    limits = np.array([*thresholds, 0.0])[region]
    np.divide(pressure, limits, out=share, where=limits > 0.0)
    attributes.write(mesh, names.THRESHOLD_SHARE, "FLOAT", share)


def judged(region_names, thresholds_kpa, fields):
    """The `Verdict` on `fields`: pressure (n), kPa, force (n), N, and region (n) by vertex, -1 for none."""
    pressure, force, region = (np.asarray(field, dtype=np.float64) for field in fields)
    area = np.divide(force * KPA_PER_MPA, pressure, out=np.zeros_like(force), where=pressure > 0.0)
    over, touched = [], 0.0
    for index, limit in enumerate(thresholds_kpa):
        inside = region == index
        touched += area[inside].sum() if limit > 0.0 else 0.0
        over.append(float(area[inside & (pressure > limit)].sum()) if limit > 0.0 else 0.0)
    return Verdict(tuple(thresholds_kpa), tuple(over), _sentence(region_names, thresholds_kpa, (over, touched)))


def _sentence(region_names, thresholds, areas):
    over, touched = areas
    unknown = sum(limit == 0.0 for limit in thresholds)
    if unknown == len(thresholds):
        return "No threshold is known; enter yours under Comfort"
    worst = sorted((area, name) for name, area in zip(region_names, over, strict=True) if area > 0.0)[::-1]
    if worst:
        listed = ", ".join(f"{sentences.region_title(name)} {_area(area)}" for area, name in worst[:_NAMED])
        if len(worst) > _NAMED:
            listed = f"{listed} and {len(worst) - _NAMED} more regions"
        area, share = _area(sum(over)), sum(over) / max(touched, 1e-12)
        text = f"{area} ({share:.0%} of the contact) exceeds its threshold: {listed}"
    else:
        text = "No pressure exceeds its threshold"
    if unknown == 1:
        return f"{text}; one region has no threshold"
    return f"{text}; {unknown} regions have no threshold" if unknown else text


def _area(area_mm2):
    return f"{area_mm2:.0f} mm²" if area_mm2 < 100.0 else f"{cm2(area_mm2):.1f} cm²"


def _write(outcome, verdict):
    for row, limit, area in zip(outcome.regions, verdict.thresholds_kpa, verdict.over_mm2, strict=True):
        row.threshold_kpa, row.over_mm2 = limit, area
    over = {}
    for row, area in zip(outcome.regions, verdict.over_mm2, strict=True):
        name = result.finger_of(row.name)
        over[name] = over.get(name, 0.0) + area
    for finger in outcome.fingers:
        finger.over_mm2 = over.get(finger.name, 0.0)
    outcome.over_mm2, outcome.comfort = sum(verdict.over_mm2), verdict.sentence
