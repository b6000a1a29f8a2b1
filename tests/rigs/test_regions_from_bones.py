"""Regions cut from bones: against the made hand's own, and by laws of shape on other rigs' skins."""

import bodies
import bpy
import numpy as np
import pytest
from kinds import Made, fingers
from rig_scenes import into_scene
from thenar_blender.hand import build
from thenar_blender.hand_bones import bonemap, reading, roles
from thenar_blender.rigging import region_map, regions
from thenar_blender.rigs import skin_regions
from thenar_blender.scene.checks import Refusal

thenar = pytest.importorskip("thenar")


def stripped(context, made):
    """The made hand without its region groups, materials and bone map, bones without their maker's names."""
    hand, rig = build.add_hand(context, made)
    for name in build.group_names(made):
        hand.vertex_groups.remove(hand.vertex_groups[name])
    hand.thenar.materials.clear()
    for k, bone in enumerate(rig.data.bones):
        bone.name = f"Bone.{k:03}"
    bonemap.set_map(rig, {}, "AUTO")
    context.scene.thenar.hand = hand
    context.view_layer.update()
    return hand, rig


@pytest.mark.parametrize("shape", [{}, {"side": "left"}, {"sex": "female", "percentile": 10.0}], ids=str)
def test_as_the_made_hand_has_them(blender, shape):
    """Bones without names and axes: at least 95 % of all vertices get the region that the hand was made with."""
    made = thenar.hand(**shape)
    hand, _ = stripped(bpy.context, made)
    assert bpy.ops.thenar.guess_bones() == {"FINISHED"}
    assert [material.name for material in hand.thenar.materials] == list(skin_regions.NAMES)
    assert tuple(made["region_names"]) == skin_regions.NAMES
    got, want = regions.region_numbers(bpy.context, hand), np.asarray(made["regions"])
    is_skin = (got >= 0) | (want >= 0)
    print(f"{shape}: {(got == want).mean():.3f} of all, {(got == want)[is_skin].mean():.3f} of those in a region")
    assert (got == want).mean() > 0.95
    assert (got == want)[is_skin].mean() > 0.90
    for k, name in enumerate(skin_regions.NAMES):
        both, either = ((got == k) & (want == k)).sum(), ((got == k) | (want == k)).sum()
        assert both > 0.75 * either, name


def test_groups_hold_the_regions_and_other_groups_stay(blender):
    made = thenar.hand()
    hand, _ = stripped(bpy.context, made)
    hand.vertex_groups.new(name="mine").add([1, 2, 3], 0.5, "REPLACE")
    bpy.ops.thenar.guess_bones()
    assert len(hand.thenar.materials) == 0
    assert bpy.ops.thenar.regions_from_bones() == {"FINISHED"}
    numbers = regions.region_numbers(bpy.context, hand)
    for k, name in enumerate(skin_regions.NAMES):
        index = hand.vertex_groups[name].index
        rows = [v.index for v in hand.data.vertices if any(g.group == index and g.weight > 0 for g in v.groups)]
        assert rows == np.flatnonzero(numbers == k).tolist()
    assert "mine" in hand.vertex_groups and hand.thenar.materials["thenar"].preset == "PALM_LAYER"
    assert hand.thenar.materials["index_distal_pad"].preset == "FINGER_LAYER"
    assert bpy.ops.thenar.regions_from_bones() == {"FINISHED"}
    assert len(hand.thenar.materials) == len(skin_regions.NAMES)


def tubes(side, bend=1.0):
    """A hand of tubes, 16 sides around every phalanx and a plate for the palm, on bones named by numbers."""
    made = Made()
    sign = dict(bodies.sides())[side]
    made.builder.add("hand", None, bodies.place_hand(sign, np.zeros(3)))
    fingers(made, side, "hand", lambda d, k: f"{d}{k}", tips=True, points=bodies.hand_points(bend))
    places = {row[0]: row[2] for row in made.builder.rows}
    return made, {
        name: (at, places.get(f"{name[:-1]}{int(name[-1]) + 1}")) for name, at in places.items() if name[-1:].isdigit()
    }


