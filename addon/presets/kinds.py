"""What each kind of preset holds of a scene, how a file of it is checked, and how it is put onto the scene."""

from ..product_objects.parts import product_parts
from ..properties import effect_settings, material_settings
from ..scene.checks import Refusal
from ..soft_grip import settings as grip_settings
from . import fields
from .fields import Place

SKIN, GRIP, LOOK, EFFECTS = "SKIN_MATERIAL", "SOFT_GRIP", "MAP_LOOK", "EFFECTS"
ITEMS = (
    (SKIN, "Skin Material", "Material of one region, or of all regions by name", 0),
    (GRIP, "Soft Grip", "What covers the product", 1),
    (LOOK, "Map Look", "Colors, contour, legend and ranges of the maps", 2),
    (EFFECTS, "Effects", "The list of effects with their numbers", 3),
)

_NUMBERS = {prop: prop for prop, _ in material_settings.MATERIAL_NUMBERS.values()}
_MATERIAL = {"based_on": "preset", **_NUMBERS}
_GRIP = {
    "material": "material",
    "thickness_mm": "thickness_mm",
    "hardness_shore_a": "hardness",
    "youngs_modulus_mpa": "youngs_mpa",
    "poisson_ratio": "poisson_ratio",
}
_SCENE = {"colors": "palette", "pressure_range_kpa": "range_kpa", "shows_legend": "show_legend"}
_MAPS = {
    "draws_contour": "contour",
    "shear_range_kpa": "shear_kpa",
    "depth_range_mm": "depth_mm",
    "reference_difference_range_kpa": "reference_difference_kpa",
    "residual_range_kpa": "residual_kpa",
    "thickness_range_mm": "thickness_mm",
}
_EFFECT = {"is_on": "is_on", "amplitude": "amplitude", "painted_full_mm": "painted_full"}
_HEAD = {"format", "version", "kind"}


def content_of(context, kind, wish):
    """What a preset of `kind` holds of the scene; `wish.part` and `wish.all_regions` choose. Raises `Refusal`."""
    settings = context.scene.thenar
    if kind == GRIP:
        return {"grip": fields.read(_parts(settings, wish.part)[0].thenar.grip, _GRIP)}
    if kind == LOOK:
        return {"look": fields.read(settings, _SCENE) | fields.read(settings.maps, _MAPS)}
    state = _hand(settings).thenar
    if kind == EFFECTS:
        if not state.effects:
            raise Refusal("no effect is listed; add one under Effects before it is saved")
        return {"effects": [_effect(effect) for effect in state.effects]}
    if wish.all_regions:
        if not state.materials:
            raise Refusal("no region is listed; press Regions from Bones, or save the one material")
        return {"regions": {row.name: fields.read(row, _MATERIAL) for row in state.materials}}
    return {"material": fields.read(_selected(state), _MATERIAL)}


def check(context, content, file):
    """`(kind, values)` of the content of the file named `file`, all checked. Raises `Refusal` with the place."""
    place = Place(file)
    kind = fields.choice(content.get("kind"), [item[0].lower() for item in ITEMS], place.at("kind")).upper()
    own = {SKIN: ("material", "regions"), GRIP: ("grip",), LOOK: ("look",), EFFECTS: ("effects",)}[kind]
    there = [key for key in content if key not in _HEAD]
    if len(there) != 1 or there[0] not in own:
        wrong = next((key for key in there if key not in own), own[0])
        place.at(wrong).refuse("a preset of this kind holds " + " or ".join(own) + " alone", "save the preset again")
    part = there[0]
    return kind, {part: _CHECKS[part](context, content[part], place.at(part))}


def put(context, kind, values, wish):
    """Put checked values onto the scene. Returns a remark or "". Raises `Refusal` with the scene as before."""
    settings = context.scene.thenar
    if kind == GRIP:
        for part in _parts(settings, wish.part):
            _set(part.thenar.grip, values["grip"])
    elif kind == LOOK:
        for prop, value in values["look"].items():
            setattr(settings if prop in _SCENE.values() else settings.maps, prop, value)
    elif kind == EFFECTS:
        return _put_effects(_hand(settings), values["effects"])
    elif "material" in values:
        state = _hand(settings).thenar
        spread = wish.all_regions and state.materials
        for row in state.materials if spread else [_selected(state)]:
            _put_material(row, values["material"], keeps_anatomy=bool(spread))
    else:
        return _put_regions(_hand(settings), values["regions"])
    return ""


def _hand(settings):
    if settings.hand is None or settings.hand.type != "MESH":
        raise Refusal("choose the hand's mesh under Hand first")
    return settings.hand


def _parts(settings, name):
    """The product's parts, or the one of that name."""
    parts = [part for part in product_parts(settings) if name in ("", part.name)]
    if not parts:
        raise Refusal(f"the product has no part '{name}'" if name else "choose the product under Product first")
    return parts


def _selected(state):
    if not state.materials:
        return state.default_material
    return state.materials[min(state.material_index, len(state.materials) - 1)]


def _set(owner, values):
    for prop, value in values.items():
        setattr(owner, prop, value)


