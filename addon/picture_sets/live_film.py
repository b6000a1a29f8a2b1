"""The film *Live Film*: the scene's animation, every frame solved, seen through the product; its numbers run along.

Bakes the frames in a copy of the file in a folder of its own, so that nothing is written next to the user's file.
"""

import contextlib
import tempfile
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import bpy
import numpy as np

from .. import names, native, steps
from ..picture_stage import facts, laying, page, pixels, stage, views
from ..scene import baked
from ..scene.checks import Refusal
from ..timeline import baking
from . import film, grip_and_print, turntable
from . import order as orders

_SOLVING = 0.2
"""Share of the time that goes into the contacts."""
_FILM = (60.0, 128.0, 1200.0, 770.0)
_CURVES = ((1330.0, 560.0, 526.0, 250.0), (1330.0, 200.0, 526.0, 250.0))
_THROUGH, _AHEAD, _ACROSS = 0.52, 0.78, -0.34
"""The view on a contact of one side: through the product, from ahead of the fingertips, away from the thumb."""
_ONE_SIDED = 0.6
"""Least share of the forces that points one way for that view; else the view is that of Grip and Print."""
_ROOM, _LEAST_MM = 2.2, 62.0
"""Width of what is shown over that of all contacts, and the least, mm."""
_STILL_MM = 1e-3
_LOOKS = 6
"""Movement below which a scene stands still, and how many frames are looked at for it."""
_FORCE, _AREA, _COMING = (0.78, 0.30, 0.20), (0.25, 0.36, 0.52), (0.86, 0.85, 0.84)


@dataclass(frozen=True)
class _Film:
    """What all frames have in common: numbers by frame, the view (3, 3), the window, and the sheet's height, mm."""

    columns: dict
    view: object
    window: stage.Window
    floor: float


def draw(order, context):
    """Write the film, or without FFmpeg its frames as numbered PNG. Returns the paths.

    Raises `Refusal` where nothing moves, where a frame cannot be solved (the reason names it), or where the files
    cannot be written.
    """
    scene = context.scene
    first, last = scene.frame_start, min(scene.frame_end, scene.frame_start + order.frames - 1)
    _refuse_what_stands_still(context, (first, last))
    rate = int(np.clip(round(scene.render.fps / scene.render.fps_base), 1, 60))
    with tempfile.TemporaryDirectory(prefix="thenar-", ignore_cleanup_errors=True) as folder:
        bpy.ops.wm.save_as_mainfile(filepath=str(Path(folder) / "film.blend"))
        context = bpy.context
        _solve(order, context, (first, last))
        columns = baked.curves(context.scene.thenar.hand)
        shared = _shared(order, context, columns)
        return film.written(order, rate, lambda out: _frames(order, context, shared, out))


def _refuse_what_stands_still(context, span):
    """Refuse a scene whose hand and product are the same, in the same place, in all frames looked at."""
    settings, scene, before, seen = context.scene.thenar, context.scene, context.scene.frame_current, []
    try:
        for frame in np.unique(np.linspace(*span, _LOOKS).round().astype(int)):
            scene.frame_set(int(frame))
            solids = [laying.glimpse(context, obj, "") for obj in _moved(settings)]
            seen.append(np.concatenate([solid.points_mm(1.0) for solid in solids]))
            for solid in solids:
                bpy.data.meshes.remove(solid.mesh)
    finally:
        scene.frame_set(before)
    scale = scene.unit_settings.scale_length * 1000.0
    if any(points.shape != seen[0].shape or np.abs(points - seen[0]).max() * scale > _STILL_MM for points in seen):
        return
    raise Refusal(
        f"nothing moves from frame {span[0]} to {span[1]}, so there is no film; key the hand, its bones or the "
        "product, or add the sample 'Finger rolls on ball'"
    )


def _moved(settings):
    parts = laying.display.workflow.product_parts(settings)
    return [settings.hand, *(part for part in parts if part.type in laying.SURFACES)]


def _solve(order, context, span):
    """Bake the frames, and tell how far it is."""
    under_way = baking.steps(context, *span)

    def watch(text, share):
        order.tell(f"solve, {text}", _SOLVING * share)

    try:
        work = next(under_way)
        while True:
            work = steps.hand_back(under_way, work and (lambda *_, work=work: work(None, watch)))
    except StopIteration:
        return
    except native.error_types() as error:
        raise Refusal(str(error)) from None


def _shared(order, context, columns):
    """The `_Film`: view and window by all contacts, so that the camera stands still."""
    contacts, normals, force, subject = [], [], [], None
    for frame in columns["frame"]:
        context.scene.frame_set(int(frame))
        hand = laying.glimpse(context, context.scene.thenar.hand, "hand")
        weight = hand.field(names.PRESSURE_KPA)
        rows = weight > 0.0
        scale = context.scene.unit_settings.scale_length * 1000.0
        contacts.append(hand.points_mm(scale)[rows])
        normals.append(hand.normals()[rows])
        force.append(weight[rows])
        bpy.data.meshes.remove(hand.mesh)
    contacts, normals, force = (np.concatenate(each) for each in (contacts, normals, force))
    if not len(force):
        raise Refusal("hand and product do not touch in any frame, so there is nothing to film; key them to touch")
    context.scene.frame_set(int(columns["frame"][0]))
    subject = laying.gather(context)
    view = _view(context, subject, (normals * force[:, None]).sum(axis=0) / force.sum())
    whole = np.concatenate([solid.points_mm(subject.scale) for solid in subject.gripped()]) @ view.T
    return _Film(columns, view, _window(order, subject, contacts, view), float(whole[:, 2].min()))


