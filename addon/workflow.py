"""The order of a press: read, call the library, write back. Knows nothing of buttons and layout."""

import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from functools import partial
from typing import Literal, TypeAlias

import numpy as np
from bpy.types import Context, Object, PropertyGroup

from . import cache, effects, maps, names, native, status
from .contact_fields import between, written
from .ownership import own, owned
from .product_objects import parts as parts_of
from .properties import effect_settings
from .properties.material_settings import ANATOMY, MATERIAL_NUMBERS
from .results import certificate, comfort, grades, holding, sentences
from .results import result as results
from .scene import checks, read, sizes, state, units, write
from .scene.units import Floats
from .soft_grip import covering
from .soft_grip import settings as grip_settings
from .steps import PAUSE, Cancel, Progress, Steps, Work, at_once
from .subdivision import last

Numbers: TypeAlias = tuple[tuple[str, float], ...]
"""The library's numbers of a material by name."""


@dataclass
class Job:
    """A press that was read from the scene and may be computed in any thread; nothing in it is a Blender object."""

    hand_name: str
    part_names: tuple[str, ...]
    reading: read.Reading
    region_names: tuple[str, ...]
    materials: tuple[Numbers, ...]
    effects: tuple[effects.UsedEffect, ...]
    slide_mm: tuple[float, ...] | None
    model: Literal["layer", "paper"]
    force_n: float | None
    direction: tuple[float, ...] | None
    input_hash: str
    state_hash: str = ""
    seconds: dict[str, float] = field(default_factory=dict)
    thickness_mm: Floats | None = None
    """(n), set by `compute`."""
    product: "native.Product | None" = None
    """The native module's product, set by `compute`."""
    refines_product: bool = False
    """Whether `compute` refines a coarse product for its map."""
    grip: covering.Grip | None = None
    """What covers the product, or None where all of it is rigid; the product is then refined in any case."""
    taken: ExitStack | None = None
    """What puts Thenar's earlier output back."""


def prepare(context: Context, taken: ExitStack) -> Job:
    """Read the scene's hand and product into a `Job`. Raises `Refusal`.

    Thenar's own output stays out of the scene until the stack `taken` is closed, or a contact is written: putting it
    back in between would have a subdivided hand evaluated twice more.
    """
    started = time.perf_counter()
    hand, parts = check(context)
    if own.bake_modifiers(hand):
        raise checks.Refusal(f"'{hand.name}' plays a bake; press Clear first, then solve")
    if context.scene.thenar.live:
        raise checks.Refusal(f"Live keeps the contact of '{hand.name}' up to date; switch it off first")
    job = read_job(context, hand, parts, last.take_out(context, hand, parts, taken))
    job.refines_product = True
    job.taken, job.state_hash = taken, state_hash(context)
    job.seconds["read"] = time.perf_counter() - started
    return job


product_parts = parts_of.product_parts


def check(context: Context) -> tuple[Object, list[Object]]:
    """Refuse a scene that cannot be pressed. Returns hand and product parts. Raises `Refusal`."""
    hand, parts = check_objects(context)
    sizes.check_product_size(context, hand, parts)
    return hand, parts


def check_objects(context: Context) -> tuple[Object, list[Object]]:
    """The same without the product's size, which Live checks when the product changes."""
    problem = native.problem()
    if problem:
        raise checks.Refusal(problem)
    settings = context.scene.thenar
    hand, parts = settings.hand, product_parts(settings)
    checks.check_hand(context, hand)
    checks.check_product(context, parts, hand)
    owned.check_names(hand)
    return hand, parts


