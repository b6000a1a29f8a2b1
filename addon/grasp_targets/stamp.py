"""What a result of a target holds for: hand, product, pose and wishes, as a text that the panel compares."""

import base64
import json

import numpy as np

from .. import workflow
from ..hand_bones import reading
from ..recordings import laying
from ..recordings import settings as recordings
from ..scene.checks import Refusal
from . import parts, settings

SAME = 1e-4
"""Places and turns that differ by less, in the scene's own units, are the same ones."""


def of(context):
    """The stamp of the scene as it stands, a text."""
    places = base64.b64encode(np.float32(_places(context)).tobytes()).decode()
    return json.dumps({"wishes": _wishes(context), "places": places})


def holds(context, stamp):
    """Whether the scene still stands as when its `stamp` was taken."""
    if not stamp:
        return False
    kept = json.loads(stamp)
    if kept["wishes"] != json.loads(json.dumps(_wishes(context))):
        return False
    before, now = np.frombuffer(base64.b64decode(kept["places"]), np.float32), np.float32(_places(context))
    return before.shape == now.shape and np.allclose(before, now, rtol=0.0, atol=SAME)


def _wishes(context):
    """Names of hand and product, and what is wanted."""
    chosen, stored = context.scene.thenar, context.scene.thenar_targets
    hand = chosen.hand
    out = [stored.kind, *(part.name for part in workflow.product_parts(chosen))]
    out += [] if hand is None else [hand.name, len(hand.data.vertices)]
    if stored.kind == settings.FINGERS:
        return [*out, *(getattr(stored, f"{part}_n") for part in parts.PARTS)]
    item = recordings.chosen(context)
    if item is not None and item.kind == recordings.MAP:
        lie = laying.lie_of(item)
        out += [item.name, lie.path, lie.mat, lie.on, lie.axis, lie.diameter_mm, lie.turn_deg, *lie.shift_mm]
        out += [lie.is_mirrored, item.frame_rule, item.frame if item.frame_rule == "NUMBER" else 0]
    return out


def _places(context):
    """Where bones, hand and product stand; the move of a product by a Solve is not counted."""
    chosen, out = context.scene.thenar, []
    if chosen.hand is not None:
        out.append(np.ravel(chosen.hand.matrix_world))
        armature = _armature(chosen.hand)
        if armature is not None:
            bones = np.empty(16 * len(armature.pose.bones), np.float32)
            armature.pose.bones.foreach_get("matrix", bones)
            out += [np.ravel(armature.matrix_world), bones]
    for part in workflow.product_parts(chosen):
        turn = part.rotation_quaternion if part.rotation_mode == "QUATERNION" else part.rotation_euler
        out += [part.location, turn, part.scale]
        if part.parent is not None:
            out.append(np.ravel(part.parent.matrix_world))
    return np.concatenate([np.zeros(0), *out])


def _armature(hand):
    try:
        return reading.armature_of(hand)
    except Refusal:
        return None
