"""What is said of a grasp: whether the product would stay in the hand. Knows nothing of Blender."""

import math

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
    grip = f"{state.total_n:.0f} of {asked_n:.0f} N of grip" if is_short else f"{state.total_n:.0f} N of grip"
    text = f"{grip}, {net:.1f} N left over"
    if state.imbalance <= settling.BALANCED and needed <= available:
        return "INFO", f"In balance: {text}" + ("" if needed < ALMOST else f", held by a friction of {needed:.2f}")
    if needed <= available:
        return "INFO", f"Held by friction: {text}, a coefficient of {needed:.2f} holds it"
    if math.isinf(needed):
        return "WARNING", f"No balance: {text}, which no friction holds; move the hand to the middle of the product"
    return (
        "WARNING",
        f"No balance: {text}; it needs a friction of {needed:.2f} where {available:.2f} is there: the product would "
        "slip out. Ask for more grip, or hold it nearer to its middle",
    )