def read_job(context: Context, hand: Object, parts: Sequence[Object], subdivision: last.Last | None = None) -> Job:
    """The job of this hand and these parts at the current frame, read without Thenar's own output.

    `subdivision`: what ends the hand's stack and is computed, since it is switched off.
    """
    settings = context.scene.thenar
    listed = tuple(hand.thenar.materials)
    group_names = tuple(material.name for material in listed)
    check_groups(hand, group_names)
    with own.without_own_output(context, hand, parts):
        skin = read.read_hand(context, hand, group_names, subdivision)
        product = read.read_product(context, parts, skin.scale, skin.origin_mm)
        grip = covering.read(context, parts, product)
        used = effects.read(context, hand, group_names or (names.WHOLE_SKIN,))
    materials = material_numbers(hand)
    force = settings.force_n if settings.use_force else None
    direction = tuple(settings.direction) if settings.use_force and settings.direction_mode == "OWN" else None
    if direction is not None and not np.any(direction):
        raise checks.Refusal("the direction of the force is zero; enter a direction or choose Automatic")
    model: Literal["layer", "paper"] = settings.model.lower()
    slide = tuple(settings.slide_mm) if any(effect.name == names.FRICTION for effect in used) else None
    return Job(
        hand_name=hand.name,
        part_names=tuple(part.name for part in parts),
        reading=read.Reading(skin, product),
        region_names=group_names or (names.WHOLE_SKIN,),
        materials=materials,
        effects=used,
        slide_mm=slide,
        model=model,
        force_n=force,
        direction=direction,
        grip=grip,
        input_hash=cache.content_hash(
            skin.rest_mm,
            skin.posed_mm,
            skin.triangles,
            skin.regions,
            product.vertices_mm,
            product.triangles,
            materials,
            *effects.hashed(used),
            slide,
            model,
            force,
            direction,
            *covering.hashed(grip),
            names.VERSION,
        ),
    )


def check_groups(hand: Object, group_names: Sequence[str]) -> None:
    """Refuse materials whose vertex group is gone. Raises `Refusal`."""
    missing = [name for name in group_names if name not in hand.vertex_groups]
    if missing:
        raise checks.Refusal(
            f"'{hand.name}' has no vertex group '{missing[0]}' that its materials name; "
            "rename the group or remove it from the list under Materials"
        )


def material_numbers(hand: Object) -> tuple[Numbers, ...]:
    """The library's numbers of every region's material; of the one material where no region is listed."""
    return tuple(_numbers(material) for material in (tuple(hand.thenar.materials) or (hand.thenar.default_material,)))


def compute(job: Job, cancel: Cancel | None = None, progress: Progress | None = None) -> "native.Contact":
    """The contact of a job, by the native module; no Blender in it, so that a thread may run it.

    `cancel` has `is_set()`; `progress(stage, fraction)`. Raises the native module's errors, with the objects' names.
    """
    if job.refines_product or job.grip is not None:
        job.reading, job.grip = covering.refined(job.reading, job.grip)
    with telling(job):
        return _press(job, prepared(job, cancel, progress), cancel, progress)


@contextmanager
def telling(job: Job) -> Iterator[None]:
    """Errors of the native module leave with the objects' names."""
    try:
        yield
    except native.error_types() as error:
        raise sentences.named(error, job) from None


def prepared(job: Job, cancel: Cancel | None = None, progress: Progress | None = None) -> "native.Skin":
    """The job's prepared skin with its effects; no other job changes it."""
    thenar, started, key = native.module, time.perf_counter(), _skin_key(job)
    if progress is not None:
        progress("prepare", 0.0)
    skin = cache.skin(key, lambda: new_skin(job, cancel, progress))
    if job.effects:
        bare, wanted = skin, [effect.native(thenar) for effect in job.effects]
        skin = cache.skin(cache.content_hash(key, *effects.hashed(job.effects)), lambda: bare.with_effects(wanted))
    job.thickness_mm = np.asarray(skin.thickness_mm)
    job.seconds["prepare"] = time.perf_counter() - started
    return skin


def _skin_key(job: Job) -> str:
    hand = job.reading.hand
    return cache.content_hash(hand.rest_mm, hand.triangles, hand.regions, job.region_names, job.materials, job.model)


