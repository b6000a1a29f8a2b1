"""One hand on one product, followed: what is prepared once, and what one update reads, computes and writes.

Holds arrays and names, no Blender object: undo and loading replace those.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from .. import cache, effects, maps, names, native, workflow
from ..contact_fields import skin_edge, written
from ..ownership import own
from ..results import comfort, sentences
from ..results import result as results
from ..scene import attributes, checks, mesh, read, sizes, state, units, write
from ..skin_display import colors
from ..soft_grip import covering
from . import nodes

_PRODUCT_EVERY = 4
"""While the scene moves, the edge on the product is computed once in so many solves: it takes twice as long as one."""


@dataclass
class Session:
    """A followed hand: its `job`, what that depends on besides pose (`setup`), and what was solved last."""

    job: workflow.Job
    """Read when it began, but for the product and the pose, which are those of the last solve."""
    setup: str
    seen: tuple | None = None
    """Pose (positions and matrix) at the last solve; None to solve whatever is there."""
    surface: list | None = None
    """What the scene showed of the product that is prepared, as `state.shapes`."""
    skin: object = None
    """Shares with the cached skin what is prepared. Effects and warm starts are its own: solves do not change them."""
    painted: dict = field(default_factory=dict)
    is_edged: bool = False
    """Whether the last contact was written with its edge, which takes longer than the press: only while a map shows."""
    product_edge: object = None
    """Distances of the product's vertices to the edge as last computed, and how many solves ago, or None."""
    is_warm: bool = False
    """Whether solves begin at the last one and are as exact as the eye: faster, but skin beside the contact then keeps
    some of its way there."""

    def fits(self, hand, parts):
        """Whether hand and product are still the ones it began with."""
        return self.job.hand_name == hand.name and self.job.part_names == tuple(part.name for part in parts)


def check(context):
    """Refuse what Live cannot follow. Returns hand and product parts. Raises `Refusal`."""
    hand, parts = workflow.check_objects(context)
    if own.bake_modifiers(hand):
        raise checks.Refusal(f"'{hand.name}' plays a bake; press Clear first, then switch Live on")
    if context.scene.thenar.use_force:
        raise checks.Refusal("Live follows the pose and keeps the product where it is; switch Force Target off")
    covering.check_rigid(parts, "Live presses")
    if any(modifier.type == "MIRROR" and modifier.show_viewport for modifier in hand.modifiers):
        raise checks.Refusal(f"Live cannot follow the Mirror modifier of '{hand.name}'; apply it or press Solve")
    return hand, parts


def begin(context, hand, parts):
    """A session for this hand: own earlier output is taken off, the modifier hung on. Raises `Refusal`."""
    sizes.check_product_size(context, hand, parts)
    if own.contact_key(hand) is not None or any(part.thenar.is_moved for part in parts):
        write.clear(context, hand, parts)
    job = workflow.read_job(context, hand, parts)
    nodes.attach(hand)
    context.view_layer.update()
    attributes.write(hand.data, names.REGION, "INT", job.reading.hand.regions)
    try:
        skin = workflow.prepared(job).with_effects([effect.native(native.module) for effect in job.effects])
    except native.error_types() as error:
        raise sentences.named(error, job) from None
    write.write_thickness(hand.data, np.asarray(skin.thickness_mm))
    return Session(job, setup_of(context, hand), skin=skin)


def setup_of(context, hand):
    """Digest of what a session depends on besides pose and product."""
    settings = context.scene.thenar
    stack = tuple((modifier.name, modifier.type, modifier.show_viewport) for modifier in hand.modifiers)
    groups = tuple(group.name for group in hand.vertex_groups)
    choices = (settings.model, *settings.slide_mm, hand.mode == "WEIGHT_PAINT", units.mm_per_unit(context.scene))
    rest = mesh.positions(hand.data)
    return cache.content_hash(workflow.material_numbers(hand), *effects.shown(hand), stack, groups, choices, rest)


def follow(context, session, hand, parts):
    """Bring the contact of the checked hand and parts to what the scene shows now. Returns whether anything had moved.

    Raises `Refusal` or the native module's errors; then the last contact stays as it is.
    """
    base = nodes.base_positions(hand, context.evaluated_depsgraph_get())
    matrix = units.world_from_local(hand)
    is_same_product = state.is_same(state.shapes(context, parts), session.surface)
    is_edged = not hand.thenar.shows_pressure or session.is_edged
    if is_same_product and is_edged and state.is_same((base, matrix), session.seen):
        return False
    skin = session.job.reading.hand
    checks.check_finite(base, hand.name, "posed hand")
    posed = units.to_world_mm(base, matrix, skin.scale, skin.origin_mm)
    if not is_same_product:
        _take_product(context, session, parts)
    contact = _press(session, posed)
    session.job = replace(session.job, reading=replace(session.job.reading, hand=replace(skin, posed_mm=posed)))
    _write(context, session, contact, matrix)
    session.seen, session.is_warm = (base, matrix), True
    return True


def settle(context, session):
    """Solve what the scene shows once more from nothing, as Solve does. Raises as `follow` does."""
    session.seen, session.is_warm = None, False
    try:
        return follow(context, session, *check(context))
    finally:
        session.is_warm = True


def _take_product(context, session, parts):
    skin = session.job.reading.hand
    sizes.check_product_size(context, context.scene.thenar.hand, parts)
    product = read.read_product(context, parts, skin.scale, skin.origin_mm)
    prepared = native.module.Product(product.vertices_mm, product.triangles)
    session.job = replace(session.job, reading=read.Reading(skin, product), product=prepared)
    # Should the press fail, the next look tries again.
    session.surface, session.seen = state.shapes(context, parts), None
    session.product_edge = None
    session.painted.clear()


