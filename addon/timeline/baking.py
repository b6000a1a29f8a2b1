"""The order of a bake: frame by frame read and press, then publish all frames at once.

With friction, or effects that act over time, frames follow one another at the scene's rate; else each stands alone.
"""

from dataclasses import dataclass, field
from functools import partial

import numpy as np

from .. import names, native, workflow
from ..contact_fields import written
from ..ownership import own
from ..product_objects import copies, moving
from ..scene import baked, checks, units
from ..soft_grip import covering
from . import following


@dataclass
class Bake:
    """A bake under way: frames still to do, and what the done ones hold."""

    first: int
    last: int
    take: str
    stem: object
    frame_before: int
    course: following.Course
    follows: bool = False
    done: list = field(default_factory=list)
    resumed: int = 0
    """Frames that a bake had solved which ended in a crash."""

    @property
    def frame(self):
        """The frame that is next, or under way."""
        return self.first + len(self.done)

    @property
    def is_complete(self):
        """Whether every frame is done."""
        return self.frame > self.last


def begin(context, frame_start, frame_end, take=""):
    """Check the scene and the range; a `take` without a name gets the next one. Raises `Refusal`."""
    if frame_end < frame_start:
        raise checks.Refusal(f"the bake ends at frame {frame_end} before it starts at {frame_start}; swap them")
    hand, parts = workflow.check(context)
    covering.check_rigid(parts, "a bake presses")
    if context.scene.thenar.use_force:
        moving.check_movable(context, parts)
    render = context.scene.render
    course = following.Course(render.fps_base / render.fps)
    take = take.strip() or baked.free_name(hand)
    if len(f"{names.BAKE_MODIFIER}: {take}".encode()) > 63:
        raise checks.Refusal(f"the take's name '{take}' is too long for a modifier; give it at most 40 letters")
    return Bake(frame_start, frame_end, take, baked.stem_of(hand, take), context.scene.frame_current, course)


def read_frame(context, bake):
    """Go to the bake's frame and read its job, from the shape before any modifier that adds vertices."""
    context.scene.frame_set(bake.frame)
    hand, parts = workflow.check(context)
    with own.without_generators(hand, baked.place_in_stack(hand)):
        return workflow.read_job(context, hand, parts)


def keep_frame(bake, job, contact):
    """Keep what the frame's contact needs to be played."""
    skin, product = job.reading.hand, job.reading.product
    world = skin.posed_mm + np.asarray(contact.displacement_mm) + skin.origin_mm
    pressure = units.kpa(contact.product_pressure_mpa).astype(np.float32)
    fields = written.edged(written.fields_of(contact, job), contact, job)
    edges = fields.product_edge_mm.astype(np.float32)
    carriers = [part for part in product.parts if not part.reason]
    bake.done.append(
        {
            "local": units.to_local(world, skin.matrix, skin.scale),
            "fields": baked.hand_fields(fields),
            "parts": {part.name: pressure[part.first : part.first + part.base_count] for part in carriers},
            "part_edges": {part.name: edges[part.first : part.first + part.base_count] for part in carriers},
            "force_n": float(np.asarray(contact.force_n).sum()),
            "area_mm2": contact.contact_area_mm2,
            "peak_kpa": float(units.kpa(contact.peak_pressure_mpa)),
            "shear_n": float(np.linalg.norm(contact.friction.total_force_n)) if contact.friction else 0.0,
            "offset": fields.offset_mm / skin.scale,
        }
    )


def publish(context, bake):
    """Write the files and hang them on the hand; the next change of frame plays them."""
    settings = context.scene.thenar
    course = bake.course
    for number, frame in enumerate(bake.done):
        frame["work_mj"] = course.work_mj[number] if bake.follows else 0.0
        frame["slip_loss_mj"] = course.slip_loss_mj[number] if bake.follows else 0.0
    parts = workflow.product_parts(settings)
    take = baked.Take(bake.take, bake.stem, bake.first, _sums(bake))
    baked.publish(settings.hand, take, bake.done, [part for part in parts if part.name in bake.done[0]["parts"]])
    for part in parts:
        moving.send_home(part)
        if part.name in bake.done[0]["parts"]:
            copies.remove_copy(part.name)  # frames are shown on the part itself
    context.scene.render.use_lock_interface = True
    settings.result.state_hash, settings.result.reference.is_valid = "", False


def _sums(bake):
    """What the frames of a bake have together, by the names of `hand.thenar.bake`."""
    found = following.known_cycles(bake.course) if bake.follows else []
    loss, work = (float(total) for total in np.sum(found, axis=0)) if found else (0.0, 0.0)
    return {
        "frame_start": bake.first,
        "frame_end": bake.last,
        "follows": bake.follows,
        "peak_kpa": max(frame["peak_kpa"] for frame in bake.done),
        "peak_force_n": max(frame["force_n"] for frame in bake.done),
        "peak_shear_n": max(frame["shear_n"] for frame in bake.done),
        "work_mj": float(bake.done[-1]["work_mj"]),
        "slip_loss_mj": float(bake.done[-1]["slip_loss_mj"]),
        "cycles": len(found),
        "cycle_loss_mj": loss / max(len(found), 1),
        "cycle_loss_share": loss / work if work > 0.0 else 0.0,
    }


def leave(context, bake):
    """Go back to the frame that was current before the bake."""
    context.scene.frame_set(bake.frame_before)


def steps(context, frame_start, frame_end, take=""):
    """A whole bake as the steps of a computation. Returns the `Bake`; the current frame stays what it was.

    Frames that a crashed bake of this take has solved from the same input are taken over, unless frames follow one
    another. Raises `Refusal` and the native module's errors, which name the frame; then nothing is written.
    """
    bake, own_hashes = begin(context, frame_start, frame_end, take), set()
    try:
        while not bake.is_complete:
            job = read_frame(context, bake)
            if not bake.done:
                bake.follows = following.is_needed(job)
            kept = None if bake.follows else baked.kept_frame(bake.stem, job.input_hash)
            if kept is not None:
                bake.done.append(kept)
                bake.resumed += job.input_hash not in own_hashes  # else the same input came twice in this bake
                continue
            try:
                contact = yield partial(_compute, bake, job)
            except (checks.Refusal, *native.error_types()) as error:
                raise type(error)(f"at frame {bake.frame}, {error}") from None
            keep_frame(bake, job, contact)
            if not bake.follows:
                own_hashes.add(job.input_hash)
                baked.keep_frame(bake.stem, job.input_hash, bake.done[-1])
        publish(context, bake)
    finally:
        baked.forget_frames(bake.stem)  # only a crash leaves them, for the next bake of these frames
        leave(context, bake)
    return bake


def _compute(bake, job, cancel, progress):
    def report(stage, fraction):
        share = (len(bake.done) + fraction) / (bake.last - bake.first + 1)
        progress(f"frame {bake.frame} of {bake.last}, {stage}", share)

    hooks = cancel, progress and report
    return following.take(bake.course, job, hooks) if bake.follows else workflow.compute(job, *hooks)
