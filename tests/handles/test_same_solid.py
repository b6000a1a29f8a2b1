"""One solid modeled in two ways bears the same contact: parts and Blender's union of them, open and closed sticks.

Hand, place and overlap are the same for both; the second model of each pair shares nothing with the library's readings.
"""

import bpy
import numpy as np
import pytest
import thenar

SIDES = 48
PLACE = np.array([-18.0, 55.0, 0.0])
"""Above the hollow of the palm, clear of the thumb, mm."""
OPEN_ENDS = (-150.0, 42.0)
"""The open end lies beyond the hand, where what is open cannot matter."""


@pytest.fixture(scope="module")
def skin():
    made = thenar.hand(percentile=50)
    kinds = {"finger": thenar.Material.finger_layer(), "palm": thenar.Material.palm_layer()}
    materials = [kinds[kind] for kind in made["kind"]]
    skin = thenar.Skin(made["vertices_mm"], made["triangles"], made["regions"], materials)
    return skin, np.asarray(made["vertices_mm"])[np.asarray(made["regions"]) >= 0]


def rod(radius, ends, is_closed=True):
    """A rod along x between two places; without its first end if it is not closed."""
    angle = 2.0 * np.pi * np.arange(SIDES) / SIDES
    ring = np.stack([np.zeros(SIDES), radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    places = np.linspace(*ends, 31)
    vertices = np.concatenate([ring + [x, 0.0, 0.0] for x in places] + [[[places[0], 0, 0], [places[-1], 0, 0]]])
    k, after, last = np.arange(SIDES), (np.arange(SIDES) + 1) % SIDES, 30 * SIDES
    rows = [np.stack([r * SIDES + k, r * SIDES + after, (r + 1) * SIDES + after], 1) for r in range(30)]
    rows += [np.stack([r * SIDES + k, (r + 1) * SIDES + after, (r + 1) * SIDES + k], 1) for r in range(30)]
    near = np.stack([np.full(SIDES, len(vertices) - 2), after, k], 1)
    far = np.stack([np.full(SIDES, len(vertices) - 1), last + k, last + after], 1)
    triangles = np.concatenate([*rows, *([near] if is_closed else []), far])
    return vertices, triangles


def turned(mesh, degrees, offset=(0.0, 0.0, 0.0)):
    """A mesh turned about z and moved."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return mesh[0] @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) + offset, mesh[1]


def joined(meshes):
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in meshes)])
    vertices = np.concatenate([vertices for vertices, _ in meshes])
    return vertices, np.concatenate([faces + start for (_, faces), start in zip(meshes, starts, strict=False)])


def by_blender(meshes):
    """The union of closed meshes by Blender's exact Boolean."""
    bpy.ops.wm.read_homefile(use_empty=True)
    objects = []
    for vertices, triangles in meshes:
        mesh = bpy.data.meshes.new("part")
        mesh.from_pydata(vertices.tolist(), [], triangles.tolist())
        objects.append(bpy.data.objects.new("part", mesh))
        bpy.context.collection.objects.link(objects[-1])
    for other in objects[1:]:
        modifier = objects[0].modifiers.new("union", "BOOLEAN")
        modifier.operation, modifier.solver, modifier.object = "UNION", "EXACT", other
    bpy.context.view_layer.update()
    shown = objects[0].evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    shown.calc_loop_triangles()
    vertices = np.array([vertex.co for vertex in shown.vertices], dtype=float)
    return vertices, np.array([triangle.vertices for triangle in shown.loop_triangles])


def pressed(skin, mesh, up_mm):
    skin, _ = skin
    contact = skin.press(mesh[0] + [0.0, 0.0, up_mm], mesh[1])
    return np.asarray(contact.pressure_mpa), contact.contact_area_mm2, np.asarray(contact.displacement_mm)


def height(skin, mesh, overlap_mm):
    """How high the mesh lies with this overlap on the palm, which faces up; by bisection on plain distances."""
    low, high = 0.0, 150.0
    for _ in range(30):
        middle = (low + high) / 2
        gap = thenar.Product(mesh[0] + [0.0, 0.0, middle], mesh[1]).gap_mm(skin[1])["gap_mm"]
        low, high = (low, middle) if np.nanmin(gap) > -overlap_mm else (middle, high)
    return low


def compare(skin, one, other, up_mm):
    (pressure, area, moved), (wanted, wanted_area, wanted_moved) = (pressed(skin, mesh, up_mm) for mesh in (one, other))
    assert wanted.max() > 0.01
    assert area == pytest.approx(wanted_area, rel=0.01)
    assert np.abs(pressure - wanted).max() < 0.02 * wanted.max()
    assert np.abs(moved - wanted_moved).max() < 0.05


@pytest.mark.parametrize("degrees", [90.0, 60.0, 35.0])
@pytest.mark.parametrize("radius", [9.0, 13.0])
def test_parts_that_overlap_are_the_solid_that_blender_unites(skin, degrees, radius):
    parts = [
        turned(rod(15.0, (-42.0, 42.0)), 8.0, PLACE),
        turned(rod(radius, (-40.0, 40.0)), 8.0 + degrees, PLACE + [3.0, 2.0, radius - 15.0]),
    ]
    united = by_blender(parts)
    compare(skin, joined(parts), united, height(skin, united, 7.0))


@pytest.mark.parametrize("degrees", [40.0, 65.0, 90.0])
@pytest.mark.parametrize("overlap", [4.0, 7.0])
def test_stick_without_an_end_is_pressed_as_one_with_it(skin, degrees, overlap):
    closed = turned(rod(12.0, OPEN_ENDS), degrees, PLACE)
    hollow = turned(rod(12.0, OPEN_ENDS, is_closed=False), degrees, PLACE)
    compare(skin, hollow, closed, height(skin, closed, overlap))
