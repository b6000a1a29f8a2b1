"""The grasp fitter on walls thinner than the press: cups, tubes, cards. Depths are judged by the shape's formula."""

from dataclasses import dataclass

import numpy as np
import pytest
import thenar
from hand_scenes import triangles_of
from thenar_blender.grasp_fit import closing, fitter, walls
from thenar_blender.hand import capsules, pads, poses, products, skinning
from thenar_blender.hand_bones import roles

UPRIGHT = {"axis": (0.0, 0.0, 1.0), "center": (0.0, 0.0, 0.0)}
ALONG = np.linspace(-100.0, 100.0, 101)


def cup(diameter, wall):
    """An open round wall about z, 200 mm high, without bottom or lid."""
    radius = 0.5 * diameter
    corners = [(radius - wall, -100), (radius, -100), (radius, 100), (radius - wall, 100), (radius - wall, -99.99)]
    return products.turned(np.array(corners))


def tube(diameter):
    """The same without any thickness: a sheet."""
    around = np.linspace(0.0, 2.0 * np.pi, 100, endpoint=False)
    ring = 0.5 * diameter * np.column_stack([np.cos(around), np.sin(around)])
    vertices = np.concatenate([np.column_stack([ring, np.full(100, height)]) for height in ALONG])
    here = np.arange(100)
    level = np.stack([here, np.roll(here, -1), np.roll(here, -1) + 100, here + 100], axis=1)
    return vertices, np.concatenate([level + 100 * k for k in range(100)]).tolist()


def posed(arrays, found):
    rig = arrays.rig.moved(found.place)
    return skinning.skin(rig, skinning.pose_matrices(rig, found.angles))


def misses(arrays, found, height):
    """Depth less target per pad, mm, where `height` (n,) is the true distance of the skin from the side it presses."""
    depths = {pad.name: pads.pad_depth(height[pad.rows]) for pad in arrays.pads}
    return np.array([depths[name] - want for name, want in found.targets_mm.items()])


@pytest.mark.parametrize("targets", [pads.LIGHT_MM, pads.FIRM_MM], ids=["light", "firm"])
@pytest.mark.parametrize(
    ("shape", "radius"),
    [(cup(60, 2.0), 30.0), (cup(60, 1.0), 30.0), (cup(100, 2.0), 50.0), (tube(60), 30.0)],
    ids=["60 mm cup, 2 mm", "60 mm cup, 1 mm", "100 mm cup, 2 mm", "60 mm sheet"],
)
def test_cup_is_held_by_its_outside(arrays, shape, radius, targets):
    vertices, faces = shape
    found = fitter.fit(arrays, thenar.Product(vertices, triangles_of(faces)), vertices, fitter.Wish(targets, **UPRIGHT))
    off = misses(arrays, found, np.linalg.norm(posed(arrays, found)[:, :2], axis=1) - radius)
    assert np.median(np.abs(off)) < 0.5
    assert np.abs(off).max() < 2.0
    assert not found.warnings


@dataclass(frozen=True)
class Pinch:
    """The library's pinch: `angles`, the `middle` between the two pads, and the way `across` from thumb to index."""

    angles: np.ndarray
    middle: np.ndarray
    across: np.ndarray
    frame: np.ndarray


@pytest.fixture
def pinch(arrays):
    angles = roles.pose_angles(arrays.rig, arrays.joints, poses.POSES["pinch"])
    points = skinning.skin(arrays.rig, skinning.pose_matrices(arrays.rig, angles))
    at = {pad.name: points[pad.rows].mean(axis=0) for pad in arrays.pads}
    across = at["index_distal_pad"] - at["thumb_distal_pad"]
    across /= np.linalg.norm(across)
    away = at["index_distal_pad"] - at["distal_palm_radial"]
    away -= across * (away @ across)
    away /= np.linalg.norm(away)
    middle = 0.5 * (at["index_distal_pad"] + at["thumb_distal_pad"])
    return Pinch(angles, middle, across, np.stack([np.cross(away, across), away, across]))


