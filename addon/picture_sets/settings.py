"""Blender properties of pictures: where they are put and how large they are."""

import bpy
from bpy.props import BoolProperty, IntProperty, StringProperty

from . import order


class ThenarPictures(bpy.types.PropertyGroup):
    """`scene.thenar_pictures`: what every picture of the scene has in common."""

    folder: StringProperty(
        name="Folder",
        description="Where pictures are put; // is the folder of the file. Existing files are never replaced",
        subtype="DIR_PATH",
        default="//thenar_pictures/",
    )
    height: IntProperty(
        name="Height (pixels)",
        description="Height of a picture, pixels; pictures are 16 wide to 9 high, cards are A4",
        min=order.LEAST,
        max=order.MOST,
        default=1080,
    )
    with_percentiles: BoolProperty(
        name="5th, 50th, 95th Percentile",
        description="On a comfort card, hands of three sizes grasp the product and are solved: takes minutes more",
    )
    film_frames: IntProperty(
        name="Film Frames",
        description="Most frames of a Live Film, from the scene's first frame on; 48 are 2 s at 24 a second",
        min=2,
        max=2000,
        default=48,
    )


CLASSES = (ThenarPictures,)
