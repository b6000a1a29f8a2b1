"""Makes the pictures of the pose library: each pose of the median hand, from the palm, by Cycles, without a window."""

import json
from pathlib import Path

import bpy

from ..hand import build
from ..hand.poses import LABELS
from ..hand_bones import posing
from ..hand_look import studio
from ..picture_stage.stage import can_denoise
from . import actions, library

SIZE = 192
SAMPLES = 64
EYE_MM = (230.0, -60.0, 480.0)
TARGET_MM = (8.0, 78.0, 12.0)
LENS_MM = 78.0


def render(folder):
    """Write a picture of every pose, and of what they are made, to `folder`; the open file is replaced."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    context = bpy.context
    scene = context.scene
    hand, rig = build.add_hand(context, build.make())
    scene.thenar.hand = hand
    rig.hide_render = True
    camera = studio.frame(context, TARGET_MM, EYE_MM, LENS_MM)
    studio.light(context, camera, TARGET_MM)
    studio.render_settings(scene)
    scene.cycles.samples, scene.cycles.use_denoising = SAMPLES, can_denoise(scene.cycles)
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.film_transparent = True
    scene.render.image_settings.file_format, scene.render.image_settings.color_mode = "PNG", "RGBA"
    scene.render.image_settings.compression = 100
    scene.view_settings.view_transform = "Standard"
    for name in LABELS:
        posing.apply_pose(context, hand, name)
        scene.render.filepath = str((folder / f"{name}.png").resolve())
        bpy.ops.render.render(write_still=True)
        print(f"thenar: {folder / f'{name}.png'}", flush=True)
    text = json.dumps({name: actions.digest(name) for name in LABELS}, indent=1)
    (folder / library.STAMPS).write_text(text + "\n", "utf-8")