def card(thickness, pinch):
    """A card of 60 by 120 mm between the two pads, its edge 10 mm behind them."""
    vertices, faces = products.plate(60.0, 120.0, thickness, 2.0)
    return (vertices + [0.0, 50.0, 0.5 * thickness]) @ pinch.frame + pinch.middle, faces


@pytest.mark.parametrize("depth", [2.6, 3.8])
@pytest.mark.parametrize("thickness", [4.0, 2.0, 0.8])
def test_card_is_pinched_from_both_sides(arrays, pinch, thickness, depth):
    vertices, faces = card(thickness, pinch)
    wish = fitter.Wish({"distal": depth}, ("thumb", "index"), is_placed=True, angles=pinch.angles)
    found = fitter.fit(arrays, thenar.Product(vertices, triangles_of(faces)), vertices, wish)
    height = (posed(arrays, found) - pinch.middle) @ pinch.across
    by_name = {pad.name: pad for pad in arrays.pads}
    index = pads.pad_depth(height[by_name["index_distal_pad"].rows] - 0.5 * thickness)
    thumb = pads.pad_depth(-height[by_name["thumb_distal_pad"].rows] - 0.5 * thickness)
    assert [index, thumb] == pytest.approx([depth, depth], abs=0.5)
    assert not found.warnings


def test_only_thin_products_are_thin():
    solid = [products.cylinder(48), products.cylinder(100), products.bottle(), products.plate(170.0, 330.0, 20.0)]
    thin = [cup(60, 2.0), cup(60, 8.0), products.plate(90.0, 70.0, 2.0)]
    depth = pads.FIRM_MM["palm"]

    def is_thin(shape):
        vertices, faces = shape
        return walls.gauge_of(thenar.Product(vertices, triangles_of(faces)), vertices, depth).is_thin

    assert [is_thin(shape) for shape in solid] == [False] * len(solid)
    assert [is_thin(shape) for shape in thin] == [True] * len(thin)


def test_finger_in_a_wall_is_freed(arrays, pinch):
    """A card across the index finger: the straightened finger stands clear of it."""
    rig = arrays.rig
    ends = capsules.world_ends(arrays.capsules, rig, skinning.pose_matrices(rig, pinch.angles))
    tip = list(arrays.capsules.bones).index(arrays.joints.bones["index_distal"])
    vertices, faces = products.plate(16.0, 16.0, 1.0, 1.0)
    along = (ends[tip, 1] - ends[tip, 0]) / np.linalg.norm(ends[tip, 1] - ends[tip, 0])
    side = np.cross(along, pinch.across) / np.linalg.norm(np.cross(along, pinch.across))
    vertices = vertices @ np.stack([side, np.cross(along, side), along]) + ends[tip].mean(axis=0)
    gauge = walls.gauge_of(thenar.Product(vertices, triangles_of(faces)), vertices, 2.6)

    def is_crossed(angles):
        return gauge.is_crossed(capsules.center_points(arrays.capsules, rig, skinning.pose_matrices(rig, angles)))

    assert is_crossed(pinch.angles)
    freed = closing.clear_fingers(rig, arrays.joints, arrays.capsules, gauge, pinch.angles)
    assert not is_crossed(freed)
    moved = np.flatnonzero(np.abs(freed - pinch.angles).max(axis=1) > 0.0)
    assert [rig.names[bone] for bone in moved] == ["index_proximal"]


def test_finger_that_cannot_reach_its_side_is_told(arrays):
    vertices, faces = products.plate(60.0, 120.0, 0.8, 2.0)
    wish = fitter.Wish({"distal": 2.6}, ("thumb", "index"))
    found = fitter.fit(arrays, thenar.Product(vertices, triangles_of(faces)), vertices, wish)
    assert found.warnings
