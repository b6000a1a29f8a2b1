"""Lists of the panel: materials by region, and the result by region."""

import bpy

from ..languages import iface
from ..results import sentences


class THENAR_UL_materials(bpy.types.UIList):
    """Regions of the skin with their material."""

    def draw_item(self, context, layout, data, item, icon, active_data, active_name):  # noqa: PLR0913 - Blender's
        missing = item.name not in item.id_data.vertex_groups
        split = layout.split(factor=SHARE)
        split.label(text=iface(brief(item.name)), icon="ERROR" if missing else "NONE")
        split.prop(item, "preset", text="", emboss=False)


class THENAR_UL_regions(bpy.types.UIList):
    """Forces and pressures by region; a click on its arrow selects the region's vertices."""

    def draw_item(self, context, layout, data, item, icon, active_data, active_name, index):  # noqa: PLR0913 - Blender's
        split = layout.split(factor=NAME_SHARE)
        row = split.row(align=True)
        pick = row.operator("thenar.select_region", text="", icon="RESTRICT_SELECT_OFF", emboss=False)
        pick.index = index
        row.label(text=iface(brief(item.name)))
        columns(split, item)


SHARE = 0.56
"""Of a row's width, what its name takes."""
FINGER_SHARE = 0.4
"""The same of a finger, whose name is short, so that three digits and their decimal fit at every interface scale."""
NAME_SHARE = 0.5
"""The same in the list of regions, where arrow and scroll bar take room: less cuts "Thumb prox.", more "22.6"."""


def brief(name):
    """A region's name beside its numbers: a sidebar of default width cuts "Thumb proximal" and "Distal palm radial"."""
    return sentences.region_title(name.removesuffix("_pad")).replace("proximal", "prox.").replace("Distal palm", "Palm")


def columns(split, item):
    """The numbers of a region or finger: force, area, peak; faint where nothing presses, red over the threshold."""
    row = split.row()
    row.active = item.force_n > 0.0
    for place, text in enumerate((f"{item.force_n:.1f}", f"{item.area_mm2 / 100:.1f}", f"{item.peak_kpa:.0f}")):
        cell = row.row()
        cell.alignment = "RIGHT"
        cell.alert = place == 2 and item.over_mm2 > 0.0
        cell.label(text=text)


CLASSES = (THENAR_UL_materials, THENAR_UL_regions)
