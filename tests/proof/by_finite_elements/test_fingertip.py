"""The layer with lateral escape against a pad over bone at finite strain (by_finite_elements/fingertip.json, FElupe).

The base model bonds an incompressible layer of even thickness to bone without end. A fingertip's bone ends and its
sides are free, so tissue escapes sideways: the base model is too stiff there, and a Poisson's ratio below 1/2 stands
for that escape. 0.41 was chosen on one pad under the plate; neither the other tool nor the other bones had a part.
"""

import functools
import json
from pathlib import Path

import numpy as np
import pytest
import thenar
from proof import meshes, pressing

TABLE = json.loads(Path(__file__).with_name("fingertip.json").read_text())
SKIN_MM = np.array(TABLE["skin_semi_axes_mm"])
SHEAR_MPA = TABLE["shear_modulus_mpa"]
ESCAPE = 0.41  # Poisson's ratio that stands for tissue escaping sideways
STRAIN = 0.2  # depth over thickness up to which the figures are held
LEAST_MM = 0.4  # below, too few nodes of the finite elements touch to tell an area


def rows(bone, tool, density=None):
    """Columns of the finest computation, or of the one named: depth, force, area."""
    computed = TABLE["pads"][bone]["tools"][tool]
    found = np.array(computed[density or max(computed, key=int)])
    return found[:, 0], found[:, 1], found[:, 2]


def thickness(bone):
    """Tissue between the bone and the pad's apex, mm."""
    return float(SKIN_MM[2] - TABLE["pads"][bone]["bone_semi_axes_mm"][2])


@functools.cache
def pad():
    """The pad's skin, facing +z."""
    vertices, triangles = meshes.ellipsoid(tuple(SKIN_MM), 6000)
    return meshes.keep_triangles(vertices, triangles, vertices[triangles][:, :, 2].mean(axis=1) > 0.0)


def pressed(bone, tool, depths, poisson_ratio):
    """(forces N, areas mm2) of the layer model."""
    material = thenar.Material(
        g0_mpa=SHEAR_MPA,
        g_lim_mpa=SHEAR_MPA,
        d_lim_mm=4.0,
        thickness_mm=thickness(bone),
        poisson_ratio=poisson_ratio,
        swelling=(0.0, 8.0, 2.0),
    )
    skin = thenar.Skin(*pad(), materials=[material])
    found = []
    for depth in depths:
        height = SKIN_MM[2] - depth
        if tool == "plate":
            product = pressing.plate_over(height)
        else:
            product = pressing.cylinder_over(height, TABLE["rod_radius_mm"])
        contact = skin.press(*product)
        found.append((np.linalg.norm(contact.total_force_n), contact.contact_area_mm2))
    return np.array(found).T


@pytest.mark.parametrize("tool", ["plate", "rod"])
def test_the_finite_elements_have_converged(tool):
    (depth, coarse, _), (_, fine, _) = rows("slender", tool, "9"), rows("slender", tool, "18")
    deep = depth > 0.75
    assert np.abs(coarse[deep] / fine[deep] - 1.0).max() < 0.03
    overlap = np.array(TABLE["pads"]["slender"]["tools"][tool]["18"])[:, 4]
    assert (overlap / depth < 0.012).all()


def ratios(bone, tool, poisson_ratio):
    """Force and area of the layer model over those of the finite elements, at depths up to the strain held."""
    depth, force, area = rows(bone, tool)
    held = (depth > LEAST_MM - 1e-6) & (depth < STRAIN * thickness(bone) + 1e-6)
    forces, areas = pressed(bone, tool, depth[held], poisson_ratio)
    f, a = forces / force[held], areas / area[held]
    print(
        f"{bone} {tool} nu {poisson_ratio}: force {f.min():.3f} to {f.max():.3f}, "
        f"area {a.min():.3f} to {a.max():.3f}, median {np.median(a):.3f} of the finite elements'"
    )
    return f, a


@pytest.mark.parametrize("tool", ["plate", "rod"])
def test_force_and_area_of_a_fingertip(tool):
    force, area = ratios("slender", tool, ESCAPE)
    assert np.abs(force - 1.0).max() < 0.05
    assert np.abs(area - 1.0).max() < 0.10


@pytest.mark.parametrize("tool", ["plate", "rod"])
@pytest.mark.parametrize("bone", ["small", "broad"])
def test_other_bones_need_no_other_number(bone, tool):
    force, area = ratios(bone, tool, ESCAPE)
    assert np.abs(force - 1.0).max() < 0.05
    assert np.median(np.abs(area - 1.0)) < 0.11


@pytest.mark.parametrize("tool", ["plate", "rod"])
def test_without_escape_a_pad_is_a_third_too_stiff(tool):
    force, _ = ratios("slender", tool, 0.5)
    assert force.min() > 1.2
    assert force.max() < 1.5


@pytest.mark.parametrize("tool", ["plate", "rod"])
def test_thin_tissue_all_around_a_bone_escapes_less(tool):
    """Where 3 mm lie over a bone as wide as the finger, the same number is too soft: 0.45 would do."""
    force, _ = ratios("full", tool, ESCAPE)
    assert 0.80 < force.min() < force.max() < 0.97
    assert np.abs(ratios("full", tool, 0.45)[0] - 1.0).max() < 0.06
