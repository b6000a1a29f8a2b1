"""Blender properties of the effects that are switched on for a hand; what each effect is stands in the library."""

from collections.abc import Iterable

import bpy
from bpy.props import BoolProperty, CollectionProperty, EnumProperty, FloatProperty, StringProperty

from .. import languages, names, native

_OVER_TIME = "history"
"""The catalogue's stage of effects that need time, and so a bake; the others act in a single press."""
_BONDS_OF_TOUCH = ("bonds", "touched")
"""The choice of adhesion with which a contact depends on what was touched before."""
_LAYER = ("curve", "layer")
OF_A_CHOICE = {("drainage", "spread"): _LAYER, ("drainage", "radius_mm"): _LAYER}
"""By effect and number: numbers that count with one choice alone, and that choice."""
_OF_THE_SKIN = ("geometry", "stiffening", _OVER_TIME, "interface")
"""Stages that act on the skin; instruments act on readings, and have no place on a hand."""
_STARTS = {"relaxation": 0.35, "cycle_softening": 0.3, "rate_independent_loss": 0.5}
"""Amplitudes to start from where the most is out of reason. Relaxation: palms, Shojaeizadeh 2022; the others: ours."""

_UNITS = (
    *("_mm2_per_s", "_n_per_mm", "_mm_per_n", "_j_per_m2", "_kpa_per_min", "_n_per_min"),
    *("_mpa", "_kpa", "_rad", "_mm", "_n", "_s"),
)
"""Ends of the library's names that tell a unit, longest first."""
_LAWS = {}
"""Items of choices by their options: Blender needs the texts of a dynamic list kept."""


def offered():
    """Catalogue rows of the skin's effects by name, in the order in which they compose."""
    return {row["name"]: row for row in native.effects() if row["stage"] in _OF_THE_SKIN}


def meaning(name):
    """What an effect of the catalogue is, in a few words; empty for what it does not list."""
    return next((row["meaning"] for row in native.effects() if row["name"] == name), "")


def acts_over_time(name: str, numbers: Iterable[tuple[str, float | str]] = ()) -> bool:
    """Whether the effect needs time: a press of one frame knows nothing of it, a bake follows it.

    `numbers` are pairs of name and value, with the choices, of which one may need time (bonds that touch made).
    """
    return offered().get(name, {}).get("stage") == _OVER_TIME or _BONDS_OF_TOUCH in numbers


def chosen(effect: bpy.types.PropertyGroup) -> list[tuple[str, str]]:
    """Pairs of name and value of an effect's choices."""
    return [(choice.name, choice.value) for choice in effect.choices]


def shown_numbers(effect: bpy.types.PropertyGroup) -> list[bpy.types.PropertyGroup]:
    """The effect's numbers that count with what is chosen."""
    made = chosen(effect)
    return [number for number in effect.numbers if OF_A_CHOICE.get((effect.name, number.name)) in (None, *made)]


def bring_up_to_date(hand: bpy.types.Object) -> None:
    """Give effects of an older version the choices (first option: what was done) and numbers that have come since."""
    for effect in hand.thenar.effects:
        row = offered().get(effect.name, {})
        for choice in row.get("choices", ()):
            if choice["name"] not in effect.choices:
                _add_choice(effect, choice)
        for shape in row.get("shape", ()):
            if shape["name"] not in effect.numbers:
                _add_number(effect, shape)


def can_be_painted(name):
    """Whether a vertex group can stand for the effect's field."""
    return bool(offered().get(name, {}).get("painted"))


def needs_history(hand):
    """Whether a bake of the hand follows its history: friction, or an effect that acts over time, is switched on."""
    acting = [effect for effect in hand.thenar.effects if effect.is_on and effect.amplitude > 0.0]
    return any(each.name == names.FRICTION or acts_over_time(each.name, chosen(each)) for each in acting)


def is_on(hand, name):
    """Whether the effect is switched on anywhere on the hand."""
    return any(effect.is_on and effect.name == name for effect in hand.thenar.effects)


def title(name: str) -> str:
    """An effect's or number's name for reading, without the unit that stands beside it."""
    unit = next((suffix for suffix in _UNITS if name.endswith(suffix)), "")
    return name.removesuffix(unit).replace("_", " ").capitalize()


def _options(self, _context):
    return _LAWS.setdefault(self.options, [(word, title(word), "") for word in self.options.split()])


class ThenarEffectNumber(bpy.types.PropertyGroup):
    """One shape number of an effect; `name` is the library's."""

    value: FloatProperty(name="Value", description="Parameter of the effect, in the unit shown", precision=3)
    unit: StringProperty()


class ThenarEffectChoice(bpy.types.PropertyGroup):
    """One choice of an effect among `options` (words with blanks between); `name` is the library's."""

    options: StringProperty()
    value: EnumProperty(
        name="Choice",
        description="Which law the effect follows",
        items=_options,
        translation_context=languages.LAW,
    )


class ThenarEffect(bpy.types.PropertyGroup):
    """An effect of the catalogue, switched on for all skin or for one region; `name` is the library's."""

    is_on: BoolProperty(name="On", description="Switch the effect on; off is the base model, bit for bit", default=True)
    amplitude: FloatProperty(
        name="Amplitude", description="Strength of the effect; 0 is the base model", min=0.0, max=1.0, default=1.0
    )
    region: StringProperty(name="Region", description="Region the effect acts on; empty: all of the skin")
    numbers: CollectionProperty(type=ThenarEffectNumber)
    choices: CollectionProperty(type=ThenarEffectChoice)
    painted: StringProperty(
        name="Painted",
        description="Vertex group that paints the effect's field; skin of weight 0 takes the number above",
    )
    painted_full: FloatProperty(
        name="At Weight 1 (mm)", description="Value at weight 1 of the painted group", min=0.0, default=10
    )


def fill(effect, row):
    """Set an effect to a row of the catalogue, with its default numbers."""
    effect.name, effect.amplitude = row["name"], _STARTS.get(row["name"], row["most"])
    for shape in row["shape"]:
        _add_number(effect, shape)
    for choice in row["choices"]:
        _add_choice(effect, choice)


def _add_number(effect, shape):
    number = effect.numbers.add()
    number.name, number.value, number.unit = shape["name"], shape["default"], shape["unit"]


def _add_choice(effect, choice):
    made = effect.choices.add()
    made.name, made.options = choice["name"], " ".join(choice["options"])
    made.value = choice["options"][0]


CLASSES = (ThenarEffectNumber, ThenarEffectChoice, ThenarEffect)
