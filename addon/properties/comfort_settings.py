"""Blender properties of comfort: which threshold counts, and the thresholds that only the user can know."""

import bpy
from bpy.props import EnumProperty, FloatProperty

from .. import status

RULES = (
    ("OFF", "Off", "Pressure is not assessed", 0),
    (
        "BLOOD_FLOW",
        "Blood flow, 50 kPa",
        "Skin blood flow on palm and fingers stops at about 50 kPa. The Hand in Manual Work, thesis, Chalmers 2004",
        1,
    ),
    (
        "DISCOMFORT",
        "Share of pain threshold",
        "Discomfort begins at 38 % (finger), 40 % (palm) and 22 % (thenar) of the pain threshold, which you enter: no "
        "value in kPa is known to hold for everybody. Perception of Surface Pressure Applied to the Hand",
        2,
    ),
    ("OWN", "Own thresholds", "Thresholds that you enter; 0: not assessed", 3),
)


def _changed(_self, context):
    for judge in status.comfort_changed:
        judge(context)


def _own(part, where):
    return FloatProperty(
        name=f"{part} (kPa)",
        description=f"Threshold, or pain threshold, of {where}, kPa; 0: unknown, not assessed",
        min=0.0,
        soft_max=1000,
        update=_changed,
    )


class ThenarComfort(bpy.types.PropertyGroup):
    """`scene.thenar.comfort`: the rule by which pressure is judged."""

    rule: EnumProperty(
        name="Threshold", description="Threshold that pressure is compared with", items=RULES, update=_changed
    )
    finger_kpa: _own("Finger", "finger and thumb pads")
    palm_kpa: _own("Palm", "the palm without the thenar")
    thenar_kpa: _own("Thenar", "the ball of the thumb")


CLASSES = (ThenarComfort,)
