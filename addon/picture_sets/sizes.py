"""Hands of the 5th, 50th and 95th percentile that grasp the scene's product again, with their prints in one scale."""

from dataclasses import dataclass

import bpy
import numpy as np

from .. import languages, status, workflow
from ..hand import build
from ..operators import running
from ..picture_stage import facts, laying, stage, views
from ..scene.checks import Refusal
from ..terminal import headless

PERCENTILES, MIDDLE = (5, 50, 95), 50
_FILL = 0.88
"""Share of its place that the print of the largest hand fills."""


@dataclass
class Hand:
    """A hand of a size: its percentile, its totals in words, or why there are none, and the pixels of its print."""

    percentile: int
    summary: str = ""
    grade: str = ""
    problem: str = ""
    pixels: object = None


def how(context):
    """How the hands grasp, in words."""
    settings = context.scene.thenar
    shape = _shape(settings.hand)
    pressed = f", then is pressed to {settings.force_n:g} N" if settings.use_force else ""
    grasped = f"each grasps the product by itself (firm){pressed}"
    return f"{shape['sex']} hands; {grasped}; prints in a scale of their own"


def drawn(order, context, size, progress):
    """The three hands; `size`: of each print, units of the page.

    Opens the file again for each, so that nothing read from it before may be used afterwards. The middle size is the
    first: the others hold the product by the same kind of grasp. A hand that cannot grasp or be solved has the reason
    in its place.
    """
    file, shape = bpy.data.filepath, _shape(context.scene.thenar.hand)
    pixels = tuple(round(value * order.factor) for value in size)
    largest = np.asarray(build.make(**shape, percentile=float(max(PERCENTILES)))["vertices_mm"])
    mm = float((np.ptp(largest, axis=0)[:2] / pixels).max() / _FILL)
    found, kind = [], "AUTO"
    for number, percentile in enumerate(sorted(PERCENTILES, key=lambda percentile: abs(percentile - MIDDLE))):
        progress.part(number, len(PERCENTILES), f"grasp of percentile {percentile}")(0.0)
        hand = Hand(percentile)
        found.append(hand)
        headless.open_file(file)
        try:
            subject = _solved(bpy.context, shape | {"percentile": float(percentile)}, kind)
        except Refusal as error:
            hand.problem = str(error)
            continue
        grasps = bpy.context.scene.thenar_grasps.found
        kind = grasps[0].kind if kind == "AUTO" and grasps else kind
        result, look = bpy.context.scene.thenar.result, bpy.context.scene.thenar
        hand.grade, hand.summary = result.grade, facts.summary(result)
        view = views.of_print(bpy.context, subject)
        window = stage.framing(subject.opened.points_mm(subject.scale), view, pixels)
        window = stage.Window(window.middle, mm, pixels)
        shot = stage.Shot(look, [subject.opened], view, window, subject.scale, samples=order.samples)
        hand.pixels = stage.take(shot)
    return sorted(found, key=lambda hand: hand.percentile)


def _shape(hand):
    kept = getattr(hand, "thenar_hand", None)
    if kept is None or not kept.is_made:
        return {"sex": "male", "side": "right"}
    return {"sex": kept.sex, "side": kept.side}


def _solved(context, shape, kind):
    """The `Subject` of a hand of that shape that grasps the product by the same buttons. Raises `Refusal`."""
    settings = context.scene.thenar
    workflow.clear(context)
    _take_out(context, settings.hand)
    settings.hand, _ = build.add_hand(context, build.make(**shape))
    try:
        bpy.ops.thenar.fit_grasp(strength="FIRM", kind=kind)
        bpy.ops.thenar.solve()
    except RuntimeError as error:  # what those operators report
        raise Refusal(_in_english(error)) from None
    return laying.gather(context)


def _in_english(error):
    """What an operator reported, for a picture: in English, as `status` keeps it, where it is the last error."""
    said, kept = " ".join(languages.reported(error).split()), status.last_error.partition(": ")[2]
    return kept if running.in_words(kept) == said else said


def _take_out(context, hand):
    """Remove a hand with its armature and what hangs on them; product parts that hang there stay where they are."""
    parts = workflow.product_parts(context.scene.thenar)
    top = hand.parent if hand.parent is not None and hand.parent.type == "ARMATURE" else hand
    gone = {hand, top, *hand.children_recursive, *top.children_recursive} - set(parts)
    for part in parts:
        if part.parent in gone:
            place = part.matrix_world.copy()
            part.parent, part.matrix_world = None, place
    for obj in gone:
        bpy.data.objects.remove(obj)
