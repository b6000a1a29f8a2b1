"""The reference solve where strain is small: a ball on a bonded layer, against the Hankel solve.

At finite strain it is held against finite elements of another program: `cargo test -p thenar-reference --test pads`.
"""

import numpy as np
import pytest
import thenar

from proof import meshes, pressing
from proof.theory import layer_theory

THICKNESS_MM = 5.0
RADIUS_MM = 40.0
DEEP_AS_A_SHARE = 0.03


def test_a_shallow_press_of_a_ball_on_a_bonded_layer():
    depth = DEEP_AS_A_SHARE * THICKNESS_MM
    edges = np.linspace(0.0, 1.6 * np.sqrt(2.0 * RADIUS_MM * depth), 121)
    expected, _, radius = layer_theory.press(
        lambda r: RADIUS_MM - np.sqrt(RADIUS_MM**2 - r * r) - depth,
        edges,
        pressing.SHEAR_MODULUS,
        0.5,
        THICKNESS_MM,
    )
    vertices, triangles = meshes.graded_patch(4.0 * THICKNESS_MM, radius / 8.0, 5.0)
    ball = meshes.sphere(RADIUS_MM, (0.0, 0.0, RADIUS_MM - depth), 2.0 * radius, radius / 12.0)
    found = thenar.reference_press(
        vertices,
        triangles,
        vertices - [0.0, 0.0, THICKNESS_MM],
        np.full(len(vertices), pressing.SHEAR_MODULUS),
        *ball,
        held=(np.linalg.norm(vertices, axis=1) > 3.9 * THICKNESS_MM).tolist(),
        layers=8,
        bulk_ratio=1000.0,
    )
    force = found.total_force_n[2]
    radius_found = np.sqrt(found.contact_area_mm2 / np.pi)
    print(f"force {force / expected - 1.0:+.2%}, radius {radius_found / radius - 1.0:+.2%} of the Hankel solve's")
    assert force == pytest.approx(expected, rel=0.02)
    assert radius_found == pytest.approx(radius, rel=0.04)
    assert found.penetration_mm < 0.011
