"""Adhesion against Johnson, Kendall and Roberts, and Derjaguin, Muller and Toporov: pull-off and contact at no load."""

import numpy as np
import pytest
import thenar
from proof import meshes, pressing

RADIUS, ZERO_LOAD_RADIUS = 10.0, 1.0
SCALE = ZERO_LOAD_RADIUS**2 / RADIUS  # mm of depth
# JKR: a0^3 = 9 pi w R^2 / (2 E*).
WORK = 2.0 * pressing.CONTACT_MODULUS * ZERO_LOAD_RADIUS**3 / (9.0 * np.pi * RADIUS**2)  # N/mm


def adhesion(work=WORK, range_mm=1e-5):
    return [thenar.Effect("adhesion", 1.0, work_j_per_m2=1e3 * work, range_mm=range_mm)]


def sphere(extent):
    """A sphere that touches the plane z = 0 from above."""
    return meshes.sphere(RADIUS, (0.0, 0.0, RADIUS), extent, 0.03)


def retract(skin, depths, effects):
    """Forces and areas on the way out, `depths` in mm."""
    prepared = thenar.Skin(*skin, materials=[pressing.material()], effects=effects)
    protocol = {"time_s": np.arange(len(depths)) * 1.0, "offset_mm": depths}
    course = prepared.run(protocol, *sphere(1.8), direction=(0.0, 0.0, -1.0))
    return np.asarray(course.force_n), np.asarray(course.contact_area_mm2)


@pytest.mark.parametrize("seed", [1, 2])
def test_short_range_is_jkr(seed):
    """Eight spacings in the contact at no load, five where it lets go."""
    skin = meshes.disc_patch(1.7, ZERO_LOAD_RADIUS / 8.0, 0.15, seed)
    depths = np.concatenate([[0.5, 0.42, 0.36, 0.3], np.arange(0.0, -0.25, -0.04)]) * SCALE
    force, area = retract(skin, depths, adhesion())
    assert -force.min() == pytest.approx(1.5 * np.pi * WORK * RADIUS, rel=0.05)
    zero = np.interp(0.0, force[::-1], area[::-1])
    assert np.sqrt(zero / np.pi) == pytest.approx(ZERO_LOAD_RADIUS, rel=0.03)


def test_wide_range_is_dmt():
    work = 0.01 * WORK
    skin = meshes.disc_patch(2.3, 0.2, 0.15, 1)
    force, _ = retract(skin, np.linspace(0.002, -0.0015, 8), adhesion(work, 0.15))
    assert -force.min() == pytest.approx(2.0 * np.pi * work * RADIUS, rel=0.03)


def test_contact_without_load_and_totals():
    skin = meshes.disc_patch(1.7, 0.2, 0.15, 1)
    prepared = thenar.Skin(*skin, materials=[pressing.material()])
    assert prepared.press(*sphere(1.8)).total_force_n[2] == pytest.approx(0.0, abs=1e-6)
    prepared.set_effects(adhesion())
    contact = prepared.press(*sphere(1.8))
    assert contact.contact_area_mm2 > 0.5
    assert contact.total_force_n[2] < 0.0
    balance = contact.force_n.sum() - contact.adhesion_force_n.sum()
    assert contact.total_force_n[2] == pytest.approx(balance, rel=1e-2)


def test_dry_skin_pulls_with_at_most_fifteen_millinewtons():
    """The default stays below what was measured on fingers (Spinner 2016)."""
    entry = next(e for e in thenar.effects() if e.name == "adhesion")
    work = {number.name: number for number in entry.shape}["work_j_per_m2"]
    assert 1.5 * np.pi * 1e-3 * work.default * 8.0 < 0.015
    assert 1.5 * np.pi * 1e-3 * work.physiological[1] * 8.0 == pytest.approx(0.015, rel=0.02)
