"""Writes a contact onto hand and product, all of it or nothing."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass

import bpy
import numpy as np
from bpy.types import Context, Mesh, Object, PropertyGroup

from .. import names
from ..ownership import own
from ..product_objects import copies, moving
from ..skin_display import colors, refine, shown
from ..skin_display.shown import Shown
from ..steps import PAUSE, Steps
from . import attributes, correction, key, read, units
from .units import Floats, Ints

NO_BONE_MM = 1000.0
"""What stands for tissue without bone in the thickness attribute: the thickest that the library admits."""
MOST_NAMED = 3
"""Parts that a sentence names; a product may have thousands."""


@dataclass(frozen=True)
class Fields:
    """What a contact writes; arrays per hand vertex (n) or product vertex (k), world axes, library units."""

    displacement_mm: Floats
    pressure_mpa: Floats
    force_n: Floats
    depth_mm: Floats
    overlap_mm: Floats
    """Signed: negative where product and skin are apart."""
    regions: Ints
    product_pressure_mpa: Floats
    offset_mm: Floats
    """(3) how far the product moved to reach its force."""
    edge_mm: Floats | None = None
    product_edge_mm: Floats | None = None
    """Signed distances to the edge of the contact, positive inside; None where nobody looks at a map."""
    shear: tuple[Floats, Floats] | None = None
    """Shear traction (n), MPa, and slip margin (n), 0 where skin slips to 1, where the product was dragged."""
    grip_displacement_mm: Floats | None = None
    """(k, 3), where a soft grip covers the product."""
    thickness_mm: Floats | None = None
    """(n), soft tissue over bone; infinite where there is no bone, NaN away from the skin."""


@dataclass(frozen=True)
class WriteReport:
    """Largest error of the written displacement, mm, measured; corrections it took; notes for the user.

    `shown` is the certificate of the shown surface (`shown.Shown`), where one was asked for.
    """

    error_mm: float
    corrections: int
    notes: tuple[str, ...]
    shown: Shown | None = None


def write_contact(
    context: Context, hand: Object, parts: Sequence[Object], job: tuple[read.Reading, Fields], measure: shown.Measure
) -> Steps[WriteReport]:
    """Shape key, attributes and the product's place, as steps that return a `WriteReport`.

    `job`: what was read and the `Fields`; `measure(surface, left_mm)`: work that gives a `certificate.Found`.
    On any failure, and where the steps are closed, the scene is as before.
    """
    reading, fields = job
    skin, look = reading.hand, context.scene.thenar
    with ExitStack() as undo:
        undo.callback(context.view_layer.update)
        _keep_key(undo, hand)
        undo.callback(attributes.snapshot(hand.data, (*names.HAND_ATTRIBUTES, names.SHOWN_OFFSET, names.SHOWN_SKIN)))
        _hide_correction(undo, hand)
        moving.move_parts(context, undo, parts, fields.offset_mm / skin.scale)
        contact = key.ensure_key(hand)
        wanted = units.vectors_to_local(fields.displacement_mm, skin.matrix, skin.scale)
        with own.without_types(hand, shown.ADDING):
            report = yield from key.fit_steps(context, hand, contact, wanted)
        write_hand(hand, fields, look)
        shown.mark_skin(hand, fields.regions)
        yield PAUSE
        for record in reading.product.parts:
            _write_part(context, undo, record, reading, fields)
            yield PAUSE
        seen = yield from shown.certify(context, hand, reading, fields.displacement_mm, (measure, undo))
        if seen.moved:
            correction.tidy()
        else:
            correction.remove(hand)
        context.view_layer.update()
        notes = (*_notes(reading.product), *shown.notes(hand, seen, skin.origin_mm))
        undo.pop_all()
    return WriteReport(seen.error_mm, report.corrections, notes, seen)


def _hide_correction(undo: ExitStack, hand: Object) -> None:
    """Switch off what an earlier contact hung behind the key."""
    for modifier in own.shown_modifiers(hand):
        if modifier.show_viewport:
            undo.callback(setattr, modifier, "show_viewport", True)
            modifier.show_viewport = False


def write_hand(hand: Object, fields: Fields, look: PropertyGroup) -> None:
    """The hand's attributes and its colours for Solid view."""
    mesh, pressure = hand.data, units.kpa(fields.pressure_mpa)
    attributes.remove(mesh, (*names.RESIDUAL_ATTRIBUTES, *names.REFERENCE_ATTRIBUTES))  # of the contact before
    attributes.write(mesh, names.PRESSURE_KPA, "FLOAT", pressure)
    write_edge(mesh, fields.edge_mm)
    attributes.write(mesh, names.DEPTH_MM, "FLOAT", fields.depth_mm)
    attributes.write(mesh, names.OVERLAP_MM, "FLOAT", fields.overlap_mm)
    attributes.write(mesh, names.REGION, "INT", fields.regions)
    attributes.write(mesh, names.FORCE_N, "FLOAT", fields.force_n)
    attributes.write(mesh, names.DISPLACEMENT_MM, "FLOAT_VECTOR", fields.displacement_mm)
    if fields.shear is None:
        attributes.remove(mesh, (names.SHEAR_KPA, names.SLIP_MARGIN))
    else:
        attributes.write(mesh, names.SHEAR_KPA, "FLOAT", units.kpa(fields.shear[0]))
        attributes.write(mesh, names.SLIP_MARGIN, "FLOAT", fields.shear[1])
    if fields.thickness_mm is not None:
        write_thickness(mesh, fields.thickness_mm)
    under = colors.ground(hand, colors.SKIN)
    # Of what the mesh holds, in single precision: colors that are laid again from it are then the same ones.
    held = pressure.astype(np.float32), None if fields.edge_mm is None else fields.edge_mm.astype(np.float32)
    attributes.write(mesh, names.COLOR, "FLOAT_COLOR", colors.linear(held, look, under))
    mesh.update()


