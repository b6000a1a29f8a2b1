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
