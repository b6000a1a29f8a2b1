"""Why a button cannot be pressed now: one sentence each, for its tooltip and for scripts."""

from .. import languages, names, status, workflow
from ..languages import sentences
from . import running


def allows(cls, *problems):
    """Whether none of `problems` stands: sentences, empty where all is well. The first becomes the button's tooltip."""
    problem = next((text for text in problems if text), "")
    if problem:
        words = languages.tip(problem)
        cls.poll_message_set(running.sentence(words if words != problem else sentences.shown(problem)))
    return not problem


def can_compute(cls, context):
    """Whether a contact can be computed: module, hand and product are there, and nothing is under way."""
    return allows(cls, status.native_problem, no_hand(context), no_product(context), busy(), live(context))


def busy():
    """Another computation runs."""
    return "a computation is under way; press Esc to cancel it" if status.run.stage else ""


def live(context):
    """Live computes by itself, and a solve or bake beside it would read what it shows."""
    settings = getattr(context.scene, "thenar", None)
    return "Live keeps the contact up to date; switch it off first" if settings is not None and settings.live else ""


def no_hand(context):
    """No hand is chosen."""
    settings = getattr(context.scene, "thenar", None)
    return "" if settings is not None and settings.hand is not None else "choose the hand's mesh under Hand first"


def no_product(context):
    """No product is chosen."""
    settings = getattr(context.scene, "thenar", None)
    chosen = settings is not None and (settings.product is not None or settings.product_collection is not None)
    return "" if chosen else "choose the product, or a collection of its parts, first"


def no_output(context):
    """The hand carries nothing of Thenar's."""
    return "" if workflow.has_output(context) else "there is no result on the hand; press Solve first"


def no_region_result(context):
    """The hand's vertices were not yet sorted into regions by a solve."""
    hand = context.scene.thenar.hand
    sorted_out = hand is not None and hand.type == "MESH" and names.REGION in hand.data.attributes
    return "" if sorted_out else "there is no result on the hand; press Solve first"


def no_result(context):
    """The scene keeps no result."""
    return "" if context.scene.thenar.result.is_valid else "there is no result to export; press Solve first"


def no_bake(context):
    """The hand plays no bake."""
    hand = context.scene.thenar.hand
    return "" if hand is not None and hand.thenar.bake_path else "there is no bake; press Bake Frames first"


def no_groups(context):
    """The hand has no vertex groups."""
    hand = context.scene.thenar.hand
    grouped = hand is not None and hand.type == "MESH" and len(hand.vertex_groups) > 0
    return "" if grouped else "the hand has no vertex groups; paint one for each region of the skin first"


def no_module():
    """The native module cannot be used."""
    return status.native_problem


def no_effects(context):
    """No effect is listed on the hand."""
    hand = context.scene.thenar.hand
    return "" if hand is not None and len(hand.thenar.effects) > 0 else "no effect is listed"


def no_regions(context):
    """No region is listed on the hand."""
    hand = context.scene.thenar.hand
    return "" if hand is not None and len(hand.thenar.materials) > 0 else "no region is listed"


def wrong_mode(context):
    """The window is in a mode in which objects cannot be made or posed."""
    return "" if context.mode in {"OBJECT", "POSE"} else "go back to Object Mode first (Tab)"
