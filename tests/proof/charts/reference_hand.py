"""Fast result, reference and their difference on the opened hand of the 48 mm sample, rendered in one picture.

PYTHONPATH=tests target/venv/bin/python tests/proof/charts/reference_hand.py [FILE.jpg]; about two minutes.
"""

import sys
import tempfile
from pathlib import Path

import bpy
import thenar_blender
from thenar_blender import pictures
from thenar_blender.operators import display

ROOT = Path(__file__).parents[3]
PICTURE = ROOT / "addon/docs/pictures/reference_maps.jpg"
SAMPLE = ROOT / "blend-samples/cylinder_48.blend"
SIDES = (400, 342)
"""Width and height of one of the three, pixels."""
MAPS = ("PRESSURE", "REFERENCE", "REFERENCE_DIFFERENCE")


def main(path):
    """Solve, certify, render the three maps next to each other."""
    thenar_blender.register()
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLE))
    bpy.ops.thenar.solve()
    bpy.ops.thenar.certify()
    context = bpy.context
    result = context.scene.thenar.result
    print(f"force {result.force_n:.1f} N, reference {result.reference.force_n:.1f} N")
    context.scene.render.resolution_x, context.scene.render.resolution_y = SIDES
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / f"{kind}.png" for kind in MAPS]
        for kind, picture in zip(MAPS, paths, strict=True):
            display.show(context, kind)
            pictures.render_hand(context, picture)
        joined = Path(folder) / "joined.png"
        pictures.beside(paths, joined)
        save_jpeg(joined, path)


def save_jpeg(picture, path):
    """Write a picture as a JPEG: a render's grain makes a PNG larger than the documents' limit."""
    scene = bpy.context.scene
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format, scene.render.image_settings.quality = "JPEG", 90
    bpy.data.images.load(str(picture)).save_render(str(path), scene=scene)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else PICTURE)
