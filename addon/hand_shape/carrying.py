"""What the user added to a made hand, taken off as arrays and put on a hand of another size or side."""

import hashlib
from dataclasses import dataclass, field

import numpy as np

from .. import names
from ..hand_look import look
from ..scene import key as shape_key
from ..scene.checks import Refusal
from . import built as built_of
from . import matching, weights

SCULPTED_MM = 1e-3
"""Vertices nearer to where they were made were not moved: single precision in metres rounds to 1e-5 mm."""
_FIELDS = {
    "FLOAT": ("value", 1, np.float32),
    "INT": ("value", 1, np.int32),
    "INT8": ("value", 1, np.int8),
    "BOOLEAN": ("value", 1, bool),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),
}
_DOMAINS = {"POINT", "FACE", "CORNER"}
_OWN = {look.REST, look.TONE, look.FINGER, look.NAIL, look.LINES, look.LINES_FADE, "position"}
_KEPT_HIDDEN = {".sculpt_mask", ".sculpt_face_set"}
"""Of the attributes whose names begin with a dot; the others hold selections and what Blender derives."""


@dataclass
class Carried:
    """The user's work on the hand `built`, lengths in mm; `rest_mm` (n, 3) and `triangles` (m, 3) as it was made.

    `sculpted_mm` (n, 3): from there to the present rest; `keys`: name -> offsets (n, 3) from the rest; `groups`: name
    -> weights (n,); `attributes`: (name, type, domain) -> values.
    """

    built: built_of.Built
    rest_mm: np.ndarray
    triangles: np.ndarray
    sculpted_mm: np.ndarray | None = None
    keys: dict = field(default_factory=dict)
    groups: dict = field(default_factory=dict)
    attributes: dict = field(default_factory=dict)

    def is_empty(self):
        """Whether the user added nothing."""
        return self.sculpted_mm is None and not (self.keys or self.groups or self.attributes)

    def digest(self):
        """What tells this work from other work."""
        out = hashlib.blake2b(self.built.as_text().encode(), digest_size=16)
        for part in (self.keys, self.groups, self.attributes):
            for name, values in part.items():
                out.update(repr(name).encode() + values.tobytes())
        out.update(b"" if self.sculpted_mm is None else self.sculpted_mm.tobytes())
        return out.hexdigest()


def check(hand):
    """Refuse attributes that no other mesh can take over. Raises `Refusal`."""
    for attribute in _own_attributes(hand.data):
        if attribute.domain in _DOMAINS and attribute.data_type in _FIELDS:
            continue
        if attribute.domain == "EDGE" and attribute.data_type == "BOOLEAN" and not _values(attribute).any():
            continue
        kind = f"{attribute.data_type} on {attribute.domain}".replace("_", " ").lower()
        raise Refusal(
            f"the attribute '{attribute.name}' ({kind}) of '{hand.name}' cannot go to a hand of another shape; "
            "clear or remove it first (seams, sharp edges and creases are such attributes)"
        )


def take(hand, built, kinds):
    """The user's work on `hand`, made as `built`; `kinds`: kind -> names of the groups that it was made with."""
    mesh = hand.data
    rest = _values(mesh.attributes[look.REST]).astype(np.float64)
    triangles = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", triangles)
    out = Carried(built, rest, triangles.reshape(-1, 3))
    base = _base(mesh) * built.mm_per_unit
    if np.abs(base - rest).max() > SCULPTED_MM:
        out.sculpted_mm = base - rest
    if mesh.shape_keys is not None:
        for block in mesh.shape_keys.key_blocks:
            if block != mesh.shape_keys.reference_key:
                out.keys[block.name] = shape_key.key_points(block) * built.mm_per_unit - base
    groups = weights.read(hand)
    made = [kind for kind, digest in weights.digests(groups, kinds).items() if digest == built.weights.get(kind)]
    fresh = {name for kind in made for name in kinds[kind]}
    out.groups = {name: values for name, values in groups.items() if name not in fresh}
    for attribute in _own_attributes(mesh):
        values = _values(attribute) if attribute.data_type in _FIELDS else np.zeros(0)
        if values.any():
            out.attributes[attribute.name, attribute.data_type, attribute.domain] = values
    return out


