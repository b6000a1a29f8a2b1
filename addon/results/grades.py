"""The grade of a result: the library's, and what the shown surface adds to it. Knows nothing of Blender."""

from dataclasses import dataclass
from typing import Any

GOOD, READ, DO_NOT = "good", "read this", "do not use"
ORDER = (GOOD, READ, DO_NOT)
MOST_SHOWN_MM = 0.05
"""How deep the shown skin may lie in the product before its numbers are not those of what is seen."""


@dataclass(frozen=True)
class Judgement:
    """A grade with its gravest reason in words: `kind` names what it is, `vertex` where on the hand, -1 for nowhere."""

    grade: str
    reason: str = ""
    kind: str = ""
    vertex: int = -1


COARSE_SKIN = ("few_vertices", "product_between_vertices", "unsolved", "penetration")
"""Kinds of reasons that finer skin may mend."""
NO_CONTACT = "no_contact"
"""The kind of a contact that touches nothing; finer skin mends it where the product passes between vertices."""
CUT_MM = 0.1
"""How deep flat triangles of the shown skin may cut into the product before finer skin is offered."""
_FINER = ("refine the hand", "refine the skin", "subdivide the hand")
"""What sentences ask for that finer skin mends."""


_HEADINGS = {
    "shown_penetration": "The skin as shown lies inside the product",
    "hand_size": "The hand has an unusual size",
    "beyond_stiffening": "Deeper than the skin's stiffening is known",
    "beyond_theory": "Deeper than the model is made for",
    "beyond_tissue": "Deeper than the soft tissue is thick",
    "bare_parts_inside": "Parts of the hand without a region lie inside the product",
    "product_inside_hand": "The product lies inside the hand",
    "no_contact": "No contact",
    "coarse_product": "The product's mesh is coarse",
    "few_vertices": "Few vertices carry the contact",
    "product_between_vertices": "The product passes between the skin's vertices",
    "sharp_edge": "Contact at a sharp edge",
    "peak_in_crease": "The peak lies in a crease",
    "off_balance": "The forces do not balance",
    "adhesion_unsettled": "Adhesion did not settle",
    "grip_strain": "The soft grip is strained beyond its model",
    "grip_without_core": "The soft grip has no rigid core",
    "grip_rough": "The soft grip's surface is rough",
    "grip_unsolved": "The soft grip was not solved",
    "unsolved": "The contact was not solved",
    "unsolved_rows": "The contact was not solved at some vertices",
    "penetration": "Skin remains inside the product",
    "runaway": "The solution does not converge",
    "force_leaps": "The force jumps: the target is not reached",
}
"""Kinds of reasons, the library's and that of the shown surface, in words."""


def asks_for_finer_skin(kind: str, passes_between: bool) -> bool:
    """Whether finer skin may mend a result whose gravest reason is of this `kind`."""
    return kind in COARSE_SKIN or (kind == NO_CONTACT and passes_between)


def is_cut(shown_between_mm: float) -> bool:
    """Whether the shown skin cuts so deep into the product between its vertices that finer skin is offered."""
    return shown_between_mm > CUT_MM


def says_finer_skin(text: str) -> bool:
    """Whether a refusal's sentence asks for finer skin."""
    return any(words in text for words in _FINER)


def heading(kind: str) -> str:
    """A reason's kind in a few words, for those who read the sentence in another language; empty if unknown."""
    return _HEADINGS.get(kind, "")


def title(grade: str) -> str:
    """The grade as a label."""
    return grade.capitalize()


def judge(contact: Any, shown_mm: float, shown_vertex: int) -> Judgement:
    """The judgement on a native contact whose shown surface lies `shown_mm` inside (-1: not measured)."""
    if shown_mm > MOST_SHOWN_MM and contact.grade != DO_NOT:
        reason = (
            f"the skin as shown lies {shown_mm:.2f} mm inside the product, at vertex {shown_vertex}: a modifier behind "
            "the contact undoes it; move it before the Armature, or switch it off"
        )
        return Judgement(DO_NOT, reason, "shown_penetration", shown_vertex)
    if contact.grade == GOOD:
        return Judgement(GOOD)
    worst = next(remark for remark in contact.remarks if remark.grade == contact.grade)
    vertex = -1 if worst.vertex is None else worst.vertex
    return Judgement(contact.grade, worst.text, worst.kind, vertex)