def _press(job: Job, skin: "native.Skin", cancel: Cancel | None, progress: Progress | None) -> "native.Contact":
    hand, product = job.reading.hand, job.reading.product
    started = time.perf_counter()
    job.product = cache.product(
        cache.content_hash(product.vertices_mm, product.triangles),
        lambda: native.module.Product(product.vertices_mm, product.triangles),
    )
    contact = skin.press(
        job.product,
        posed_vertices_mm=hand.posed_mm,
        force_n=job.force_n,
        direction=None if job.direction is None else np.array(job.direction, dtype=np.float64),
        slide_mm=None if job.slide_mm is None else np.array(job.slide_mm, dtype=np.float64),
        cancel=cancel,
        progress=progress,
        grip=covering.elastomers(job.grip),
        grip_of_vertex=None if job.grip is None else job.grip.of_vertex,
    )
    job.seconds["press"] = time.perf_counter() - started
    return contact


def finish(context: Context, job: Job, contact: "native.Contact") -> Steps[PropertyGroup]:
    """Write the contact back, check what is shown, and keep its numbers; steps that return the scene's result.

    Raises `Refusal` if the scene changed meanwhile; on any failure the scene is as before.
    """
    fields = yield partial(written.edged, written.fields_of(contact, job), contact, job)
    settings = context.scene.thenar
    friction = context.scene.thenar_grasps.friction
    held = yield partial(holding.of_press, job.reading.hand.posed_mm, contact, friction)
    hand, parts = settings.hand, product_parts(settings)
    if hand is None or hand.name != job.hand_name or tuple(part.name for part in parts) != job.part_names:
        raise checks.Refusal("hand or product were changed while solving; solve again")
    if job.state_hash != state_hash(context):
        raise checks.Refusal(f"'{hand.name}', its product or a setting was changed while solving; solve again")
    yield PAUSE
    started = time.perf_counter()

    def measure(surface: certificate.Surface, left_mm: Floats | None) -> Work:
        pressed = contact.pressed_product or job.product
        return partial(certificate.measure, surface, left_mm, (pressed, fields.offset_mm))

    report = yield from write.write_contact(context, hand, parts, (job.reading, fields), measure)
    if job.taken is not None:
        job.taken.pop_all()
    job.seconds["write"] = time.perf_counter() - started
    notes = [*sentences.remarks(contact, job), *_left_out(job)]
    result = results.fill(settings.result, job, contact, report, notes)
    results.add_holding(result, held)
    if result.reason_kind == grades.NO_CONTACT:
        result.passes_between = yield partial(between.passes, job.product, _posed(job))
    result.state_hash = state_hash(context)
    comfort.judge(context)
    status.set_stale(context.scene.name, False)
    return result


def _posed(job: Job) -> between.Posed:
    hand = job.reading.hand
    return between.Posed(hand.posed_mm, hand.triangles, hand.regions >= 0, np.ones(len(hand.triangles), bool))


def steps(context: Context) -> Steps[PropertyGroup]:
    """One press as the steps of a computation. Returns the scene's result."""
    try:
        return (yield from _once(context))
    except last.DiffersError:  # the scene is as before
        return (yield from _once(context))


def _once(context: Context) -> Steps[PropertyGroup]:
    with ExitStack() as taken:
        job = prepare(context, taken)
        contact = yield partial(compute, job)
        return (yield from finish(context, job, contact))


def solve(context: Context) -> PropertyGroup:
    """One press from start to end, in this thread. Returns the scene's result."""
    return at_once(steps(context))


def _left_out(job: Job) -> Iterator[str]:
    """What a press of one moment does not know."""
    waiting = [effect_settings.title(used.name).lower() for used in job.effects if _waits(used)]
    listed = " and ".join(waiting)
    if len(waiting) == 1:
        yield f"{listed} acts over time: bake to see it"
    elif waiting:
        yield f"{listed} act over time: bake to see it"


def _waits(used: effects.UsedEffect) -> bool:
    return used.amplitude > 0.0 and effect_settings.acts_over_time(used.name, used.numbers)


