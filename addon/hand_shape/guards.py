"""Refuses, with a sentence, every hand that cannot be made over in place, or only with loss of the user's work."""

import bpy
import numpy as np

from ..hand_bones import reading
from ..hand_look import look
from ..operators import polling
from ..scene import checks
from ..scene.checks import Refusal

MOVED_MM = 0.05
"""A bone whose rest moved by less was not moved: Edit Mode rounds to about 1e-4 mm."""
TURNED = 1e-3
"""The same for the direction of its palm side, radians."""
_BOUND = {"SURFACE_DEFORM": "is_bound", "MESH_DEFORM": "is_bound", "LAPLACIANDEFORM": "is_bind"}


def check(context, hand, made):
    """Refuse a hand that cannot be made over; `made`: its `Built`. Returns the armature. Raises `Refusal`."""
    settings = context.scene.thenar
    live = polling.live(context) if settings.hand == hand else ""
    problem = polling.wrong_mode(context) or polling.busy() or live
    if problem:
        raise Refusal(problem)
    checks.check_hand(context, hand)
    rig = reading.armature_of(hand)
    checks.check_visible(context, rig, "armature")
    if not rig.data.is_editable or rig.library is not None or rig.override_library is not None:
        raise Refusal(f"the armature '{rig.name}' is linked from another file; make it local first")
    if rig.data.users - rig.data.use_fake_user > 1:
        raise Refusal(
            f"the bones of '{rig.name}' are shared by several objects; "
            "use Object > Relations > Make Single User > Object & Data"
        )
    _check_mesh(hand, made)
    _check_bones(rig, made)
    check_bound(hand)
    return rig


def check_side(rig):
    """Refuse to mirror a rig that keyframes or drivers move. Raises `Refusal`."""
    data = rig.animation_data
    if data is not None and (data.action is not None or len(data.nla_tracks) or len(data.drivers)):
        raise Refusal(
            f"'{rig.name}' is animated, and its keyframes would not be mirrored; "
            "make a new hand of the other side, or remove the animation first"
        )


def _check_mesh(hand, made):
    mesh = hand.data
    rest = mesh.attributes.get(look.REST)
    is_whole = (len(mesh.vertices), len(mesh.polygons)) == (made.vertices, made.faces)
    if not is_whole or rest is None or len(mesh.loops) != 3 * len(mesh.polygons):
        raise Refusal(
            f"'{hand.name}' has {len(mesh.vertices):,} vertices and was made with {made.vertices:,}: its mesh was "
            "edited or refined, and a new size would lose that; make a new hand of the size first, "
            "then edit or refine it"
        )


def _check_bones(rig, made):
    for name, (head, tail, facing) in made.bones.items():
        bone = rig.data.bones.get(name)
        if bone is None:
            raise Refusal(
                f"'{rig.name}' has no bone '{name}' any more; undo its renaming or removal, or make a new hand"
            )
        ends = np.array([bone.head_local, bone.tail_local]) * made.mm_per_unit
        turned = np.array(bone.matrix_local.col[2][:3]) - facing
        if np.abs(ends - [head, tail]).max() > MOVED_MM or np.abs(turned).max() > TURNED:
            raise Refusal(
                f"the rest of bone '{name}' of '{rig.name}' was changed, and a new size would lose that; "
                "undo the change, or make a new hand of the size"
            )


def check_bound(hand):
    """Refuse a hand to whose vertices something is bound by number. Raises `Refusal`."""
    for modifier in hand.modifiers:
        holds = modifier.type == "MULTIRES" or (modifier.type == "HOOK" and len(modifier.vertex_indices))
        smooth = modifier.type == "CORRECTIVE_SMOOTH" and modifier.rest_source == "BIND" and modifier.is_bind
        if holds or smooth or getattr(modifier, _BOUND.get(modifier.type, ""), False):
            raise Refusal(
                f"the modifier '{modifier.name}' of '{hand.name}' is bound to its vertices; apply, unbind or remove it"
            )
    for other in bpy.data.objects:
        if other.parent == hand and other.parent_type in {"VERTEX", "VERTEX_3"}:
            raise Refusal(f"'{other.name}' is parented to vertices of '{hand.name}'; parent it to a bone instead")
        for modifier in other.modifiers:
            if modifier.type == "SURFACE_DEFORM" and modifier.target == hand and modifier.is_bound:
                raise Refusal(
                    f"the modifier '{modifier.name}' of '{other.name}' is bound to the vertices of '{hand.name}'; "
                    "unbind it first"
                )
