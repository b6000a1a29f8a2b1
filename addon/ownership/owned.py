"""Which shape keys and attributes of our names are Thenar's: a user's own are never overwritten and never removed.

Thenar's carry a mark in their mesh. Files of earlier versions have none: there pressure and its colours tell.
"""

from collections.abc import Iterable

from bpy.types import Attribute, Mesh, Object

from .. import names
from ..scene.checks import Refusal

KINDS = {
    names.REGION: "INT",
    names.DISPLACEMENT_MM: "FLOAT_VECTOR",
    names.LIVE_OFFSET: "FLOAT_VECTOR",
    names.SHOWN_OFFSET: "FLOAT_VECTOR",
    names.COLOR: "FLOAT_COLOR",
    names.MAP_COLOR: "FLOAT_COLOR",
}
"""Data types of Thenar's attributes, all of points; those that are not named are FLOAT."""
_SIGNATURE = (names.PRESSURE_KPA, names.COLOR)


def is_own(mesh: Mesh, name: str) -> bool:
    """Whether the mesh's attribute of that name is there and is Thenar's."""
    return _is_fit(mesh, name) and (is_marked(mesh, name) or has_signature(mesh))


def is_marked(mesh: Mesh, name: str) -> bool:
    """Whether Thenar made what has that name."""
    return name in mesh.thenar.owned.split("\n")


def has_signature(mesh: Mesh) -> bool:
    """Whether the mesh carries a contact: both attributes that every contact leaves, of the right kinds."""
    return all(_is_fit(mesh, name) for name in _SIGNATURE)


def mark(mesh: Mesh, name: str) -> None:
    """Remember that Thenar made what has that name."""
    if not is_marked(mesh, name):
        mesh.thenar.owned += f"{name}\n"


def unmark(mesh: Mesh, name: str) -> None:
    """Forget it: what gets that name later is somebody else's."""
    if is_marked(mesh, name):
        mesh.thenar.owned = "".join(f"{kept}\n" for kept in mesh.thenar.owned.split("\n") if kept not in ("", name))


def foreign(mesh: Mesh, attribute_names: Iterable[str]) -> Attribute | None:
    """The first attribute of these names that is not Thenar's, or None."""
    marked, is_signed = mesh.thenar.owned.split("\n"), has_signature(mesh)
    for name in attribute_names:
        attribute = mesh.attributes.get(name)
        if attribute is not None and not ((is_signed or name in marked) and _fits(attribute, name)):
            return attribute
    return None


def check_names(hand: Object) -> None:
    """Refuse a hand on which a result would replace the user's own data. Raises `Refusal`."""
    attribute = foreign(hand.data, (*names.HAND_ATTRIBUTES, names.LIVE_OFFSET))
    if attribute is not None:
        kind = f"{attribute.data_type} on {attribute.domain}".replace("_", " ").lower()
        raise Refusal(
            f"the attribute '{attribute.name}' ({kind}) of '{hand.name}' is not Thenar's, and a result needs the name; "
            "rename or remove it in Object Data > Attributes"
        )
    keys = hand.data.shape_keys
    if keys is not None and names.SHAPE_KEY in keys.key_blocks and not is_own_key(hand.data):
        raise Refusal(
            f"the shape key '{names.SHAPE_KEY}' of '{hand.name}' is not Thenar's, and a result needs that name; "
            "rename or remove it in Object Data > Shape Keys"
        )


def is_own_key(mesh: Mesh) -> bool:
    """Whether a shape key of the contact's name is Thenar's."""
    return is_marked(mesh, names.SHAPE_KEY) or has_signature(mesh)


def _is_fit(mesh: Mesh, name: str) -> bool:
    attribute = mesh.attributes.get(name)
    return attribute is not None and _fits(attribute, name)


def _fits(attribute: Attribute, name: str) -> bool:
    return bool(attribute.domain == "POINT" and attribute.data_type == KINDS.get(name, "FLOAT"))