@pytest.mark.parametrize("side", ["right", "left"])
def test_pads_lie_on_the_palms_side_in_the_order_of_digits(blender, side):
    """Arms spread, palms down: every pad's tube is cut on its lower side, nails and back stay free."""
    made, segments = tubes(side)
    hand = tube_scene(made, segments)
    bpy.ops.thenar.guess_bones(with_regions=False)
    truth = made.truth[side]
    assert bonemap.get_map(reading.armature_of(hand)) == truth
    numbers = regions.region_numbers(bpy.context, hand)
    places = np.array([vertex.co for vertex in hand.data.vertices]) * 1000.0
    owner = [hand.vertex_groups[vertex.groups[0].group].name for vertex in hand.data.vertices]
    for digit in ("index", "middle", "ring", "little"):
        for segment in ("middle", "distal"):
            name = truth[f"{digit}_{segment}"]
            mine = np.array([group == name for group in owner])
            pad = mine & (numbers == skin_regions.NAMES.index(f"{digit}_{segment}_pad"))
            back = mine & (numbers == -1)
            assert pad.sum() >= 8 and back.sum() >= 8
            assert places[pad, 2].mean() < places[back, 2].mean() - 5.0, (digit, segment)
    for region in range(len(skin_regions.NAMES)):
        name = skin_regions.NAMES[region]
        if name.endswith("_pad"):
            near = {owner[row].rstrip("0123456789") for row in np.flatnonzero(numbers == region)}
            assert near <= {name.partition("_")[0]}, name


def tube_scene(made, segments):
    """The tubes as a mesh on an armature in metres: 6 rings per segment, radius 8 mm, each vertex on its own bone."""
    hand, rig = into_scene(made)
    mesh = bpy.data.meshes.new("Tubes")
    vertices, faces, owners = [], [], []
    for name, (start, end) in segments.items():
        if end is None:
            continue
        along = (end - start) / np.linalg.norm(end - start)
        one = np.cross(along, [0.3, 0.5, 0.8])
        one /= np.linalg.norm(one)
        two = np.cross(along, one)
        first = len(vertices)
        for ring in range(6):
            for k in range(16):
                angle = 2.0 * np.pi * k / 16
                vertices.append(start + (end - start) * ring / 5 + 8.0 * (np.cos(angle) * one + np.sin(angle) * two))
                owners.append(name)
                if ring:
                    a, b = first + 16 * ring + k, first + 16 * ring + (k + 1) % 16
                    faces.append((a - 16, b - 16, b, a))
    mesh.from_pydata((np.array(vertices) * 0.001).tolist(), [], faces)
    hand.vertex_groups.clear()
    hand.data = mesh
    for name in dict.fromkeys(owners):
        rows = [row for row, owner in enumerate(owners) if owner == name]
        hand.vertex_groups.new(name=name).add(rows, 1.0, "REPLACE")
    bpy.context.view_layer.update()
    return hand


def test_the_map_colors_the_triangles_inside_regions_where_they_are(blender):
    """Every triangle drawn has its three corners in regions, lies on the posed skin, and has its region's color."""
    made = thenar.hand()
    hand, rig = stripped(bpy.context, made)
    bpy.ops.thenar.guess_bones()
    rig.location = (0.5, 0.0, 0.2)
    bpy.context.view_layer.update()
    assert region_map.painted(bpy.context) is None
    assert bpy.ops.thenar.show_regions() == {"FINISHED"}
    corners, tints = region_map.painted(bpy.context)
    numbers = regions.region_numbers(bpy.context, hand)
    triangles = np.asarray(made["triangles"])
    inside = triangles[(numbers[triangles] >= 0).all(axis=1)]
    assert len(corners) == inside.size == len(tints)
    want = np.asarray(made["vertices_mm"])[inside.ravel()] * 0.001 + [0.5, 0.0, 0.2]
    assert np.abs(corners - want).max() < 0.002
    table = region_map.colors(len(skin_regions.NAMES))
    assert len({tuple(color) for color in table}) == len(skin_regions.NAMES)
    assert np.array_equal(tints, table[numbers[inside.ravel()]])
    bpy.ops.thenar.show_regions()
    assert region_map.painted(bpy.context) is None


def test_one_finger_gives_no_regions(blender):
    made = thenar.hand()
    hand, rig = stripped(bpy.context, made)
    bpy.ops.thenar.guess_bones(with_regions=False)
    for role in roles.ROLES:
        if not role.startswith(("index", "wrist")):
            setattr(rig.thenar_bones, role, "")
    rig.thenar_bones.axis = "X"
    before = hand.vertex_groups.keys()
    with pytest.raises(Refusal, match="regions need two fingers with all three bones"):
        regions.from_bones(bpy.context, hand)
    assert hand.vertex_groups.keys() == before and not hand.thenar.materials
