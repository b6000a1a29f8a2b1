"""Where on the scene's hand a finding lies, as vertices."""

import numpy as np

from ..scene import read, regions
from ..scene.checks import Refusal
from . import applying, reading


def vertices(context, index):
    """The hand's vertices (k,) at the place of the finding of that number. Raises `Refusal` if it has none."""
    state, hand = context.scene.thenar_diagnosis, context.scene.thenar.hand
    finding = reading.finding(reading.parse(state.findings), index)
    where = finding.get("where") or {}
    if where.get("vertices_csv"):
        found = _listed(applying.on_hand(context), where["vertices_csv"])
    elif where.get("center_mm") and where.get("radius_mm"):
        place = applying.on_hand(context).point_mm(where["center_mm"])
        apart = np.linalg.norm(read.rest_mm(context, hand) - place, axis=1)
        found = np.flatnonzero(apart <= max(where["radius_mm"], apart.min()))
    else:
        found = _region(context, hand, where.get("region"))
    if not len(found):
        raise Refusal(f"no vertex of '{hand.name}' lies at this place; choose the hand that the study was taken from")
    return found


def _listed(match, text):
    try:
        told = [int(number) for number in text.split(",") if number.strip()]
    except ValueError:
        raise Refusal("the finding does not list vertices by number; diagnose again") from None
    if not told or max(told) >= len(match.hand_of_other) or min(told) < 0:
        raise Refusal("the finding lists vertices that the study's skin has not; diagnose again")
    return match.on_hand(told)


def _region(context, hand, region):
    if region in (None, *applying.EVERYWHERE):
        raise Refusal("the finding holds for all of the skin; there is no single location to show")
    if hand is None or hand.type != "MESH" or region not in hand.vertex_groups:
        name = "the hand" if hand is None else f"'{hand.name}'"
        raise Refusal(f"{name} has no vertex group '{region}'; choose the hand that the study was taken from")
    return np.flatnonzero(regions.group_weights(context, hand, (region,))[0] > regions.LEAST_WEIGHT)
