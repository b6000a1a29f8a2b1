"""The order of a bake: frame by frame read and press, then publish all frames at once."""

from dataclasses import dataclass, field

import numpy as np

from . import workflow
from .scene import baked, checks, own, units


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
    settings = context.scene.thenar
    if frame_end < frame_start:
        raise checks.Refusal(f"the bake ends at frame {frame_end} before it starts at {frame_start}; swap them")
    if settings.use_force:
        raise checks.Refusal("a bake presses the product where it stands; switch Force Target off")
    workflow.check(context)
    return Bake(frame_start, frame_end, baked.folder_of(settings.hand), context.scene.frame_current)


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
        }
    )


def publish(context, bake):
    """Write the files, hang them on the hand, and show the frame that was current before."""
    settings = context.scene.thenar
    baked.publish(settings.hand, bake.stem, bake.first, bake.done)
    context.scene.render.use_lock_interface = True
    settings.result.state_hash = ""
    leave(context, bake)
    baked.play(context.scene, workflow.product_parts)


def leave(context, bake):
    """Go back to the frame that was current before the bake."""
    context.scene.frame_set(bake.frame_before)


def run(context, frame_start, frame_end):
    """A whole bake in this thread. Returns the `Bake`. Raises `Refusal` and the native module's errors."""
    bake = begin(context, frame_start, frame_end)
    try:
        while not bake.is_complete:
            job = read_frame(context, bake)
            keep_frame(bake, job, workflow.compute(job))
        publish(context, bake)
    finally:
        leave(context, bake)
    return bake