def _view(context, subject, through):
    """The view (3, 3) on the contacts; `through` (3): mean normal of the pressed skin, of length one on a plate."""
    size = np.linalg.norm(through)
    if size < _ONE_SIDED:
        return views.of_grip(context, subject)
    through = through / size
    start, end = subject.opened.points_mm(subject.scale), subject.hand.points_mm(subject.scale)
    count = min(len(start), len(end))
    turned = views.rotation(start[:count], end[:count]) @ views.opened_frame(context, subject).T
    ahead, across = turned[:, 1], turned[:, 0]
    ahead = ahead - through * (ahead @ through)
    ahead /= max(np.linalg.norm(ahead), 1e-9)
    return views.turn(_THROUGH * through + _AHEAD * ahead + _ACROSS * across, -through)


def _window(order, subject, contacts, view):
    size = tuple(round(value * order.factor) for value in _FILM[2:])
    seen = contacts @ view.T
    low, high = seen.min(axis=0)[:2], seen.max(axis=0)[:2]
    all_of_it = stage.framing(grip_and_print.near(subject, subject.gripped(), view), view, size, fill=0.9)
    reach = max(_ROOM * float((high - low).max()), _LEAST_MM)
    if reach / min(size) >= all_of_it.mm:
        return all_of_it
    return stage.Window(tuple((low + high) / 2.0), reach / min(size), size)


def _frames(order, context, shared, folder):
    """The frames as PNG in `folder`. Returns their paths."""
    progress, paths = orders.Progress(order, _SOLVING, 1.0 - _SOLVING), []
    count = len(shared.columns["frame"])
    for number, frame in enumerate(shared.columns["frame"]):
        context.scene.frame_set(int(frame))
        subject = laying.gather(context)
        turntable.draw_clear(subject)
        shot = stage.Shot(
            context.scene.thenar, subject.gripped(), shared.view, shared.window, subject.scale, samples=order.samples
        )
        shot.floor_mm = shared.floor - 1.0
        shot.on_progress = progress.part(number, count, f"render, frame {number + 1} of {count}")
        sheet = page.Page(grip_and_print.WIDTH, grip_and_print.HEIGHT, stage.PAGE)
        sheet.picture(_FILM, stage.take(shot))
        _write(sheet, context, shared, number)
        page.add_scale_bar(sheet, (grip_and_print.MARGIN, 52.0), shared.window.mm * order.factor, 220.0)
        page.add_legend(sheet, context.scene.thenar, grip_and_print.LEGEND)
        paths.append(folder / f"{number + 1:04}.png")
        pixels.save_png(paths[-1], page.painted(sheet, order.factor))
        _forget(subject)
    return paths


def _forget(subject):
    """Remove the meshes of a frame: a film has many."""
    for solid in (*subject.gripped(), subject.opened):
        with contextlib.suppress(ReferenceError):
            bpy.data.meshes.remove(solid.mesh)


def _write(sheet, context, shared, number):
    """Title, the frame's totals, and the curves of force and area up to here."""
    columns, settings, top = shared.columns, context.scene.thenar, sheet.height - grip_and_print.MARGIN
    now = SimpleNamespace(**{name: float(columns[name][number]) for name in ("force_n", "area_mm2", "peak_kpa")})
    x = sheet.width - grip_and_print.MARGIN
    for caption, value in reversed(facts.numbers(now)):
        sheet.text((x, top - 38.0, "right"), 40.0, value)
        sheet.text((x, top - 72.0, "right"), 20.0, caption, page.FAINT)
        x -= 236.0
    title = settings.product.name if settings.product is not None else facts.product_title(settings.result)
    sheet.text((grip_and_print.MARGIN, top - 38.0), page.fitting(title, 50.0, x - grip_and_print.MARGIN), title)
    sheet.text((grip_and_print.MARGIN, top - 78.0), 25.0, facts.hand_title(settings.hand), page.FAINT)
    sheet.text((960.0, 52.0, "center"), 22.0, "Every frame is solved; the product is drawn clear", page.FAINT)
    rows = (("Force, N", columns["force_n"], _FORCE), ("Area, cm²", columns["area_mm2"] / 100.0, _AREA))
    for box, (caption, values, color) in zip(_CURVES, rows, strict=True):
        _add_curve(sheet, box, (caption, np.asarray(values, float), color), number)


def _add_curve(sheet, box, row, number):
    """Columns of a quantity by frame: up to the present one in color, those that come in gray."""
    (x, y, width, height), (caption, values, color) = box, row
    step, most = width / len(values), max(float(values.max()), 1e-9)
    sheet.text((x, y + height + 16.0), 20.0, caption, page.FAINT)
    sheet.text((x + width, y + height + 16.0, "right"), 20.0, f"max. {most:.1f}", page.FAINT)
    for frame, value in enumerate(values):
        drawn = (x + frame * step, y, max(step - 2.0, 0.6 * step), height * max(float(value), 0.0) / most)
        if drawn[3] > 0.0:
            sheet.box(drawn, color if frame <= number else _COMING)
    sheet.box((x, y - 2.0, width, 2.0), page.RULE)
