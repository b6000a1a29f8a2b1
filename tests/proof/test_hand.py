"""The generated hand around a handle: half the vertex spacing gives the same press."""

import numpy as np
import pytest
import thenar
from bench import grasp


def test_half_the_spacing_gives_the_same_grasp():
    """Force within 3 %, patch peak within 8 % of the press at half the vertex spacing, the same posture."""
    coarse, fine = thenar.hand(), thenar.hand(spacing_mm=1.25)
    axis = grasp.handle_axis(coarse)
    flexion = grasp.close(coarse, axis)
    product = thenar.Product(*grasp.handle_about(axis))
    presses = []
    for made in (coarse, fine):
        skin = thenar.Skin(
            made["vertices_mm"], made["triangles"], regions=made["regions"], materials=grasp.materials(made)
        )
        presses.append(skin.press(product, posed_vertices_mm=grasp.curled(made, flexion)))
    for what, (wide, close) in {
        "force": [press.force_n.sum() for press in presses],
        "patch peak": [press.patch_peak_mpa for press in presses],
    }.items():
        print(f"{what}: {100.0 * (wide / close - 1.0):+.2f} % at twice the spacing")
    assert len(fine["vertices_mm"]) > 3.5 * len(coarse["vertices_mm"])
    assert presses[0].in_contact.sum() > 300
    assert presses[0].force_n.sum() == pytest.approx(presses[1].force_n.sum(), rel=0.03)
    assert np.linalg.norm(presses[0].total_force_n) == pytest.approx(np.linalg.norm(presses[1].total_force_n), rel=0.03)
    assert presses[0].patch_peak_mpa == pytest.approx(presses[1].patch_peak_mpa, rel=0.08)