def write_edge(mesh: Mesh, edge_mm: Floats | None) -> None:
    """Signed distances to the edge of the contact (n,), mm; None takes those of an earlier contact away."""
    if edge_mm is None:
        attributes.remove(mesh, [names.EDGE_MM])
    else:
        attributes.write(mesh, names.EDGE_MM, "FLOAT", edge_mm)


def write_reference(hand: Object, pressure_kpa: Floats, edge_mm: Floats) -> None:
    """Pressure of the reference solve (n), how much more it is than the fast result's, and its edge. All or nothing."""
    fast = attributes.read(hand.data, names.PRESSURE_KPA)
    restore = attributes.snapshot(hand.data, names.REFERENCE_ATTRIBUTES)
    try:
        attributes.write(hand.data, names.REFERENCE_KPA, "FLOAT", pressure_kpa)
        more = pressure_kpa - (0.0 if fast is None else fast)
        attributes.write(hand.data, names.REFERENCE_DIFFERENCE_KPA, "FLOAT", more)
        attributes.write(hand.data, names.REFERENCE_EDGE_MM, "FLOAT", edge_mm)
    except BaseException:
        restore()
        raise
    hand.data.update()


def write_thickness(mesh: Mesh, thickness_mm: Floats) -> None:
    """Soft tissue over bone (n), mm, as an attribute: 0 away from the skin, `NO_BONE_MM` where there is no bone."""
    values = np.nan_to_num(thickness_mm, nan=0.0, posinf=NO_BONE_MM)
    attributes.write(mesh, names.THICKNESS_MM, "FLOAT", np.minimum(values, NO_BONE_MM))


def _keep_key(undo: ExitStack, hand: Object) -> None:
    contact = own.contact_key(hand)
    if contact is None:
        hand.thenar.made_basis = hand.data.shape_keys is None
        undo.callback(key.remove_key, hand)
        return
    points, value, mute = key.key_points(contact), contact.value, contact.mute

    def restore() -> None:
        contact.value, contact.mute = value, mute
        key.put_points(hand, contact, points)

    undo.callback(restore)


