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


def asks_for_finer_skin(kind: str, passes_between: bool) -> bool:
    """Whether finer skin may mend a result whose gravest reason is of this `kind`."""
    return kind in COARSE_SKIN or (kind == NO_CONTACT and passes_between)


def is_cut(shown_between_mm: float) -> bool:
    """Whether the shown skin cuts so deep into the product between its vertices that finer skin is offered."""
    return shown_between_mm > CUT_MM


def says_finer_skin(text: str) -> bool:
    """Whether a refusal's sentence asks for finer skin."""
    return any(words in text for words in _FINER)


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
