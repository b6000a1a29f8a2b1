"""Presets of the layer: a solid of their tissue, shaped as a pad of the published radius, needs the published force.

The published materials are those of a half space (Xie 4.1): G grows with depth, force by Hertz. The solid is the
reference solve; the layer, which has the same numbers, has to agree with it.
"""

import numpy as np
import pytest
import thenar
from proof.deep_pads import bone_pads as pads

PADS = {  # radius mm, semi-axes of skin and bone mm: (1/R = c / a^2 at the apex)
    "finger": (8.0, (9.0, 9.0, 10.1), (6.0, 3.0, 3.0)),
    "palm": (40.0, (31.2, 31.2, 24.4), (24.5, 24.5, 11.0)),
}
# Largest ratio: the published palm softens against every solid over bone.
WITHIN = {"finger": 1.19, "palm": 1.42}


def curves(kind):
    """Depths mm; forces N: published, of the solid, of the layer."""
    radius, axes, bone = PADS[kind]
    published, preset = getattr(thenar.Material, kind)(), getattr(thenar.Material, kind + "_layer")()
    assert preset.thickness_mm == pytest.approx(axes[2] - bone[2])
    depths = np.linspace(1.0, published.d_lim_mm, 4)
    line = published.g0_mpa + (published.g_lim_mpa - published.g0_mpa) * depths / published.d_lim_mm
    hertz = 16.0 / 3.0 * line * np.sqrt(radius) * depths**1.5
    presses = [("plate", depth) for depth in depths]
    solids = pads.solid(axes, bone, presses, preset.stiffening, spacing=2.0)
    solid = np.array([found.normal_force_n for found in solids]) * preset.g0_mpa / pads.SHEAR_MPA
    tissue = preset.replace(bone_half_width_mm=bone[1], bone_half_length_mm=bone[0])
    layer = [np.linalg.norm(found.total_force_n) for found in pads.layer(axes, [tissue], presses, 1.4)]
    return depths, hertz, solid, np.array(layer)


@pytest.mark.parametrize("kind", ["finger", "palm"])
def test_a_solid_of_the_preset_needs_the_published_force(kind):
    depths, hertz, solid, layer = curves(kind)
    for depth, *forces in zip(depths, hertz, solid, layer, strict=True):
        print(f"{kind} {depth:.1f} mm: published {forces[0]:.3f} N, solid {forces[1]:.3f} N, layer {forces[2]:.3f} N")
    off = np.log(solid / hertz)
    assert np.exp(np.abs(off).max()) < WITHIN[kind]
    assert abs(off.min() + off.max()) < 0.08, "as much above as below"
    # 4 mm are 0.56 of the finger's tissue; the layer is held to half.
    is_held = depths < 0.53 * (PADS[kind][1][2] - PADS[kind][2][2])
    assert is_held.sum() >= 3
    assert np.abs(layer / solid - 1.0)[is_held].max() < 0.08


@pytest.mark.parametrize("preset", ["finger_layer", "phalanx_layer", "palm_layer"])
def test_no_tissue_softens_with_depth(preset):
    material = getattr(thenar.Material, preset)()
    assert material.g_lim_mpa >= material.g0_mpa and material.stiffening >= 0.0
