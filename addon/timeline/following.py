"""A contact followed through time: skin that remembers from frame to frame, and the energy that it takes up."""

from dataclasses import dataclass, field

import numpy as np

from .. import cache, effects, names, native, workflow
from ..contact_fields import written
from ..properties import effect_settings
from ..scene import checks, rigid

_SHAPE_MM = 0.01
"""Largest change of shape of a product that counts as rigid motion; single precision leaves a hundredth of it."""
_FREE_SHARE = 1e-4
"""Force below which the product counts as off the skin, over the largest of the course; the library's own."""


def is_needed(job):
    """Whether a contact depends on what was before: friction, or an effect that acts over time."""
    acting = [used for used in job.effects if used.amplitude > 0.0]
    return any(
        used.name == names.FRICTION or effect_settings.acts_over_time(used.name, used.numbers) for used in acting
    )


@dataclass
class Course:
    """Frames taken so far. `seconds_per_frame`, s; energies since the first frame, mJ."""

    seconds_per_frame: float
    first: object = None
    product: object = None
    """The native module's product, where it was in the first frame."""
    walk: object = None
    last: tuple | None = None
    """Force on the skin by vertex (n, 3), N, and its place (n, 3), mm, both as the product sees them."""
    work_mj: list = field(default_factory=list)
    slip_loss_mj: list = field(default_factory=list)
    force_n: list = field(default_factory=list)


def take(course, job, hooks):
    """The contact of the next frame. `hooks`: cancel and progress.

    Raises `Refusal` where the frame does not follow from the first, and the native module's errors.
    """
    first = course.first or job
    whole = _motion(first, job)
    shift = job.reading.hand.origin_mm - first.reading.hand.origin_mm
    posed = job.reading.hand.posed_mm + shift
    cancel, progress = hooks
    with workflow.telling(job):
        if course.walk is None:
            course.product, course.first = native.module.Product(*_surface(job)), job
            course.walk = _start(job, course.product, hooks)
        contact = course.walk.advance(
            len(course.work_mj) * course.seconds_per_frame,
            posed,
            whole,
            force_n=job.force_n,
            cancel=cancel,
            progress=progress,
        )
    job.product = _Moved(course.product, whole, shift)
    _book(course, contact, (posed, whole, job))
    return contact


@dataclass(frozen=True)
class _Moved:
    """A product that moved by `whole` (4, 4) since it was prepared; points are about a center `shift` (3), mm, away."""

    product: object
    whole: object
    shift: object

    def gap_mm(self, points_mm, **more):
        """Gaps of points, as `thenar.Product` gives them."""
        return self.product.gap_mm(rigid.seen(points_mm + self.shift, self.whole), **more)


def _surface(job):
    return job.reading.product.vertices_mm, job.reading.product.triangles


def _start(job, product, hooks):
    direction = None if job.direction is None else np.array(job.direction, dtype=np.float64)
    return workflow.prepared(job, *hooks).start(product, direction=direction)


def cycles(force_n, work_mj):
    """(loss, work) in mJ of every cycle: from a frame without force, through contact, to the next without.

    Work is the most that was done on the skin on the way. What skin stores it gives back until it is free, so the work
    done between two free frames is lost.
    """
    free = np.asarray(force_n) <= _FREE_SHARE * max(force_n, default=0.0)
    rests = np.flatnonzero(free)
    between = [(a, b) for a, b in zip(rests[:-1], rests[1:], strict=True) if b - a > 1]
    return [(work_mj[b] - work_mj[a], max(work_mj[a : b + 1]) - work_mj[a]) for a, b in between]


def known_cycles(course):
    """`cycles` of a course; none where skin clings, since the forces of vertices leave attraction out."""
    clings = any(used.name == "adhesion" and used.amplitude > 0.0 for used in course.first.effects)
    return [] if clings else cycles(course.force_n, course.work_mj)


def _motion(first, job):
    """The product's motion (4, 4) since the first frame, about the first frame's hand. Raises `Refusal`."""
    if _fixed(first) != _fixed(job):
        raise checks.Refusal(
            f"the skin of '{job.hand_name}' changes (rest shape, regions, materials, effects or model), but what it "
            "remembers belongs to one skin; remove those keys"
        )
    before, now = first.reading.product, job.reading.product
    if before.vertices_mm.shape != now.vertices_mm.shape or not np.array_equal(before.triangles, now.triangles):
        raise checks.Refusal(_reshaped(job, job.part_names))
    shift = job.reading.hand.origin_mm - first.reading.hand.origin_mm
    after = now.vertices_mm + shift
    whole, left = rigid.motion(before.vertices_mm, after)
    if left <= _SHAPE_MM:
        return whole
    strays = np.linalg.norm(rigid.moved(before.vertices_mm, whole) - after, axis=1)
    worst = [part.name for part in now.parts if strays[part.first : part.first + part.count].max() > _SHAPE_MM]
    raise checks.Refusal(_reshaped(job, worst or job.part_names))


def _reshaped(job, parts):
    listed = ", ".join(f"'{name}'" for name in parts)
    return (
        f"the product ({listed}) changes its shape or its parts move apart, but friction and effects over time follow "
        "one rigid product; move it as a whole, or switch those effects off"
    )


def _fixed(job):
    hand = job.reading.hand
    skin = (hand.rest_mm, hand.triangles, hand.regions, job.materials, job.model)
    return cache.content_hash(*skin, *effects.hashed(job.effects))


def _book(course, contact, place):
    """Add the frame's energies: work of the product on the skin by the mean of the forces at both ends of the step."""
    posed, whole, job = place
    forces, places = _as_seen(contact, (posed, whole, written.offset_mm(contact, job)))
    work = course.work_mj[-1] if course.work_mj else 0.0
    if course.last is not None:
        before, there = course.last
        work -= float((0.5 * (forces + before) * (places - there)).sum())
    course.last = forces, places
    course.work_mj.append(work)
    course.slip_loss_mj.append(course.walk.slip_loss_mj)
    course.force_n.append(float(np.asarray(contact.force_n).sum()))


def _as_seen(contact, place):
    posed, whole, offset = place
    press = np.asarray(contact.force_n) - np.asarray(contact.adhesion_force_n)
    forces = np.asarray(contact.product_normal) * press[:, None] + np.asarray(contact.tangential_force_n)
    return np.nan_to_num(forces) @ whole[:3, :3], rigid.seen(posed - offset, whole)
