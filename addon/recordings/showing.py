"""The look at a recording: its mat in colors on the product, and next to it what the mat would read of the contact.

Both have one range. What is shown is a look as those of the view buttons: hand, product and result stay as they are.
"""

import json
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix

from .. import maps, names, native, status
from ..looks import operators as looks
from ..looks import putting
from ..operators import display
from ..ownership import own
from ..picture_stage import views
from ..product_objects.parts import product_parts
from ..scene import attributes, mesh, units
from ..scene.checks import Refusal
from ..skin_display import colors
from ..views import viewport
from . import comparing, frames, laying, outline, settings

MAT = "MAT"
_MATERIAL = "Thenar Mat Colors"
_RAISED_MM = 0.4
"""How far cells are drawn above the product: the corners of flat cells on a round one would cut into it otherwise."""
_BARE = (0.62, 0.64, 0.68)
"""sRGB of a cell that reads nothing."""
_ROOM = 1.25
"""From one picture to the next, in widths."""
_HEADROOM = 0.18
"""Room for the words above the pictures, as a share of their height."""
_UNDER = 5.0
"""Distance (mm) to the map's edge that cells are given: whole cells are covered by the map, or not."""


@dataclass(frozen=True)
class _Picture:
    """One mat to show: its object's name, what each cell reads (n,), kPa or a share of the range, and its words."""

    name: str
    values: np.ndarray
    text: str


def is_shown(context):
    """Whether the scene shows the look."""
    return putting.kind_shown(context) == MAT


def is_compared(context, item):
    """Whether what the chosen recording would read of the contact is known, for the mat as it lies now."""
    lie, simulated = comparing.simulated.get(context.scene.name, (None, None))
    return simulated is not None and item is not None and lie == laying.lie_of(item)


def put(context, is_turned=True):
    """Show the look, and turn the view to it. Raises `Refusal`, `RecordingError`. Returns the number of pictures."""
    item = settings.chosen(context)
    seat = comparing.seat_of(context)
    lie = laying.lie_of(item)
    mat = laying.lay(lie, seat)
    pictures = _pictures(context, item, np.asarray(mat.area_mm2))
    turn = _turn(lie, seat, (mat, pictures[0].values))
    if context.scene.thenar.hand.thenar.shows_pressure and maps.shown(context.scene.thenar).kind != maps.PRESSURE:
        display.show(context)
    display.solid_colors(context, "VERTEX")
    bodies = _bodies(context)
    points = putting.put_own(context, MAT, lambda home: _build(context, home, (mat, pictures, bodies), turn))
    if is_turned:
        looks.turn_to(context, putting.View(turn, points))
    return len(pictures)


def renew(context):
    """Bring the look to the frame, the range and the colors that are chosen now; another map ends it."""
    item, home = settings.chosen(context), putting.home_of(context)
    if item is None or (maps.shown(context.scene.thenar).kind != maps.PRESSURE and _has_map(context)):
        putting.take_back(context)
        return
    try:
        area = np.frombuffer(bytes.fromhex(home["thenar_areas"]))
        pictures = _pictures(context, item, area)
    except (Refusal, *native.error_types()) as error:
        status.set_last_error(str(error))
        return
    shown = {obj["thenar_picture"]: obj for obj in home.objects if "thenar_picture" in obj}
    if {each.name for each in pictures} != set(shown) or len(area) != len(pictures[0].values):
        put(context, False)
        return
    for each in pictures:
        _color(shown[each.name], each.values[np.isfinite(area)], context.scene.thenar)
    _label(home, pictures, json.loads(home[viewport.LABELS])["places"])


def changed(context):
    """Lay the mat of the look again after its place was changed; where it cannot lie so, the look stays as it was."""
    if context is None or context.scene is None or status.run.stage or not is_shown(context):
        return
    try:
        put(context, False)
    except (Refusal, *native.error_types()) as error:
        status.set_last_error(str(error))


def frame_changed(context):
    """Bring the look to another frame."""
    if context is not None and context.scene is not None and is_shown(context):
        renew(context)


def _has_map(context):
    hand = context.scene.thenar.hand
    return hand is not None and hand.thenar.shows_pressure


def _pictures(context, item, area_mm2):
    """The recorded picture, and the simulated one where it is known for the mat as it lies."""
    values, number = frames.shown(item)
    if item.kind == settings.PRINT:
        return [_Picture("Recorded", _shares(context, values), "Print\ncolors: inked share of a cell")]
    name = "Recorded" if item.frames < 2 else f"Recorded, frame {number + 1} of {item.frames}"
    if frames.map_of(item.path, item.mat).pressure_kpa is None:
        return [_Picture("Recorded", _shares(context, values), f"{name}\nraw counts: colors by share of the largest")]
    out = [_Picture("Recorded", values, f"{name}\n{_numbers(values, area_mm2)}")]
    if is_compared(context, item):
        simulated = comparing.simulated[context.scene.name][1]
        out.append(_Picture("Simulated", simulated, f"Simulated\n{_numbers(simulated, area_mm2)}"))
    return out


def _shares(context, values):
    """Values as shares of the largest, spread over the range of the colors."""
    largest = np.nanmax(values, initial=0.0)
    return values * (context.scene.thenar.range_kpa / largest if largest > 0.0 else 0.0)


