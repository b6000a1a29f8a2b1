"""An unrolled cylinder is a rectangle: lengths along and around it are those of the closed form."""

import bpy
import numpy as np
import pytest
from thenar_blender.picture_sets import unrolled
from thenar_blender.picture_stage import laying
from thenar_blender.scene.checks import Refusal

RADIUS, HEIGHT = 24.0, 120.0
HALF = np.radians(40.0)
"""Half of the angle that is pressed, about the direction 2 radians from x."""
MIDDLE = 2.0


def subject(pressed=True):
    """A cylinder along z, pressed at mid height over an angle of 80 degrees."""
    bpy.ops.mesh.primitive_cylinder_add(vertices=360, radius=RADIUS * 1e-3, depth=HEIGHT * 1e-3)
    mesh = bpy.context.object.data
    value = np.where((np.abs(angles(mesh)) < HALF) & pressed, 50.0, 0.0)
    mesh.attributes.new("pressure_kpa", "FLOAT", "POINT").data.foreach_set("value", value)
    mesh.attributes.new("contact_edge_mm", "FLOAT", "POINT").data.foreach_set("value", np.where(value > 0, 5.0, -5.0))
    solid = laying.Solid(mesh, np.eye(4), "product", True)
    return laying.Subject(None, None, [solid], [], 1000.0)


def angles(mesh):
    """Of every vertex about z, from the middle of what is pressed."""
    points = np.array([vertex.co for vertex in mesh.vertices])
    return (np.arctan2(points[:, 1], points[:, 0]) - MIDDLE + np.pi) % (2 * np.pi) - np.pi


def test_lengths_around_and_along_are_kept():
    flat, radius = unrolled.unrolled(subject(), np.array([0.0, 0.0, 1.0]))
    points = flat.points_mm(1000.0)
    assert radius == pytest.approx(RADIUS, rel=1e-4)
    assert np.ptp(points[:, 0]) == pytest.approx(2 * np.pi * RADIUS, rel=0.01)
    assert np.ptp(points[:, 1]) == pytest.approx(HEIGHT, rel=1e-4)
    pressed = points[flat.field("pressure_kpa") > 0.0]
    assert np.ptp(pressed[:, 0]) == pytest.approx(2 * HALF * RADIUS, rel=0.02)
    assert pressed[:, 0].mean() == pytest.approx(0.0, abs=1.0), "the seam is opposite of what is pressed"


def test_it_is_seen_from_outside():
    """Seen from outside with z up, what stands at a larger angle about z stands further right."""
    made = subject()
    mesh = made.product[0].mesh
    off = angles(mesh)
    marks = np.where((off > 0.1) & (off < HALF), 80.0, np.where((off < -0.1) & (off > -HALF), 79.0, 0.0))
    mesh.attributes["pressure_kpa"].data.foreach_set("value", marks)
    flat, _ = unrolled.unrolled(made, np.array([0.0, 0.0, 1.0]))
    places, value = flat.points_mm(1000.0)[:, 0], flat.field("pressure_kpa")
    assert places[value == 80.0].mean() > 0.0 > places[value == 79.0].mean()


def test_nothing_pressed_is_refused():
    with pytest.raises(Refusal, match="nothing presses on the product"):
        unrolled.unrolled(subject(pressed=False), np.array([0.0, 0.0, 1.0]))
