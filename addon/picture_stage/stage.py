"""The stage of a picture: parts lie on a sheet in soft light, seen straight from above, and are rendered to arrays.

The light is denoised; the map's colors are not rendered but computed from a second pass that holds its values, so that
neither light nor denoiser changes them. Changes the open file: it is called in a file that is thrown away afterwards.
"""

import re
import tempfile
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector

from .. import colormap
from ..skin_display import shading
from . import values

PAGE = (0.957, 0.954, 0.948)
"""Color of the sheet, sRGB: the page's own, so that a picture has no edge."""
SAMPLES, VALUE_SAMPLES = 8, 16
PLAIN = 16
"""Where Blender has no denoiser, the light takes so many times as many rays."""
_SUNS = ((2.5, 0.4, (-0.5, 0.75, 1.15), (1.0, 0.985, 0.96)), (0.75, 1.2, (0.9, -0.1, 0.75), (0.95, 0.97, 1.0)))
"""Strength, W/m2, angle across, radians, direction and color of the lights, in the page's frame."""
_SKY = (0.36, 0.365, 0.375)
_LIGHT_SHARE = 0.85
"""Share of the time that goes into the light."""
_SAMPLE = re.compile(r"Sample (\d+)/(\d+)")
_FEATHER = 0.06
"""Share of a picture's size over which its edge runs into the page."""


@dataclass(frozen=True)
class Window:
    """What a picture shows: the middle (x, y) in the view's frame, mm; mm a pixel; width and height, pixels."""

    middle: tuple
    mm: float
    size: tuple


@dataclass
class Shot:
    """A picture to take: the `look` with palette and range, what is shown, the turn (3, 3) and the window."""

    look: object
    solids: list
    view: object
    window: Window
    scale: float
    """mm per unit."""
    floor_mm: float | None = None
    """Height of the sheet in the view's frame; None: under what lies on it."""
    samples: int = SAMPLES
    perspective: tuple | None = None
    """Height in the view's frame of the plane in which the window's mm hold, and how far above it the eye is, mm; None:
    seen from infinitely far."""
    on_progress: object = field(default=lambda share: None)


