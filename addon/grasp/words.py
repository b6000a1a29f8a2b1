"""What is said of a grasp: whether the product would stay in the hand. Knows nothing of Blender but its language."""

import math

from ..languages import report
from . import settling

ALMOST = 0.005
"""Friction below this is none: a product is held by the normal forces alone."""


SHORT = 0.9
"""A sum of forces below this share of what was asked for is said."""


def held(state, friction, asked_n=None):
    """Report level and sentence for a `settling.State`: `friction` that it needs and that is there; what was asked."""
    needed, available = friction
    net = math.sqrt(sum(part * part for part in state.net_n))
    is_short = asked_n is not None and state.total_n < SHORT * asked_n
    words = "{total:.0f} of {asked:.0f} N of grip, {net:.1f} N left over"
    words = words if is_short else "{total:.0f} N of grip, {net:.1f} N left over"
    forces = report(words, total=state.total_n, asked=asked_n, net=net)
    level, words = _verdict(state, needed, available)
    return level, report(words, forces=forces, needed=needed, available=available)


def _verdict(state, needed, available):
    """Report level and template for the friction that is needed and that is there."""
    if state.imbalance <= settling.BALANCED and needed <= available:
        if needed < ALMOST:
            return "INFO", "In balance: {forces}"
        return "INFO", "In balance: {forces}, held by a friction of {needed:.2f}"
    if needed <= available:
        return "INFO", "Held by friction: {forces}, a coefficient of {needed:.2f} holds it"
    if math.isinf(needed):
        return "WARNING", "No balance: {forces}, which no friction holds; move the hand to the middle of the product"
    return (
        "WARNING",
        "No balance: {forces}; it needs a friction of {needed:.2f} where {available:.2f} is there: the product would "
        "slip out. Ask for more grip, or hold it nearer to its middle",
    )