def _press(session, posed):
    job = session.job
    slide = None if job.slide_mm is None else np.array(job.slide_mm, dtype=np.float64)
    try:
        return session.skin.press(job.product, posed_vertices_mm=posed, slide_mm=slide, live=session.is_warm)
    except native.error_types() as error:
        raise sentences.named(error, job) from None


def _write(context, session, contact, matrix):
    """Shape and colors of the skin, pressure of the product, and the scene's numbers."""
    settings, job = context.scene.thenar, session.job
    hand, parts = settings.hand, workflow.product_parts(settings)
    fields = written.fields_of(contact, job)
    session.is_edged = hand.thenar.shows_pressure
    if session.is_edged:
        fields = _edged(session, fields, contact)
    _shape(hand, fields, (matrix, job.reading.hand.scale))
    scale = maps.scale(maps.MAPS[maps.PRESSURE], settings)
    _paint(session, hand, (_shown_kpa(fields.pressure_mpa), _single(fields.edge_mm)), (settings, scale, colors.SKIN))
    loads, edges = _shown_kpa(fields.product_pressure_mpa), _single(fields.product_edge_mm)
    by_name = {part.name: part for part in parts}
    for record in job.reading.product.parts:
        if not record.reason:
            part = by_name[record.name]
            mine = slice(record.first, record.first + min(record.count, len(part.data.vertices)))
            _paint(session, part, (loads[mine], None if edges is None else edges[mine]), (settings, scale, colors.BARE))
    results.fill(settings.result, job, contact, write.WriteReport(0.0, 0, ()), sentences.remarks(contact, job))
    comfort.judge(context)
    context.view_layer.update()


def _shown_kpa(pressure_mpa):
    """kPa in the precision of a mesh: what it would not tell apart need not be painted anew."""
    return units.kpa(pressure_mpa).astype(np.float32)


def _edged(session, fields, contact):
    """The fields with their edge; while the scene moves, the product's is that of a few solves before."""
    before, job = session.product_edge, session.job
    if not session.is_warm or before is None or before[1] + 1 >= _PRODUCT_EVERY:
        fields = written.edged(fields, contact, job)
        session.product_edge = fields.product_edge_mm, 0
        return fields
    session.product_edge = before[0], before[1] + 1
    edge = np.where(fields.product_pressure_mpa > 0.0, before[0], np.minimum(before[0], -skin_edge.REACH_MM))
    return replace(written.skin_edged(fields, contact, job), product_edge_mm=edge)


def _single(edge_mm):
    return None if edge_mm is None else edge_mm.astype(np.float32)


def _shape(hand, fields, place):
    """Offsets and fields of the skin; where nothing presses, only what the mesh does not hold yet."""
    put = attributes.write if fields.force_n.any() else attributes.settle
    moved_mm = fields.displacement_mm.astype(np.float32)
    put(hand.data, names.LIVE_OFFSET, "FLOAT_VECTOR", units.vectors_to_local(moved_mm, *place))
    put(hand.data, names.DEPTH_MM, "FLOAT", fields.depth_mm)
    put(hand.data, names.OVERLAP_MM, "FLOAT", fields.overlap_mm)
    put(hand.data, names.FORCE_N, "FLOAT", fields.force_n)
    put(hand.data, names.DISPLACEMENT_MM, "FLOAT_VECTOR", moved_mm)
    if fields.shear is not None:
        put(hand.data, names.SHEAR_KPA, "FLOAT", units.kpa(fields.shear[0]))
        put(hand.data, names.SLIP_MARGIN, "FLOAT", fields.shear[1])


def _paint(session, obj, fields, look):
    """Pressure, edge and colors, written only where they changed; nothing where nothing presses or pressed."""
    (settings, scale, bare), (pressure, edge) = look, fields
    before = session.painted.get(obj.name)
    under = before.under if before is not None else colors.ground(obj, bare)
    if before is None or before.scale != scale or not before.fits(fields):
        tinted = colors.by_scale(fields, scale, under)
    else:
        rows, tinted = before.changed(fields), before.tinted
        if not (rows.size or pressure.any()):
            return
        few = pressure[rows], None if edge is None else edge[rows]
        # Four floats at a time, as one item: numpy puts rows to their places at a fifth of the speed.
        tinted.view(np.complex128)[rows, 0] = colors.by_scale(few, scale, under.at(rows)).view(np.complex128)[:, 0]
    session.painted[obj.name] = _Painted(pressure, edge, tinted, scale, under)
    attributes.write(obj.data, names.PRESSURE_KPA, "FLOAT", pressure)
    write.write_edge(obj.data, edge)
    attributes.write(obj.data, names.COLOR, "FLOAT_COLOR", tinted)
    if edge is None or maps.shown(settings).kind == maps.PRESSURE:
        obj.data.update()
    else:
        colors.lay_map(obj.data, settings, under)
        obj.data.update()


@dataclass(frozen=True)
class _Painted:
    """What a mesh was painted with last: pressure, edge (or None) and colors by vertex, the pressure's scale, and
    the bare surface."""

    pressure: object
    edge: object
    tinted: object
    scale: object
    under: object

    def fits(self, fields):
        """Whether the new fields are those of the same vertices, and have an edge if these had."""
        pressure, edge = fields
        return len(pressure) == len(self.pressure) and (edge is None) == (self.edge is None)

    def changed(self, fields):
        """Rows of the vertices that need other colors."""
        pressure, edge = fields
        is_new = self.pressure != pressure
        return np.flatnonzero(is_new if edge is None else is_new | (self.edge != edge))
