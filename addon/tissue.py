"""The tissue over bone: its thickness as the library has it, as an attribute and as a vertex group to be painted."""

import numpy as np

from . import effects, names, native, workflow
from .scene import checks, read, regions, write

GROUP = "Thickness"
_ROOM = 1.25
"""Full weight over the thickest skin there is, so that a brush can add as well as take away."""
_ROUND = tuple(factor * 10.0**power for power in range(-1, 3) for factor in (1.0, 2.0, 5.0))


def write_thickness(context):
    """Write the thickness under every vertex, by materials and effects. Raises `Refusal`. Returns it (n,), mm."""
    settings = context.scene.thenar
    hand = settings.hand
    problem = native.problem()
    if problem:
        raise checks.Refusal(problem)
    checks.check_hand(context, hand)
    group_names = tuple(material.name for material in hand.thenar.materials)
    workflow.check_groups(hand, group_names)
    job = workflow.Job(
        hand_name=hand.name,
        part_names=(),
        reading=read.Reading(read.read_hand(context, hand, group_names), None),
        region_names=group_names or (names.WHOLE_SKIN,),
        materials=workflow.material_numbers(hand),
        effects=effects.read(context, hand, group_names or (names.WHOLE_SKIN,)),
        slide_mm=None,
        model=settings.model.lower(),
        force_n=None,
        direction=None,
        input_hash="",
    )
    with workflow.telling(job):
        workflow.prepared(job)
    write.write_thickness(hand.data, job.thickness_mm)
    return job.thickness_mm


def paint(context, effect):
    """Make a vertex group from the thickness as it is now, and let `effect` take its field from there.

    The effect then acts in full, so that nothing changes until a brush does. Raises `Refusal`. Returns the group.
    """
    hand = context.scene.thenar.hand
    thickness = np.nan_to_num(write_thickness(context), nan=0.0, posinf=0.0)
    if not thickness.any():
        raise checks.Refusal(f"no skin of '{hand.name}' lies over bone; give its materials a thickness first")
    full = next((step for step in _ROUND if step >= _ROOM * thickness.max()), float(thickness.max()))
    group = regions.paint(hand, _free_name(hand), np.minimum(thickness / full, 1.0))
    effect.painted, effect.painted_full, effect.amplitude = group.name, full, 1.0
    return group


def _free_name(hand):
    taken = {effect.painted for effect in hand.thenar.effects}
    names_ = [GROUP, *(f"{GROUP} {number}" for number in range(2, 100))]
    return next(name for name in names_ if name not in taken and name not in hand.vertex_groups)
