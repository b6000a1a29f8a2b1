"""The operator that looks for grasps of other kinds, and adds them to those found. The hand stays where it is."""

import json
from functools import partial

import bpy

from .. import languages, native, workflow
from ..grasp import fitting, settings, ways
from ..grasp_fit import fitter
from ..hand import pads
from ..hand.operators import can_pose
from ..operators import computing, polling
from ..scene.checks import Refusal
from . import panel, reasons

KINDS = (ways.POWER, ways.PINCH, ways.LATERAL, ways.HOOK)
"""Kinds of grasps that are sought."""


class THENAR_OT_more_grasps(computing.Computing, bpy.types.Operator):
    """Look for grasps of the other kinds, power, pinch, lateral and hook, and add them to the list; the hand stays as \
it is"""

    bl_idname = "thenar.more_grasps"
    bl_label = "Look for Other Kinds"
    bl_options = {"REGISTER", "UNDO"}
    noun = "Search"

    @classmethod
    def poll(cls, context):
        found = getattr(context.scene, "thenar_grasps", None)
        problem = "" if found is not None and found.found else "no grasp was found yet; press Grasp first"
        return polling.allows(cls, polling.no_product(context), problem) and can_pose(cls, context)

    def steps(self, context):
        stored, parts = context.scene.thenar_grasps, workflow.product_parts(context.scene.thenar)
        have, rows, refused = {row.kind for row in stored.found}, [], []
        first = json.loads(stored.found[0].facts or "{}")
        for kind in KINDS:
            if kind in have:
                continue
            wish = fitting.wish_of(fitter.Wish(pads.FIRM_MM), kind)
            fit = fitting.prepare(context, context.scene.thenar.hand, parts, wish)
            _refuse_another(stored, fit)
            asked = fitting.asked_of(_strength(stored.found[0].kind, first.get("asked_n")), kind=kind)
            try:
                found = yield partial(fitting.search_all, fit, asked)
            except (Refusal, native.module.SolveError) as refusal:
                if "cancelled" in str(refusal):
                    raise
                refused.append(kind)
                continue
            rows += fitting.rows_of(found[:1])
        _add(stored, rows)
        return [row["kind"] for row in rows], refused

    def _report(self, context, outcome):
        added, refused = (", ".join(languages.inside(reasons.KINDS[kind]) for kind in kinds) for kinds in outcome)
        if added and refused:
            text = languages.report("Added: {added}; does not hold: {refused}", added=added, refused=refused)
        elif added or refused:
            words = "Added: {kinds}" if added else "Nothing added; does not hold: {kinds}"
            text = languages.report(words, kinds=added or refused)
        else:
            text = languages.report("All kinds are in the list already")
        self.report({"INFO"}, text)
        return {"FINISHED"}


def _refuse_another(stored, fit):
    if fitting.named(fit) != (stored.hand, stored.product):
        raise Refusal("the grasps were found for another hand or product; press Grasp again")


_BY_KIND = {ways.POWER: fitting.TOTALS_N, ways.HOOK: fitting.HUNG_N}


def _strength(kind, asked_n):
    """The strength that the first grasp of the list, of a kind, was asked for."""
    known = _BY_KIND.get(kind, fitting.PINCHES_N)
    return "LIGHT" if asked_n is not None and asked_n < 0.5 * (known["LIGHT"] + known["FIRM"]) else "FIRM"


def _add(stored, rows):
    """Add rows to those of the scene: Auto's choice first, then by score; the grasp that is shown stays so."""
    old = [{name: getattr(row, name) for name in settings.FIELDS} for row in stored.found]
    shown = old[stored.shown]["pose"] if 0 <= stored.shown < len(old) else None
    rows = [old[0], *sorted([*old[1:], *rows], key=lambda row: row["score"])]
    settings.keep(bpy.context.scene, (stored.hand, stored.product), rows)
    stored.shown = next((number for number, row in enumerate(rows) if row["pose"] == shown), -1)


def register():
    """Register the operator."""
    bpy.utils.register_class(THENAR_OT_more_grasps)


def unregister():
    """Unregister it, and drop the pictures."""
    panel.forget()
    bpy.utils.unregister_class(THENAR_OT_more_grasps)
