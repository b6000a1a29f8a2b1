"""Firm power grips of round bars: the forces balance, and none is along the bar, whose side pushes across it alone."""

import numpy as np
import pytest
from bench.hand.cylinder_shares import BALANCED, LENGTH_MM, cylinder

ALONG = 1e-3
"""Share of all forces that may seem to act along the bar: its ring of 96 facets is round to less."""


@pytest.mark.parametrize("diameter", [60, 80])
def test_a_round_bar_is_held_in_balance_by_its_side(blender, scene, diameter):
    """Fits that slid to the bar's end hooked the index finger over its edge, and 7 and 11 % stayed over."""
    scene(cylinder(diameter))
    assert blender.ops.thenar.fit_grasp(kind="POWER") == {"FINISHED"}
    blender.ops.thenar.solve()
    result = blender.context.scene.thenar.result
    push, total = np.array(result.force_vector_n), sum(row.force_n for row in result.regions)
    assert np.linalg.norm(push) <= BALANCED * total
    assert abs(push[2]) <= ALONG * total
    assert np.abs(pressed(blender)[:, 2]).max() < 0.5 * LENGTH_MM - 1.0, "no skin reaches the bar's end"


def pressed(blender):
    """Places (n, 3), mm, of the pressed vertices of the shown hand."""
    from thenar_blender import names

    hand = blender.context.scene.thenar.hand
    evaluated = hand.evaluated_get(blender.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    pressure, points = np.zeros(len(mesh.vertices), np.float32), np.zeros(3 * len(mesh.vertices), np.float32)
    mesh.attributes[names.PRESSURE_KPA].data.foreach_get("value", pressure)
    mesh.vertices.foreach_get("co", points)
    world = np.array(evaluated.matrix_world)
    return 1000.0 * (points.reshape(-1, 3)[pressure > 0.0] @ world[:3, :3].T + world[:3, 3])