def _write_part(context: Context, undo: ExitStack, record: read.Part, reading: read.Reading, fields: Fields) -> None:
    part, look = bpy.data.objects[record.name], context.scene.thenar
    mine = slice(record.first, record.first + record.count)
    pressure, yielded = fields.product_pressure_mpa[mine], _yielded(fields, mine)
    edge = None if fields.product_edge_mm is None else fields.product_edge_mm[mine]
    if record.reason or record.refinement is not None or yielded is not None:
        copies.write_copy(context, record, reading, fields.offset_mm, (pressure, edge, yielded))
        undo.callback(copies.remove_copy, record.name)
    else:
        copies.remove_copy(record.name)
    if record.reason:
        return
    if record.refinement is not None:
        pressure = refine.gathered(pressure, record.refinement)
    undo.callback(attributes.snapshot(part.data, names.PRODUCT_ATTRIBUTES))
    attributes.remove(part.data, names.RESIDUAL_ATTRIBUTES)
    count = len(part.data.vertices)
    carried, edge = units.kpa(pressure[:count]), None if edge is None else edge[:count]
    attributes.write(part.data, names.PRESSURE_KPA, "FLOAT", carried)
    write_edge(part.data, edge)
    under = colors.ground(part, colors.BARE)
    attributes.write(part.data, names.COLOR, "FLOAT_COLOR", colors.linear((carried, edge), look, under))
    part.data.update()


def _yielded(fields: Fields, mine: slice) -> Floats | None:
    """Displacement of a part's vertices, or None where the part is rigid."""
    if fields.grip_displacement_mm is None or not fields.grip_displacement_mm[mine].any():
        return None
    return fields.grip_displacement_mm[mine]


def _notes(product: read.ProductReading) -> Iterator[str]:
    """What stands in for parts of the product; one sentence a reason, however many parts there are."""
    copied: dict[str, list[str]] = {}
    finer = [record.name for record in product.parts if not record.reason and record.refinement is not None]
    for record in product.parts:
        if record.reason:
            copied.setdefault(record.reason, []).append(record.name)
    for reason, parts in copied.items():
        yield f"a copy of {_listed(parts)} in '{names.RESULTS_COLLECTION}' carries the pressure: {reason}"
    if finer:
        yield (
            f"a finer copy of {_listed(finer)} in '{names.RESULTS_COLLECTION}' shows the pressure: "
            "its own triangles are long where it is touched"
        )


def _listed(parts: list[str]) -> str:
    """Names in quotes; of many the first two, and how many more."""
    shown = parts if len(parts) <= MOST_NAMED else parts[:2]
    listed, others = ", ".join(f"'{name}'" for name in shown), len(parts) - len(shown)
    return f"{listed} and {others} others" if others else listed


def clear(context: Context, hand: Object, parts: Sequence[Object]) -> None:
    """Remove Thenar's key, attributes, copies and bake, and put the product back."""
    for modifier in own.played_modifiers(hand):
        hand.modifiers.remove(modifier)
    correction.remove(hand)
    hand.thenar.bake_path = ""
    own.remove_bake_curves(hand)
    hand.thenar.bake.parts.clear()
    key.remove_key(hand)
    attributes.remove(hand.data, (*names.HAND_ATTRIBUTES, names.LIVE_OFFSET))
    hand.data.update()
    for part in parts:
        copies.remove_copy(part.name)
        moving.send_home(part)
        if part.type == "MESH" and part.data.is_editable and part.mode != "EDIT":
            attributes.remove(part.data, names.PRODUCT_ATTRIBUTES)
            part.data.update()
    context.view_layer.update()


def apply(context: Context, hand: Object, parts: Sequence[Object]) -> None:
    """Add the contact's offsets (as far as its value counts) to every other shape key, then remove its key.

    A moved product stays where it is: that place is now its own.
    """
    blocks = hand.data.shape_keys.key_blocks
    contact = blocks[names.SHAPE_KEY]
    base = key.key_points(hand.data.shape_keys.reference_key)
    offsets = (key.key_points(contact) - base) * (0.0 if contact.mute else contact.value)
    for block in blocks:
        if block != contact:
            key.put_points(hand, block, key.key_points(block) + offsets)
    correction.give_up(hand)
    key.remove_key(hand)
    hand.data.attributes["position"].data.foreach_set("vector", (base + offsets).astype(np.float32).ravel())
    for part in parts:
        part.thenar.is_moved = False
    hand.data.update()
    context.view_layer.update()
