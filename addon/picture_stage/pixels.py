"""Pixels as files: what is painted goes out as PNG by Blender."""

import bpy
import numpy as np


def save_png(path, pixels):
    """Write pixels (rows from below, columns, 3), sRGB, as PNG of 8 bits."""
    height, width = pixels.shape[:2]
    image = bpy.data.images.new("Thenar Picture", width, height)
    try:
        full = np.ones((height, width, 4), np.float32)
        full[..., :3] = pixels
        image.pixels.foreach_set(full.ravel())
        image.filepath_raw, image.file_format = str(path), "PNG"
        image.save()
    finally:
        bpy.data.images.remove(image)