def framing(points, view, size, fill=0.94):
    """The `Window` of so many pixels that points (n, 3), world mm, fill as seen in `view` (3, 3)."""
    seen = points @ view.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    mm = max((high[0] - low[0]) / (fill * size[0]), (high[1] - low[1]) / (fill * size[1]))
    return Window(((low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0), float(mm), tuple(size))


def take(shot):
    """The picture as (height, width, 3), sRGB, rows from below."""
    with ExitStack() as undo:
        scene = bpy.data.scenes.new("Thenar Picture")
        undo.callback(bpy.data.scenes.remove, scene)
        placed = _place(scene, shot, undo)
        _set_render(scene, shot)
        sheet = _sheet(scene, shot, undo)
        _light(scene, undo)
        light = _rendered(scene, shot)
        if not any(solid.has_map for solid in shot.solids):
            return _feathered(np.clip(colormap_srgb(light), 0.0, 1.0))
        mapped, bare = values.material(shot.look), values.nothing()
        for obj, solid in placed:
            _bare(obj, mapped if solid.has_map else bare)
            obj.hide_render = solid.kind != "hand" and solid.is_clear()
        _bare(sheet, bare)
        scene.world = values.dark()
        held = _rendered(scene, shot, is_data=True)
        shown = values.laid_over(light, held, shot.look)
    return _feathered(np.clip(colormap_srgb(shown), 0.0, 1.0))


def colormap_srgb(linear):
    """Scene-linear to sRGB."""
    low = np.maximum(linear, 0.0)
    return np.where(low <= 0.0031308, 12.92 * low, 1.055 * low ** (1.0 / 2.4) - 0.055)


def _place(scene, shot, undo):
    turned = np.eye(4)
    turned[:3, :3] = shot.view
    placed = []
    for solid in shot.solids:
        own = solid.mesh.copy()  # its materials are exchanged for the second pass
        undo.callback(bpy.data.meshes.remove, own)
        obj = bpy.data.objects.new("Thenar Picture Part", own)
        obj.matrix_world = Matrix((turned @ solid.matrix).tolist())
        scene.collection.objects.link(obj)
        if solid.has_map:
            shading.show(obj, shot.look, solid.kind == "hand")
        placed.append((obj, solid))
    data = bpy.data.cameras.new("Thenar Picture Camera")
    undo.callback(bpy.data.cameras.remove, data)
    camera = bpy.data.objects.new("Thenar Picture Camera", data)
    scene.collection.objects.link(camera)
    scene.camera = camera
    low, high = _depth(shot)
    window, reach = shot.window, high - low + 1.0
    width, eye = window.mm * max(window.size), high + reach
    if shot.perspective is None:
        data.type, data.ortho_scale = "ORTHO", width / shot.scale
    else:
        plane, away = shot.perspective
        data.lens, eye, reach = data.sensor_width * away / width, plane + away, reach + away
    data.clip_start, data.clip_end = 0.1 * reach / shot.scale, 20.0 * reach / shot.scale
    camera.location = Vector((*window.middle, eye)) / shot.scale
    return placed


def _depth(shot):
    """Lowest and highest of what is shown, mm, in the view's frame."""
    heights = np.concatenate([solid.points_mm(shot.scale) @ shot.view[2] for solid in shot.solids])
    return float(heights.min()), float(heights.max())


def _sheet(scene, shot, undo):
    floor = _depth(shot)[0] if shot.floor_mm is None else shot.floor_mm
    half, middle = 6.0 * shot.window.mm * max(shot.window.size), shot.window.middle
    corners = [(middle[0] + x * half, middle[1] + y * half, floor) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    data = bpy.data.meshes.new("Thenar Picture Sheet")
    undo.callback(bpy.data.meshes.remove, data)
    data.from_pydata((np.array(corners) / shot.scale).tolist(), [], [(0, 1, 2, 3)])
    data.materials.append(values.matte(colormap.to_linear(PAGE) / _received()))
    sheet = bpy.data.objects.new("Thenar Picture Sheet", data)
    scene.collection.objects.link(sheet)
    return sheet


def _received():
    """What a white sheet reflects of the lights where nothing shades it, (3,)."""
    direct = [
        strength * direction[2] / np.linalg.norm(direction) / np.pi * np.array(color)
        for strength, _, direction, color in _SUNS
    ]
    return np.sum(direct, axis=0) + _SKY


def _light(scene, undo):
    for strength, angle, direction, color in _SUNS:
        data = bpy.data.lights.new("Thenar Picture Light", "SUN")
        undo.callback(bpy.data.lights.remove, data)
        data.energy, data.angle, data.color = strength, angle, color
        light = bpy.data.objects.new("Thenar Picture Light", data)
        light.matrix_world = Vector(direction).to_track_quat("Z", "Y").to_matrix().to_4x4()
        scene.collection.objects.link(light)
    scene.world = values.sky(_SKY)


def _set_render(scene, shot):
    render = scene.render
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y = shot.window.size
    render.resolution_percentage, render.use_file_extension = 100, False
    render.use_compositing = render.use_sequencer = False
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_mode, render.image_settings.color_depth = "RGB", "32"
    scene.cycles.device, scene.cycles.seed = "CPU", 1
    scene.cycles.max_bounces, scene.cycles.diffuse_bounces = 3, 1
    scene.cycles.use_adaptive_sampling, scene.cycles.adaptive_threshold = True, 0.04
    scene.cycles.sample_clamp_indirect = 4.0
    scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = False
    unit = scene.unit_settings
    unit.system, unit.scale_length = "METRIC", shot.scale / 1000.0


def can_denoise(cycles):
    """Whether this Blender has the denoiser, which is then chosen; some builds, as Debian's, come without it."""
    try:
        cycles.denoiser = "OPENIMAGEDENOISE"
    except TypeError:
        return False
    return True


def _rendered(scene, shot, is_data=False):
    """The render as (height, width, 3), scene-linear, rows from below."""
    scene.cycles.samples = min(shot.samples, VALUE_SAMPLES) if is_data else shot.samples
    scene.cycles.use_denoising = not is_data and can_denoise(scene.cycles)
    if not is_data and not scene.cycles.use_denoising:
        scene.cycles.samples *= PLAIN
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "shot.exr"
        scene.render.filepath = str(path)
        with _reporting(shot, (_LIGHT_SHARE, 1.0) if is_data else (0.0, _LIGHT_SHARE)):
            bpy.ops.render.render(scene=scene.name, write_still=True)
        image = bpy.data.images.load(str(path))
        try:
            image.colorspace_settings.name = "Non-Color"
            width, height = image.size
            flat = np.empty(width * height * 4, np.float32)
            image.pixels.foreach_get(flat)
        finally:
            bpy.data.images.remove(image)
    return flat.reshape(height, width, 4)[..., :3]


@contextmanager
def _reporting(shot, shares):
    """Pass on how far a render is, from the first of `shares` to the second."""
    first, last = shares

    def hear(text, *_):
        found = _SAMPLE.search(str(text))
        if found:
            shot.on_progress(first + (last - first) * int(found[1]) / max(int(found[2]), 1))

    bpy.app.handlers.render_stats.append(hear)
    try:
        yield
    finally:
        bpy.app.handlers.render_stats.remove(hear)
    shot.on_progress(last)


def _bare(obj, material):
    """Let the object show this material alone."""
    shading.hide(obj)
    obj.data.materials.clear()
    obj.data.materials.append(material)


def _feathered(picture):
    """The picture whose edge runs into the page, so that what a denoiser leaves there is not seen as a frame."""
    height, width = picture.shape[:2]
    rows, columns = (
        np.clip((0.5 + np.minimum(np.arange(size), np.arange(size)[::-1])) / (_FEATHER * size), 0.0, 1.0)
        for size in (height, width)
    )
    share = np.minimum(rows[:, None], columns[None, :])[..., None]
    share = share * share * (3.0 - 2.0 * share)
    return picture * share + np.array(PAGE) * (1.0 - share)
