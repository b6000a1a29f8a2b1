"""The order of a bake: frame by frame read and press, then publish all frames at once."""

from dataclasses import dataclass, field
from functools import partial

import numpy as np

from . import native, workflow
from .scene import baked, checks, moving, own, units


@dataclass
class Bake:
    """A bake under way: frames still to do, and what the done ones hold."""

    first: int
    last: int
    stem: object
    frame_before: int
    done: list = field(default_factory=list)

    @property
    def frame(self):
        """The frame that is next, or under way."""
        return self.first + len(self.done)

    @property
    def is_complete(self):
        """Whether every frame is done."""
        return self.frame > self.last


def begin(context, frame_start, frame_end):
    """Check the scene and the range. Raises `Refusal`."""
    if frame_end < frame_start:
        raise checks.Refusal(f"the bake ends at frame {frame_end} before it starts at {frame_start}; swap them")
    hand, parts = workflow.check(context)
    if context.scene.thenar.use_force:
        moving.check_movable(context, parts)
    return Bake(frame_start, frame_end, baked.folder_of(hand), context.scene.frame_current)


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
    carriers = [part for part in product.parts if not part.reason]
    bake.done.append(
        {
            "local": units.to_local(world, skin.matrix, skin.scale),
            "pressure_kpa": units.kpa(contact.pressure_mpa).astype(np.float32),
            "parts": {part.name: pressure[part.first : part.first + part.base_count] for part in carriers},
            "force_n": float(np.asarray(contact.force_n).sum()),
            "area_mm2": contact.contact_area_mm2,
            "peak_kpa": float(units.kpa(contact.peak_pressure_mpa)),
            "offset": workflow.offset_mm(contact, job) / skin.scale,
        }
    )


def publish(context, bake):
    """Write the files and hang them on the hand; the next change of frame plays them."""
    settings = context.scene.thenar
    baked.publish(settings.hand, bake.stem, bake.first, bake.done)
    for part in workflow.product_parts(settings):
        moving.send_home(part)
    context.scene.render.use_lock_interface = True
    settings.result.state_hash = ""


def leave(context, bake):
    """Go back to the frame that was current before the bake."""
    context.scene.frame_set(bake.frame_before)


def steps(context, frame_start, frame_end):
    """A whole bake as the steps of a computation. Returns the `Bake`; the current frame stays what it was.

    Raises `Refusal` and the native module's errors, which name the frame; then nothing is written.
    """
    bake = begin(context, frame_start, frame_end)
    try:
        while not bake.is_complete:
            job = read_frame(context, bake)
            try:
                contact = yield partial(_compute, bake, job)
            except native.error_types() as error:
                raise type(error)(f"at frame {bake.frame}, {error}") from None
            keep_frame(bake, job, contact)
        publish(context, bake)
    finally:
        leave(context, bake)
    return bake


def _compute(bake, job, cancel, progress):
    def report(stage, fraction):
        share = (len(bake.done) + fraction) / (bake.last - bake.first + 1)
        progress(f"frame {bake.frame} of {bake.last}, {stage}", share)

    return workflow.compute(job, cancel, progress and report)
