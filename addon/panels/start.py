"""The cards that stand in the main panel while no hand is set: each button does the whole step."""

import bpy

from ..languages import iface
from ..product_objects.parts import product_parts
from ..scene import sizes
from . import text

_LONGEST = 24
"""Letters of a name on a button."""
BIG = 1.5
"""Height of the button to press next."""


def draw_cards(layout, context):
    """Sample, product without a hand, hand that is there; below them what needs no hand.

    Where a study is selected, which needs no hand, a button each, so that its answer is in sight.
    """
    if text.progress(layout):
        return
    layout.use_property_split = False
    if context.scene.thenar_new_study.is_open:
        text.faint(layout, context, "Answer what New Study asks below; a hand, product or sample may follow later")
        return
    is_loaded = bool(context.scene.thenar_recordings.items)
    words = "Recordings are loaded: see below. A hand begins here:" if is_loaded else "No hand is set yet. Begin here:"
    text.faint(layout, context, words)
    if _is_study(context.scene.thenar_recordings):
        _draw_short(layout.column(align=True), context)
        return
    _draw_sample(layout.box().column(), context)
    _draw_product(layout.box().column(), context)
    _draw_hand(layout.box().column(), context)
    if not is_loaded:
        draw_studies(layout.box().column())


def _is_study(state):
    """Whether the recording that is selected in the list is a study."""
    number = min(max(state.index, 0), len(state.items) - 1)
    return number >= 0 and state.items[number].kind == "STUDY"


def _draw_short(column, context):
    settings = context.scene.thenar
    column.operator("thenar.add_sample", text="Try a Sample", icon="PLAY").kind = "held_bottle"
    if product_parts(settings):
        if draw_sizes(column, context):
            column.operator("thenar.make_hand", text="Make Hand", icon="VIEW_PAN")
    else:
        column.operator("thenar.add_product", text="Add Product...", icon="IMPORT")
    column.operator("thenar.add_hand", text="Add Hand from File...", icon="IMPORT")
    column.prop(settings, "hand", text="")


def draw_studies(column):
    """The ways to a study, which needs no hand: from recordings, from a folder, a sample."""
    column.label(text="I have recordings of pressure", icon="VIEWZOOM")
    column.operator("thenar.new_study", text="New Study from Files...", icon="FILE_NEW")
    column.operator("thenar.load_recording", text="Load Recording or Study...", icon="MESH_GRID")
    column.operator_menu_enum("thenar.sample_study", "kind", text="Sample Study")


def draw_sizes(layout, context):
    """The product's size, and the hand's; in place of a size that is not believed, the ways out.

    Returns whether the size is believed.
    """
    settings = context.scene.thenar
    parts = product_parts(settings)
    if not parts:
        return True
    measured = sizes.glance(context.scene, settings.hand, parts)
    size = sizes.length(measured.product_mm)
    if not measured.factors:
        row = layout.row()
        row.active = False
        row.label(
            text=both(measured) if settings.hand is not None else iface("Product {size}", size=size),
            icon="DRIVER_DISTANCE",
        )
        return True
    box = layout.box().column(align=True)
    if settings.hand is None:
        others = [sizes.length(factor * measured.product_mm) for factor in measured.factors]
        words = "Is the product {size} long, or {other}?" if len(others) == 1 else "Is the product {size} long?"
        text.alert(box, context, iface(words, size=size, other=others[0]))
    else:
        text.alert(box, context, iface("{sizes}: read in the wrong unit?", sizes=both(measured)))
    for factor in measured.factors:
        right = sizes.length(factor * measured.product_mm)
        box.operator(
            "thenar.scale_product", text=iface("Scale by {factor:.4g}, to {size}", factor=factor, size=right)
        ).factor = factor
    box.operator("thenar.accept_size", text=iface("Keep size {size}", size=size))
    return False


def both(measured):
    """The sizes of hand and product in the user's language."""
    hand, product = sizes.length(measured.hand_mm), sizes.length(measured.product_mm)
    return iface("Hand {hand}, product {product}", hand=hand, product=product)


def draw_add(layout):
    """The button that reads the product's file, to press next."""
    row = layout.row()
    row.scale_y = BIG
    row.operator("thenar.add_product", text="Add Product...", icon="IMPORT")


def _draw_sample(column, context):
    column.label(text="Try a sample", icon="SCENE_DATA")
    text.faint(column, context, "A held bottle, ready to solve")
    row = column.row()
    row.scale_y = BIG
    row.operator("thenar.add_sample", text="Try a Sample", icon="PLAY").kind = "held_bottle"
    column.operator_menu_enum("thenar.add_sample", "kind", text="Other Samples")


def _draw_product(column, context):
    settings = context.scene.thenar
    column.label(text="I have a product: make me a hand", icon="MESH_CYLINDER")
    if not product_parts(settings):
        draw_add(column)
        text.faint(column, context, "STL, OBJ, PLY, GLB, USD, FBX; or choose an object of the scene:")
        column.prop(settings, "product", text="")
        return
    chosen = settings.product_collection if settings.product is None else settings.product
    row = column.row(align=True)
    row.label(text=chosen.name, icon="CHECKMARK")
    row.operator("thenar.add_product", text="", icon="IMPORT")
    if not draw_sizes(column, context):
        return
    row = column.row()
    row.scale_y = BIG
    row.operator("thenar.make_hand", text="Make Hand", icon="VIEW_PAN")


def _draw_hand(column, context):
    settings = context.scene.thenar
    column.label(text="I have a hand: pick it", icon="VIEW_PAN")
    column.operator("thenar.add_hand", text="Add Hand from File...", icon="IMPORT")
    if bpy.ops.thenar.pick.poll():
        row = column.row()
        row.scale_y = BIG
        row.operator("thenar.pick", text="Use Selected Hand and Product", icon="RESTRICT_SELECT_OFF")
    elif bpy.ops.thenar.pick_hand.poll() and context.object not in product_parts(settings):
        row = column.row()
        row.scale_y = BIG
        words = iface("Use '{name}'", name=context.object.name[:_LONGEST])
        row.operator("thenar.pick_hand", text=words, icon="RESTRICT_SELECT_OFF")
    else:
        text.faint(column, context, "GLB, FBX, USD, .blend; or click or choose a mesh of the scene:")
    column.prop(settings, "hand", text="")
