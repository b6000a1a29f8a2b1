"""Frames as a film: MP4 where Blender has FFmpeg, else numbered PNG."""

import shutil
import tempfile
from contextlib import contextmanager
from pathlib import Path

import bpy

from ..results import export
from ..scene.checks import Refusal
from . import order as orders


def written(order, rate, draw_frames):
    """Write what `draw_frames(folder)` draws, paths of PNG, to where the order wants it. Returns the paths.

    `rate`: frames a second. Raises `Refusal` where the files cannot be written.
    """
    target = orders.targets(order)[0]
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix="thenar-", ignore_cleanup_errors=True) as folder:
            frames = draw_frames(Path(folder))
            if not has_ffmpeg():
                return [_put(frame, target.with_name(f"{target.stem}-{frame.name}")) for frame in frames]
            return [_put(filmed(frames, rate), target)]
    except OSError as error:
        raise Refusal(f"'{target}' cannot be written ({error.strerror}); choose another folder") from None


def has_ffmpeg():
    """Whether this Blender writes films."""
    return bool(bpy.app.build_options.codec_ffmpeg)


def _put(made, target):
    export.replace_file(target, lambda partial: shutil.copyfile(made, partial))
    return target


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
