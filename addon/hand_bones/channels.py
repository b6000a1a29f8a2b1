"""Location, rotation and scale of an object or a pose bone, kept and given back to the bit."""

from typing import Any

NAMES = ("location", "rotation_euler", "rotation_quaternion", "rotation_axis_angle", "scale")
"""A matrix would be split into them again, and rounded."""


def kept(thing: Any) -> dict[str, list[float]]:
    """The values by name, as plain numbers."""
    return {name: list(getattr(thing, name)) for name in NAMES}


def restore(thing: Any, values: dict[str, list[float]]) -> None:
    """Give them back."""
    for name, value in values.items():
        setattr(thing, name, value)
