"""The tissue over bone: its thickness as the library has it, on the hand as an attribute, without a press."""

from . import effects, names, native, workflow
from .scene import checks, read, write


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
    with workflow.prepared(job):
        write.write_thickness(hand.data, job.thickness_mm)
    return job.thickness_mm
