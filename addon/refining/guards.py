"""Refuses, with a sentence, every hand whose own mesh cannot be made finer, or only with loss of the user's work."""

from ..hand_shape import guards
from ..operators import polling
from ..ownership import own
from ..scene.checks import Refusal

PLAYED = {"MESH_CACHE", "MESH_SEQUENCE_CACHE", "CLOTH", "SOFT_BODY"}
"""Modifiers that play or simulate positions by vertex number."""


def check(context, hand):
    """Refuse a hand, already fit for Solve, whose mesh must keep its vertices. Raises `Refusal`."""
    problem = polling.wrong_mode(context) or polling.busy() or polling.live(context)
    if problem:
        raise Refusal(problem)
    if own.bake_modifiers(hand) or hand.thenar.bake_path:
        raise Refusal(
            f"'{hand.name}' plays a bake, which belongs to the vertices that the hand has now; "
            "press Clear first, then Refine Skin, and bake again"
        )
    for modifier in hand.modifiers:
        if modifier.type == "MULTIRES":
            raise Refusal(
                f"'{modifier.name}' (Multiresolution) of '{hand.name}' sculpts on the vertices that the mesh has now; "
                "apply it, then press Refine Skin"
            )
        if modifier.type == "SUBSURF" and modifier.subdivision_type == "CATMULL_CLARK" and _is_shown(modifier):
            raise Refusal(
                f"'{modifier.name}' (Subdivision) of '{hand.name}' would give a refined mesh another shape; raise "
                "its level to show a finer skin, or apply it, then press Refine Skin"
            )
        if modifier.type in PLAYED:
            raise Refusal(
                f"'{modifier.name}' of '{hand.name}' plays positions by vertex number; apply or remove it, "
                "then press Refine Skin"
            )
    guards.check_bound(hand)


def _is_shown(modifier):
    return modifier.show_viewport or modifier.show_render
