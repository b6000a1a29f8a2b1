"""Makes a hand over in place for another shape: same objects, pose and place, with what the user added."""

import json
from collections import OrderedDict

import numpy as np

from .. import names, workflow
from ..hand import build
from ..hand_look import look
from ..operators import display
from ..ownership import own, owned
from ..scene import write
from . import built, carrying, geometry, guards, rest_bones, weights

REMEMBERED = 6
"""Hands and users' work kept from edit to edit, about 2 MB each."""
_made = OrderedDict()
"""Shape as text -> arrays of the hand: going back and forth costs no second making."""
_sources = OrderedDict()
"""Digest of carried work -> the work as the user left it: many small edits blur no more than one."""


def reshape(context, hand, wanted):
    """Make `hand` over with the keywords `wanted` of `thenar.hand`; its spacing stays. Returns whether it changed.

    A contact on the hand is cleared. On a refusal nothing has changed. Raises `Refusal`.
    """
    was = built.from_text(hand.thenar_hand.built)
    shape = {**{name: was.shape[name] for name in ("spacing_mm",) if name in was.shape}, **wanted}
    if shape == was.shape:
        return False
    rig = guards.check(context, hand, was)
    carrying.check(hand)
    is_mirrored = shape.get("side", "right") != was.shape.get("side", "right")
    if is_mirrored:
        guards.check_side(rig)
    made = _hand(shape)
    clear_contact(context, hand)
    _make_over(context, hand, made, was)
    rest_bones.lay(context, rig, made, was)
    if is_mirrored:
        rest_bones.mirror(rig)
    context.view_layer.update()
    return True


def _make_over(context, hand, made, was):
    """Exchange the mesh of `hand`, made as `was`, for that of `made`, and put on it what the user added."""
    groups = build.group_names(made)
    kinds = weights.kinds_of(made, groups)
    work = carrying.take(hand, was, kinds)
    work = _sources.get(work.digest(), work)
    build.keep(hand, made, was.mm_per_unit)
    now = built.from_text(hand.thenar_hand.built)
    surface = np.asarray(made["vertices_mm"], np.float64), np.asarray(made["triangles"], np.int32)
    fresh = weights.of_made(made, groups)
    moved = None
    if not work.is_empty():
        moved = carrying.moved(work, now, surface, np.asarray(made["weights"], np.float64))
        fresh |= moved.groups
    geometry.replace(hand, (surface[0] / was.mm_per_unit, surface[1]), fresh)
    look.mark_skin(hand.data, made)
    keys = hand.data.shape_keys
    if moved is not None or keys is not None:
        carrying.put(hand, moved or carrying.Carried(now, *surface))
    if moved is not None:
        _remember(_sources, carrying.take(hand, now, kinds).digest(), work)


def _hand(shape):
    text = json.dumps(shape, sort_keys=True)
    if text not in _made:
        _remember(_made, text, build.make(**shape))
    _made.move_to_end(text)
    return _made[text]


def _remember(store, name, value):
    store[name] = value
    while len(store) > REMEMBERED:
        store.popitem(last=False)


def clear_contact(context, hand):
    """Take a contact off the hand, its map and its result: it belongs to the vertices that the hand has now."""
    settings = context.scene.thenar
    if settings.hand == hand and workflow.has_output(context):
        display.hide(context)
        workflow.clear(context)
    elif own.contact_key(hand) is not None or owned.is_own(hand.data, names.PRESSURE_KPA) or own.played_modifiers(hand):
        write.clear(context, hand, [])
