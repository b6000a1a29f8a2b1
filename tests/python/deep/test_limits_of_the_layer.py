"""What the layer of deep tissue does not keep, as addon/docs/effects.md states it. A change may only lower these."""

import numpy as np
import pytest
import thenar
from test_thickness_of_the_place import ball, force, slab


def bulge_over_dent(stiffening):
    """Volume that rises over volume that sinks, of a slab of 7.1 mm under a ball 3.5 mm deep."""
    vertices, triangles = slab()
    tissue = thenar.Material.finger_layer().replace(
        stiffening=stiffening, bone_half_width_mm=np.inf, bone_half_length_mm=np.inf
    )
    found = thenar.Skin(vertices, triangles, materials=tissue).press(*ball(4.0, 3.5))
    rise = np.asarray(found.displacement_mm)[:, 2]
    return rise[rise > 0.0].sum() / -rise[rise < 0.0].sum()


@pytest.mark.parametrize(("stiffening", "most"), [(0.5, 1.2), (2.0, 1.5)])
def test_stiffening_adds_bulge(stiffening, most):
    more = bulge_over_dent(stiffening) / bulge_over_dent(0.0)
    print(f"b {stiffening}: bulge over dent {more - 1.0:+.0%}")
    assert 1.0 < more < most


@pytest.mark.parametrize(("depth", "most"), [(1.0, 1.1), (3.0, 1.07)])
def test_a_pad_in_two_regions_is_stiffer_than_in_one(depth, most):
    vertices, triangles = slab()
    tissue, product = thenar.Material.finger_layer(), ball(8.0, depth)
    halves = (vertices[:, 0] > 0.0).astype(np.int32)
    one = thenar.Skin(vertices, triangles, materials=tissue).press(*product)
    two = thenar.Skin(vertices, triangles, regions=halves, materials=[tissue, tissue]).press(*product)
    print(f"{depth} mm: two regions {force(two) / force(one) - 1.0:+.1%}")
    assert 1.0 < force(two) / force(one) < most