def _put_material(row, values, keeps_anatomy=False):
    """Preset first, then the numbers that differ from it, which make it a material of one's own."""
    kept = {prop: getattr(row, prop) for prop in material_settings.ANATOMY}
    row.preset = values["preset"]
    numbers = {prop: value for prop, value in values.items() if prop != "preset"}
    for prop, value in (numbers | (kept if keeps_anatomy else {})).items():
        if abs(getattr(row, prop) - value) > 1e-5 * max(abs(value), 1e-6):
            setattr(row, prop, value)


def _put_regions(hand, regions):
    """Materials by the names of regions; says which are on one side only."""
    rows = {row.name: row for row in hand.thenar.materials}
    common = [name for name in regions if name in rows]
    if not common:
        raise Refusal(
            f"no region of the preset is on '{hand.name}', which lists {len(rows)}; press Regions from Bones, or save "
            "and choose a material of one region"
        )
    for name in common:
        _put_material(rows[name], regions[name])
    left = [name for name in (*rows, *regions) if name not in common]
    return f"{len(common)} regions set; not in both: {', '.join(left)}" if left else ""


def _effect(effect):
    return {
        "name": effect.name,
        **fields.read(effect, _EFFECT),
        "region": effect.region,
        "numbers": {number.name: float(f"{number.value:.6g}") for number in effect.numbers},
        "choices": {choice.name: choice.value for choice in effect.choices},
    }


def _put_effects(hand, effects):
    """The list of effects, in place of the one that is there."""
    state, dropped = hand.thenar, []
    known = {row.name for row in state.materials}
    state.effects.clear()
    for values in effects:
        effect = state.effects.add()
        effect_settings.fill(effect, effect_settings.offered()[values["name"]])
        _set(effect, values["set"])
        effect.region = values["region"] if values["region"] in known else ""
        effect.is_on = effect.is_on and effect.region == values["region"]
        dropped += [] if effect.region == values["region"] else [values["region"]]
        for number in effect.numbers:
            number.value = values["numbers"][number.name]
        for choice in effect.choices:
            choice.value = values["choices"][choice.name]
    state.effect_index = 0
    if not dropped:
        return ""
    return f"effects of regions that the hand has not are switched off: {', '.join(dropped)}"


def _check_material(_context, content, place):
    return fields.check(content, material_settings.ThenarMaterial, _MATERIAL, place)


def _check_effects(_context, content, place):
    if not isinstance(content, list) or not content:
        place.refuse("is no list of effects", "save the preset again")
    return [_check_effect(row, place.at(index)) for index, row in enumerate(content)]


def _check_effect(content, place):
    row = dict(fields.mapping(content, place))
    offered = effect_settings.offered()
    name = fields.choice(row.pop("name", None), list(offered), place.at("name"))
    region, numbers, choices = row.pop("region", ""), row.pop("numbers", None), row.pop("choices", None)
    if not isinstance(region, str):
        place.at("region").refuse("is no name of a region", 'write a name, or "" for all of the skin')
    shapes = {shape["name"]: shape for shape in offered[name]["shape"]}
    options = {option["name"]: option["options"] for option in offered[name]["choices"]}
    if isinstance(numbers, dict):  # an older preset lacks numbers and choices that have come since
        late = [key for key in shapes if (name, key) in effect_settings.OF_A_CHOICE]
        numbers = {key: shapes[key]["default"] for key in late} | numbers
    found = _same_keys(numbers, shapes, place.at("numbers"))
    if isinstance(choices, dict):
        choices = {key: words[0] for key, words in options.items()} | choices
    chosen = _same_keys(choices, options, place.at("choices"))
    checked = fields.check(row, effect_settings.ThenarEffect, _EFFECT, place)
    fields.number(checked["amplitude"], 0.0, offered[name]["most"], place.at("amplitude"))
    return {
        "name": name,
        "region": region,
        "set": checked,
        "numbers": {
            key: fields.number(found[key], shape["low"], shape["high"], place.at("numbers").at(key))
            for key, shape in shapes.items()
        },
        "choices": {key: fields.choice(chosen[key], list(words), place.at(key)) for key, words in options.items()},
    }


def _same_keys(content, known, place):
    """`content` if it has the keys of `known`; else a `Refusal`."""
    group = fields.mapping(content, place)
    for key in (*group, *known):
        if key not in known:
            place.at(key).refuse("is not known here", f"known are {', '.join(known) or 'none'}")
        if key not in group:
            place.at(key).refuse("is missing", "add it, or save the preset again")
    return group


def _check_regions(context, content, place):
    group = fields.mapping(content, place)
    if not group:
        place.refuse("holds no region", "save the preset again")
    return {name: _check_material(context, row, place.at(name)) for name, row in group.items()}


def _check_grip(_context, content, place):
    return fields.check(content, grip_settings.ThenarGrip, _GRIP, place)


def _check_look(context, content, place):
    settings = context.scene.thenar
    group = fields.mapping(content, place)
    maps = {key: value for key, value in group.items() if key in _MAPS}
    rest = {key: value for key, value in group.items() if key not in _MAPS}
    return fields.check(rest, settings, _SCENE, place) | fields.check(maps, settings.maps, _MAPS, place)


_CHECKS = {
    "material": _check_material,
    "regions": _check_regions,
    "grip": _check_grip,
    "look": _check_look,
    "effects": _check_effects,
}