def state_hash(context: Context) -> str:
    """Digest of what the result depends on, as the scene shows it now; cheap enough for every change."""
    settings = context.scene.thenar
    hand, parts = settings.hand, product_parts(settings)
    if hand is None or not parts:
        return ""
    listed = tuple(hand.thenar.materials) or (hand.thenar.default_material,)
    materials = tuple((material.name, _numbers(material)) for material in listed)
    choices: tuple[object, ...] = (
        settings.model,
        settings.use_force and (settings.force_n, settings.direction_mode, *settings.direction),
    )
    shapes = state.shapes(context, [hand, *parts])
    choices += (*effects.shown(hand), *settings.slide_mm, *(grip_settings.shown(part) for part in parts))
    return cache.content_hash(names.VERSION, materials, choices, units.mm_per_unit(context.scene), *shapes)


def is_out_of_date(context: Context) -> bool:
    """Whether the scene differs from the one that was solved; remembered for the panel.

    In Edit Mode Blender shows the cage in place of the shape: there the last answer stands.
    """
    settings = context.scene.thenar
    result = settings.result
    if any(obj.mode == "EDIT" for obj in (settings.hand, *product_parts(settings)) if obj is not None):
        return status.is_stale(context.scene.name)
    stale = bool(result.is_valid and result.state_hash != state_hash(context))
    status.set_stale(context.scene.name, stale)
    return stale


def _numbers(material: PropertyGroup) -> Numbers:
    """The library's numbers of a region's material, in the table's order; six digits of Blender's single precision."""
    numbers = {}
    for name, (prop, factor) in MATERIAL_NUMBERS.items():
        numbers[name] = float(f"{getattr(material, prop) / factor:.6g}")
    for name in ANATOMY:
        numbers[name] = numbers[name] or np.inf
    return tuple(numbers.items())


def new_skin(job: Job, cancel: Cancel | None = None, progress: Progress | None = None) -> "native.Skin":
    """The job's skin, prepared, still without effects. Raises the native module's errors."""
    thenar, hand = native.module, job.reading.hand
    materials = [_material(numbers) for numbers in job.materials]
    return thenar.Skin(
        hand.rest_mm,
        hand.triangles,
        regions=hand.regions,
        materials=materials,
        model=job.model,
        region_names=sentences.titles(job.region_names),
        cancel=cancel,
        progress=progress,
    )


def _material(numbers: Numbers) -> "native.Material":
    by_name = dict(numbers)
    height, radius, width = (by_name.pop(name) for name in list(by_name) if name.startswith("swelling_"))
    return native.module.Material(swelling=(height, radius, width), **by_name)


def has_output(context: Context) -> bool:
    """Whether the scene's hand carries anything that Thenar wrote."""
    settings = context.scene.thenar
    hand = settings.hand
    if hand is None or hand.type != "MESH":
        return False
    carried = own.contact_key(hand) is not None or owned.is_own(hand.data, names.PRESSURE_KPA)
    return bool(carried or settings.result.is_valid or own.played_modifiers(hand))


def clear(context: Context) -> bool:
    """Take everything away that Thenar wrote on hand and product. Raises `Refusal` for linked data. Returns True."""
    settings = context.scene.thenar
    hand, parts = settings.hand, product_parts(settings)
    checks.check_writable(hand)
    write.clear(context, hand, parts)
    results.clear(settings.result)
    settings.maps.shown = maps.PRESSURE
    status.set_stale(context.scene.name, False)
    return True


def apply(context: Context) -> bool:
    """Add the contact's offsets to every other shape, and remove its key. Raises `Refusal`. Returns True."""
    settings = context.scene.thenar
    checks.check_writable(settings.hand)
    if own.contact_key(settings.hand) is None:
        raise checks.Refusal(f"'{settings.hand.name}' has no shape key '{names.SHAPE_KEY}'; press Solve first")
    write.apply(context, settings.hand, product_parts(settings))
    settings.result.state_hash = state_hash(context)
    return True
