"""The film *Turntable*: hand and product turn once in 4 s; the product is drawn clear, so that the map shows."""

import shutil
import tempfile
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np

from .. import export
from ..hand import studio
from ..picture_stage import page, pixels, stage, views
from ..scene.checks import Refusal
from . import grip_and_print
from . import order as orders

SECONDS = 4
_TURN = (60.0, 128.0, 1800.0, 750.0)
_CLEAR = (0.90, 0.94, 0.95, 1.0)


def draw(order, subject, context):
    """Write the film, or without FFmpeg its frames as numbered PNG. Returns the paths. Raises `Refusal`."""
    target = orders.targets(order)[0]
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix="thenar-", ignore_cleanup_errors=True) as folder:
            frames = _frames(order, subject, context, Path(folder))
            if not has_ffmpeg():
                return [_put(frame, target.with_name(f"{target.stem}-{frame.name}")) for frame in frames]
            return [_put(filmed(frames, order.rate), target)]
    except OSError as error:
        raise Refusal(f"'{target}' cannot be written ({error.strerror}); choose another folder") from None


def has_ffmpeg():
    """Whether this Blender writes films."""
    return bool(bpy.app.build_options.codec_ffmpeg)


def _put(made, target):
    export.replace_file(target, lambda partial: shutil.copyfile(made, partial))
    return target


def _frames(order, subject, context, folder):
    """The frames as PNG in `folder`. Returns their paths."""
    for part in subject.product:
        part.mesh.materials.clear()
        part.mesh.materials.append(studio.clear("Thenar Picture Clear", _CLEAR))
    view, number, paths = views.of_grip(context, subject), SECONDS * order.rate, []
    pivot, window, floor = _whole(order, subject, view)
    for frame in range(number):
        turned = _about_up(2.0 * np.pi * frame / number) @ view
        middle = turned @ pivot
        shown = stage.Window((middle[0], window.middle[1]), window.mm, window.size)
        shot = stage.Shot(context.scene.thenar, subject.gripped(), turned, shown, subject.scale, samples=order.samples)
        shot.floor_mm = middle[2] - floor
        shot.on_progress = orders.Progress(order).part(frame, number)
        sheet = page.Page(grip_and_print.WIDTH, grip_and_print.HEIGHT, stage.PAGE)
        sheet.picture(_TURN, stage.take(shot))
        grip_and_print.head(sheet, context, order.is_stale)
        sheet.text((960.0, 52.0, "center"), 22.0, "The product is drawn clear", page.FAINT)
        page.add_scale_bar(sheet, (grip_and_print.MARGIN, 52.0), window.mm * order.factor, 220.0)
        page.add_legend(sheet, context.scene.thenar, grip_and_print.LEGEND)
        paths.append(folder / f"{frame + 1:04}.png")
        pixels.save_png(paths[-1], page.painted(sheet, order.factor))
    return paths


def _about_up(angle):
    """A turn (3, 3) about the view's up."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])


def _whole(order, subject, view):
    """The pivot (3,), mm, a window that shows the whole turn, and how far the sheet lies behind the pivot, mm."""
    shown = grip_and_print.near(subject, subject.gripped(), view)
    seen = shown @ view.T
    middle = (seen.min(axis=0) + seen.max(axis=0)) / 2.0
    around = np.hypot(seen[:, 0] - middle[0], seen[:, 2] - middle[2]).max()
    corners = np.array([[x, y, 0.0] for x in (-around, around) for y in (seen[:, 1].min(), seen[:, 1].max())])
    size = tuple(round(value * order.factor) for value in _TURN[2:])
    window = stage.framing(corners + [middle[0], 0.0, 0.0], np.eye(3), size, fill=0.86)
    depth = max(
        float(np.linalg.norm(solid.points_mm(subject.scale) - view.T @ middle, axis=1).max())
        for solid in subject.gripped()
    )
    return view.T @ middle, window, depth


def filmed(frames, rate):
    """The PNG `frames` as an MP4 film (H.264) of so many a second in their folder. Returns its path."""
    path = frames[0].with_name("film.mp4")
    with _film_scene(frames, rate) as scene:
        scene.render.filepath = str(path)
        bpy.ops.render.render(scene=scene.name, animation=True)
    return path


@contextmanager
def _film_scene(frames, rate):
    scene = bpy.data.scenes.new("Thenar Film")
    try:
        editor = scene.sequence_editor_create()
        strips = editor.strips if hasattr(editor, "strips") else editor.sequences
        strip = strips.new_image("Film", str(frames[0]), 1, 1)
        for frame in frames[1:]:
            strip.elements.append(frame.name)
        if hasattr(strip, "frame_final_duration"):
            strip.frame_final_duration = len(frames)
        image = bpy.data.images.load(str(frames[0]))
        render = scene.render
        render.resolution_x, render.resolution_y = (size - size % 2 for size in image.size)
        bpy.data.images.remove(image)
        render.resolution_percentage, render.fps, render.fps_base = 100, rate, 1.0
        scene.frame_start, scene.frame_end = 1, len(frames)
        if hasattr(render.image_settings, "media_type"):  # Blender 5.0 and later
            render.image_settings.media_type = "VIDEO"
        render.image_settings.file_format = "FFMPEG"
        render.ffmpeg.format, render.ffmpeg.codec = "MPEG4", "H264"
        render.ffmpeg.constant_rate_factor, render.ffmpeg.gopsize = "HIGH", 12
        render.ffmpeg.audio_codec = "NONE"
        render.use_sequencer, render.use_file_extension = True, False
        scene.view_settings.view_transform = "Standard"
        yield scene
    finally:
        bpy.data.scenes.remove(scene)
