"""Makes the picture of an order from the open file, which it changes: call it in a file that is thrown away."""

from pathlib import Path

from ..picture_stage import laying, page, pdf, pixels
from ..results import export
from ..scene.checks import Refusal
from . import card, grip_and_print, live_film, on_glass, turntable, unrolled
from . import order as orders


def draw(order, context):
    """Make the picture and write its files, each whole or not at all. Returns the paths.

    Raises `Refusal` where the scene has no result, or where the files cannot be written.
    """
    orders.check(order)
    if not context.scene.thenar.result.is_valid:
        raise Refusal("there is no result to show; press Solve first")
    order.tell("read", 0.0)
    if order.kind == orders.LIVE:
        return live_film.draw(order, context)
    subject = laying.gather(context)
    if order.kind == orders.TURN:
        return turntable.draw(order, subject, context)
    sheet = _PAGES[order.kind](order, subject, context)
    return _written(order, sheet)


def _written(order, sheet):
    painted, paths = page.painted(sheet, order.factor), []
    for path in orders.targets(order):
        writer = pixels.save_png if path.suffix == ".png" else pdf.save
        content = painted if path.suffix == ".png" else sheet
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            export.replace_file(path, lambda partial, w=writer, c=content: w(partial, c))
        except OSError as error:
            raise Refusal(f"'{path}' cannot be written ({error.strerror}); choose another folder") from None
        paths.append(Path(path))
    return paths


_PAGES = {
    orders.GRIP: grip_and_print.draw,
    orders.CARD: card.draw,
    orders.UNROLLED: unrolled.draw,
    orders.GLASS: on_glass.draw,
}
