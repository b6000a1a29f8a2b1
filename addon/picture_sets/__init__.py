"""Pictures of a result by one button: drawn in a process of its own, from a copy of the scene."""

import bpy

from .. import workflow
from ..scene.checks import Refusal
from ..terminal import headless
from . import drawing, operators, order, panel, process, settings

_CLASSES = (*settings.CLASSES, *operators.CLASSES, *panel.CLASSES)


def register():
    """Register properties, operators and panel."""
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Scene.thenar_pictures = bpy.props.PointerProperty(type=settings.ThenarPictures)


def unregister():
    """Unregister them again."""
    del bpy.types.Scene.thenar_pictures
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)


def run(options):
    """The command `picture`: open the file and draw. Raises `Refusal`."""
    if not options.order and not (options.kind and options.out):
        raise Refusal("say which picture by --kind, and where to by --out")
    headless.open_file(options.blend)
    context = bpy.context
    if options.order:
        wanted = order.from_text(options.order)
        if context.scene.name != wanted.scene:  # one that this scene refers to was written with it
            context.window.scene = bpy.data.scenes[wanted.scene]
        process.serve(wanted, drawing.draw)
        return
    wanted = order.Order(options.kind.upper(), options.out, options.height, options.samples)
    wanted.with_percentiles, wanted.rate, wanted.frames = options.percentiles, options.rate, options.frames
    wanted.is_stale = workflow.is_out_of_date(context)
    if not options.overwrite:
        order.refuse_to_overwrite(wanted)
    print(f"Wrote {', '.join(map(str, drawing.draw(wanted, context)))}", flush=True)