def moved(carried, built, surface, bone_weights):
    """The same work on the hand `built`; `surface`: its (rest mm, triangles), `bone_weights` (n, b) of its bones.

    Values go to the place that corresponds by bone; lengths grow with the hand, and turn over with its side.
    """
    old, new = built_of.frames_mm(carried.built), built_of.frames_mm(built)
    place = matching.between(old, new, bone_weights)
    match = matching.Match((carried.rest_mm, carried.triangles), surface, place)

    def at_points(values):
        faces, shares = match.vertices
        return _mixed(values[carried.triangles[faces]], shares)

    ratio = matching.across(new) / matching.across(old)
    growth = np.array([ratio, abs(ratio), abs(ratio)])
    out = Carried(built, *surface)
    if carried.sculpted_mm is not None:
        out.sculpted_mm = at_points(carried.sculpted_mm) * growth
    out.keys = {name: at_points(offsets) * growth for name, offsets in carried.keys.items()}
    out.groups = {name: at_points(values) for name, values in carried.groups.items()}
    of_domain = {
        "POINT": at_points,
        "FACE": lambda values: values[match.faces[0]],
        "CORNER": lambda values: _at_corners(values, *match.faces),
    }
    out.attributes = {name: of_domain[name[2]](values) for name, values in carried.attributes.items()}
    return out


def put(hand, carried):
    """Write sculpting, shape keys and attributes to `hand`, whose geometry is that of `carried`; not the groups."""
    mesh, unit = hand.data, 1.0 / carried.built.mm_per_unit
    base = carried.rest_mm * unit
    if carried.sculpted_mm is not None:
        base = base + carried.sculpted_mm * unit
        mesh.vertices.foreach_set("co", base.astype(np.float32).ravel())
    if mesh.shape_keys is not None:
        for block in mesh.shape_keys.key_blocks:
            shape_key.put_points(hand, block, base + carried.keys.get(block.name, 0.0) * unit)
    for (name, kind, domain), values in carried.attributes.items():
        attribute = mesh.attributes.get(name) or mesh.attributes.new(name, kind, domain)
        attribute.data.foreach_set(_FIELDS[kind][0], np.ascontiguousarray(values).ravel())
    mesh.update()


def _own_attributes(mesh):
    """The user's attributes: neither Thenar's nor those that Blender derives."""
    for attribute in mesh.attributes:
        hidden = attribute.name.startswith(".") and attribute.name not in _KEPT_HIDDEN
        if not hidden and attribute.name not in _OWN and attribute.name not in names.HAND_ATTRIBUTES:
            yield attribute


def _values(attribute):
    field_name, width, kind = _FIELDS[attribute.data_type]
    out = np.empty(width * len(attribute.data), kind)
    attribute.data.foreach_get(field_name, out)
    return out.reshape(-1, width) if width > 1 else out


def _base(mesh):
    """The present rest (n, 3), Blender units."""
    if mesh.shape_keys is not None:
        return shape_key.key_points(mesh.shape_keys.reference_key)
    out = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", out)
    return out.reshape(-1, 3).astype(np.float64)


def _mixed(values, shares):
    """Values of three corners (..., 3) or (..., 3, w) mixed by `shares` (..., 3); of whole numbers the largest's."""
    if values.dtype.kind not in "f":
        return np.take_along_axis(values, shares.argmax(axis=-1)[..., None], axis=-1)[..., 0]
    parts = shares if values.ndim == shares.ndim else shares[..., None]
    return (values * parts).sum(axis=shares.ndim - 1).astype(values.dtype)


def _at_corners(values, faces, shares):
    """Values of face corners (3 k, ...) at new corners, whose old triangles and shares `Match.faces` gives."""
    old = values.reshape(len(values) // 3, 3, *values.shape[1:])[faces]
    parts = [_mixed(old, shares[:, corner]) for corner in range(3)]
    return np.stack(parts, axis=1).reshape(-1, *values.shape[1:])