def _numbers(values, area_mm2):
    return f"{np.nansum(values * area_mm2) / 1e3:.0f} N, peak {np.nanmax(values, initial=0.0):.0f} kPa"


def _turn(lie, seat, read):
    """The turn (3, 3) of the view: the axis up, and what reads most towards the eye."""
    mat, values = read
    number, sign = laying.axis_of(lie.axis)
    axis, other = sign * seat.axes[:, number], seat.axes[:, (number + 1) % 3]
    if lie.on != "CYLINDER":
        return views.turn(axis, other)
    weighted = np.nan_to_num(np.asarray(mat.normal) * values[:, None]).sum(axis=0)
    weighted -= axis * (weighted @ axis)
    return views.turn(weighted if np.linalg.norm(weighted) > 1e-9 else other, axis)


def _build(context, home, shown, turn):
    """Add the product once for each picture, with the mat's cells on it. Returns the corners (n, 3), units."""
    (mat, pictures, bodies), scale = shown, units.mm_per_unit(context.scene)
    is_placed = np.isfinite(np.asarray(mat.area_mm2))
    raised = np.asarray(mat.normal)[is_placed][:, None] * _RAISED_MM
    corners = (outline.corners(mat, is_placed) + raised).reshape(-1, 3) / scale
    points = np.concatenate([corners, *(at for _, _, at in bodies)])
    step = turn[0] * (_ROOM * np.ptp(points @ turn[0]))
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    top = middle + turn[1] * ((points @ turn[1]).max() - middle @ turn[1])
    for place, each in enumerate(pictures):
        moved = Matrix.Translation((place * step).tolist())
        for name, body, _ in bodies:
            data = body if place == 0 else body.copy()
            _object(home, (f"{name} (view)", data), moved, name)
        obj = _object(home, (f"{outline.NAME} {each.name}", outline.mesh_of(corners)), moved, outline.NAME)
        obj["thenar_picture"] = each.name
        obj.data.materials.append(_material())
        _color(obj, each.values[is_placed], context.scene.thenar)
    home["thenar_areas"] = np.asarray(mat.area_mm2, float).tobytes().hex()
    _label(home, pictures, [(top + place * step).tolist() for place in range(len(pictures))])
    words = top + turn[1] * (_HEADROOM * np.ptp(points @ turn[1]))
    return np.concatenate([[words], *(points + place * step for place in range(len(pictures)))])


def _bodies(context):
    """The product's parts as `_bare` gives them, where they stand without Thenar's own move."""
    settings, parts = context.scene.thenar, product_parts(context.scene.thenar)
    with own.without_own_output(context, settings.hand, parts):
        return [_bare(context, part) for part in parts if part.type in putting.SURFACES]


def _bare(context, part):
    """Name, mesh in the world without colors, and its points (n, 3), units, of a part of the product."""
    still = putting.still(context, part)
    still.transform(part.matrix_world)
    for name in [each.name for each in still.color_attributes]:
        still.color_attributes.remove(still.color_attributes[name])
    still.materials.clear()
    return part.name, still, mesh.positions(still)


def _object(home, named, matrix, copy_of):
    obj = bpy.data.objects.new(*named)
    obj.matrix_world = matrix
    obj.thenar.copy_of = copy_of
    obj.hide_select = obj.hide_render = True
    home.objects.link(obj)
    return obj


def _color(obj, values, look):
    """Color every cell by what it reads, with the range and the colors of the pressure."""
    kpa = np.repeat(np.nan_to_num(np.asarray(values, float)), 4)
    edge = np.where(kpa > 0.0, _UNDER, -_UNDER)
    tinted = colors.linear((kpa, edge), look, colors.ground(obj, _BARE))
    for name, kind, data in (
        (names.PRESSURE_KPA, "FLOAT", kpa),
        (names.EDGE_MM, "FLOAT", edge),
        (names.COLOR, "FLOAT_COLOR", tinted),
    ):
        attributes.write(obj.data, name, kind, data)
    obj.data.color_attributes.active_color_index = max(obj.data.color_attributes.find(names.COLOR), 0)
    obj.data.update()


def _material():
    """Glows in the cells' own colors, for Material Preview; Solid view takes them from the mesh."""
    material = bpy.data.materials.get(_MATERIAL)
    if material is None:
        material = bpy.data.materials.new(_MATERIAL)
        if material.node_tree is None:
            material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        color, light = tree.nodes.new("ShaderNodeAttribute"), tree.nodes.new("ShaderNodeEmission")
        color.attribute_name = names.COLOR
        tree.links.new(color.outputs["Color"], light.inputs["Color"])
        tree.links.new(light.outputs["Emission"], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material


def _label(home, pictures, places):
    """Put the words of each picture above it, for the drawing of the 3D view."""
    has_legend = "\ncolors:" not in pictures[0].text and "raw counts" not in pictures[0].text
    texts = [each.text for each in pictures]
    home[viewport.LABELS] = json.dumps({"places": places, "texts": texts, "has_legend": has_legend})


def register():
    """The look follows range, colors, frame and place."""
    putting.renewed_by[MAT] = renew
    settings.placed.append(changed)
    settings.framed.append(frame_changed)


def unregister():
    """It follows no more, and nothing is kept."""
    del putting.renewed_by[MAT]
    settings.placed.remove(changed)
    settings.framed.remove(frame_changed)
    comparing.simulated.clear()
