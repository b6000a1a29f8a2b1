"""The effects that are switched on for a hand, from its properties to plain values. Knows nothing of buttons."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np
from bpy.types import Context, Object, PropertyGroup

from .scene import checks, regions
from .scene.units import Floats


@dataclass(frozen=True)
class UsedEffect:
    """One effect as the library wants it; `painted` is a field (n,) in its unit, NaN where nothing is painted."""

    name: str
    amplitude: float
    regions: tuple[int, ...] | None
    numbers: tuple[tuple[str, float | str], ...]
    painted: Floats | None

    def native(self, thenar: ModuleType) -> Any:
        """The library's effect."""
        numbers, places = dict(self.numbers), None if self.regions is None else list(self.regions)
        return thenar.Effect(self.name, self.amplitude, regions=places, painted=self.painted, **numbers)


def shown(hand: Object) -> Iterator[object]:
    """Values of every effect that is switched on, as the panel and the painted groups show them, for a digest."""
    for effect in hand.thenar.effects:
        if effect.is_on:
            yield (effect.name, _number(effect.amplitude), effect.region, _numbers(effect), effect.painted)
            if effect.painted in hand.vertex_groups:
                yield effect.painted_full
                yield regions.painted_weights(hand, effect.painted)


def read(context: Context, hand: Object, region_names: Sequence[str]) -> tuple[UsedEffect, ...]:
    """The effects that are switched on (tuple of `UsedEffect`). Raises `Refusal` for a region or group that is gone."""
    return tuple(_read(context, hand, effect, region_names) for effect in hand.thenar.effects if effect.is_on)


def hashed(used: Iterable[UsedEffect]) -> Iterator[object]:
    """What a result depends on of `used`, for `cache.content_hash`."""
    for effect in used:
        yield from (effect.name, effect.amplitude, effect.regions, effect.numbers)
        yield effect.painted if effect.painted is not None else ""


def _read(context: Context, hand: Object, effect: PropertyGroup, region_names: Sequence[str]) -> UsedEffect:
    places = None
    if effect.region:
        if effect.region not in region_names:
            raise checks.Refusal(
                f"effect '{effect.name}' acts on region '{effect.region}', which '{hand.name}' has no longer; "
                "choose another region, or none, under Effects"
            )
        places = (region_names.index(effect.region),)
    painted = None
    if effect.painted:
        if effect.painted not in hand.vertex_groups:
            raise checks.Refusal(
                f"effect '{effect.name}' is painted by vertex group '{effect.painted}', which '{hand.name}' has no "
                "longer; choose another group, or none, under Effects"
            )
        weights = regions.group_weights(context, hand, (effect.painted,))[0].astype(np.float64)
        painted = np.where(weights > regions.LEAST_WEIGHT, weights * effect.painted_full, np.nan)
    return UsedEffect(effect.name, _number(effect.amplitude), places, _numbers(effect), painted)


def _numbers(effect: PropertyGroup) -> tuple[tuple[str, float | str], ...]:
    numbers = [(number.name, _number(number.value)) for number in effect.numbers]
    return tuple(numbers + [(choice.name, choice.value) for choice in effect.choices])


def _number(value: float) -> float:
    """Six digits of Blender's single precision."""
    return float(f"{value:.6g}")
