"""A flat indenter of 2 mm at 1 N, against Tables 1 and 2 of Xie, Kanai and Date, and against a punch on a half space.

The tables: the skin rises most 8 mm (fingertip) and 15 mm (palm) from the middle of the indenter.
"""

import numpy as np
import pytest
import thenar
from proof import meshes, pressing

RADIUS, FORCE = 1.0, 1.0
"""mm, N."""
BULGE = {"fingertip": 8.0, "palm": 15.0}
"""Distance from the middle at which the skin rises most, mm (Table 2)."""
OFF = 0.15
"""Most that it may be off."""
SWELLING = {"fingertip": (2.0, 8.0, 2.0), "palm": (3.0, 15.0, 2.5)}
"""a0 (mm/N), b and c (mm) of Table 2."""


def indenter(depth=0.0, radius=RADIUS):
    """A flat-ended rod, 40 mm long, its end at z = -depth."""
    vertices, triangles = meshes.cylinder(radius, 40.0, 64, 8)
    return vertices + [0.0, 0.0, 20.0 - depth], triangles


def fine_in_the_middle(spacing, radius=36.0):
    """A disc of skin whose spacing grows from `spacing` to 8 times that at the rim."""
    return meshes.graded_patch(radius, spacing, 8.0)


def rise(vertices, z):
    """(Distance of the highest place from the middle, height there), mm, of heights `z` over rings 1.5 mm wide."""
    r = np.hypot(vertices[:, 0], vertices[:, 1])
    middles = np.arange(2.0, 30.0, 0.5)
    heights = [z[np.abs(r - at) < 0.75].mean() for at in middles]
    top = int(np.argmax(heights))
    return middles[top], heights[top]


def pressed(material, model):
    """(skin's vertices, contact) under 1 N."""
    skin = fine_in_the_middle(0.4)
    prepared = thenar.Skin(*skin, materials=[material], model=model)
    return skin[0], prepared.press(*indenter(), force_n=FORCE, direction=(0.0, 0.0, -1.0))


@pytest.mark.parametrize("site", BULGE)
def test_one_newton_is_reached_and_the_bulge_lies_where_the_tables_say(site):
    material = {"fingertip": thenar.Material.finger_layer, "palm": thenar.Material.palm_layer}[site]()
    vertices, contact = pressed(material, "layer")
    (at, height), depth = rise(vertices, contact.displacement_mm[:, 2]), -contact.displacement_mm[:, 2].min()
    print(f"{site}: {contact.total_force_n[2]:.3f} N, {depth:.2f} mm deep, rises {height:.3f} mm at {at:.1f} mm")
    assert contact.total_force_n[2] == pytest.approx(FORCE, rel=1e-3)
    assert at == pytest.approx(BULGE[site], rel=OFF)
    assert height > 0.0 and depth > RADIUS, "deeper than half the tool is wide"


def published(site, swelling=True):
    """The paper's own tissue on a half space (Table 2), with or without its swelling."""
    material = {"fingertip": thenar.Material.finger, "palm": thenar.Material.palm}[site]()
    numbers = {name: getattr(material, name) for name in ("g0_mpa", "g_lim_mpa", "d_lim_mm", "zone_mm")}
    return thenar.Material(thickness_mm=np.inf, swelling=SWELLING[site] if swelling else (0.0, 8.0, 2.0), **numbers)


@pytest.mark.parametrize("site", BULGE)
def test_the_published_constants_swell_the_skin_where_they_say(site):
    """What swelling adds to the half space's dip."""
    (vertices, swollen), (_, dipped) = (pressed(published(site, on), "paper") for on in (True, False))
    both = swollen.displacement_mm[:, 2], dipped.displacement_mm[:, 2]
    (at, height), (net_at, net) = rise(vertices, both[0] - both[1]), rise(vertices, both[0])
    print(f"{site}: {-both[0].min():.2f} mm deep, swells {height:.3f} mm at {at:.1f} mm; net {net:.3f} at {net_at:.1f}")
    assert swollen.total_force_n[2] == pytest.approx(FORCE, rel=1e-3)
    assert at == pytest.approx(BULGE[site], rel=OFF) and height > 0.05


@pytest.mark.parametrize("site", BULGE)
def test_the_published_constants_shape_the_skin_as_equations_4_to_6_do(site):
    """Free skin moves along its own normal, by the dip of a flat punch less the Gaussian under the punch's pressure.

    A punch of radius a loads the part sqrt(1 - s^2 / a^2) of its force beyond the distance s from its middle, and its
    half space dips by F asin(a / r) / (4 pi G a) outside (Johnson, Contact Mechanics 3.8).
    """
    material, (a0, middle, width) = published(site), SWELLING[site]
    vertices, contact = pressed(material, "paper")
    r, moved = np.hypot(vertices[:, 0], vertices[:, 1]), contact.displacement_mm
    stiffened = min(-moved[:, 2].min() / material.d_lim_mm, 1.0)
    shear = material.g0_mpa + (material.g_lim_mpa - material.g0_mpa) * stiffened
    free = (r > 1.5) & (r < material.zone_mm - RADIUS)
    dip = FORCE * np.arcsin(RADIUS / r[free]) / (4.0 * np.pi * shear * RADIUS)
    bulge = a0 * material.g0_mpa / shear * FORCE * spread(r[free], middle, width)
    # By rings: the mesh's 20 pressed vertices carry the force 0.1 mm off the tool's axis.
    rings = [(r[free] >= inner) & (r[free] < inner + 1.0) for inner in np.arange(1.5, material.zone_mm - 1.5)]
    off, size = (
        np.array([value[ring].mean() for ring in rings]) for value in (moved[free, 2] - bulge + dip, dip + bulge)
    )
    print(f"{site}: {free.sum()} vertices, rise by {bulge.max():.3f} mm, rings {np.abs(off / size).max():.2%} off")
    assert free.sum() > 400 and bulge.max() > 0.05
    assert np.abs(off / size).max() < 0.02
    assert np.abs(moved[free, :2]).max() < 1e-9, "toward no side of the tool"


def spread(r, middle, width):
    """Mean of the Gaussian of Eq. 5 at distances `r` (n,), over the load of a punch."""
    share, angle = (np.arange(24) + 0.5) / 24.0, (np.arange(48) + 0.5) * np.pi / 24.0
    s = RADIUS * np.sqrt(1.0 - (1.0 - share) ** 2)
    x, y = np.outer(s, np.cos(angle)).ravel(), np.outer(s, np.sin(angle)).ravel()
    return np.exp(-0.5 * ((np.hypot(r[:, None] - x, y) - middle) / width) ** 2).mean(axis=1)


@pytest.mark.parametrize("depth", [0.5, 3.0])
def test_a_punch_deeper_than_it_is_wide_carries_what_sneddon_s_does(depth):
    """F = 2 E* a d at any depth of linear theory, in the limit of fine spacing: its sides carry nothing."""
    spacing, wanted = np.array([0.2, 0.16, 0.13, 0.1]), 2.0 * pressing.CONTACT_MODULUS * RADIUS * depth
    travel = []
    for h in spacing:
        skins = [meshes.disc_patch(RADIUS + 4.0 * h, h, 0.15, seed) for seed in (1, 2, 3)]
        presses = [pressing.press(s, indenter(), force_n=wanted, direction=(0.0, 0.0, -1.0)) for s in skins]
        travel.append(np.mean([contact.offset_mm for contact in presses]))
    limit = np.polyfit(spacing, travel, 1)[1]
    print(f"{depth} mm: travel {limit / depth - 1.0:+.1%}")
    assert limit == pytest.approx(depth, rel=0.02)


def test_an_edge_carries_in_proportion_to_its_depth():
    """A strip 2 mm wide, 3 mm deep, was read from its sides: less force than at 1 mm."""
    skin = meshes.disc_patch(12.0, 0.5)
    vertices, triangles = meshes.box((-1.0, -30.0, 0.0), (1.0, 30.0, 30.0))
    prepared = thenar.Skin(*skin, materials=[pressing.material(thickness=7.0)])
    forces = (1.0, 2.0, 4.0)
    travel = [prepared.press(vertices, triangles, force_n=n, direction=(0, 0, -1)).offset_mm for n in forces]
    print(np.round(travel, 3))
    assert travel[-1] > 2.0, "deeper than the edge is wide"
    assert np.array(travel) / forces / travel[0] == pytest.approx(1.0, abs=0.03)


def test_the_paper_s_model_settles_under_refinement():
    """A vertex answered to itself as at 0.5 mm, however fine the mesh: the peak grew by 5 from 1 to 0.5 mm."""
    force, peak, middle = [], [], []
    for spacing in (1.0, 0.7, 0.5, 0.35):
        vertices, triangles = meshes.disc_patch(10.0, spacing)
        ball = meshes.sphere(20.0, (0.0, 0.0, 18.5), 12.0, 0.4)
        contact = pressing.press((vertices, triangles), ball, [thenar.Material.finger()], "paper")
        inner = np.hypot(vertices[:, 0], vertices[:, 1]) < 2.0
        force.append(contact.total_force_n[2])
        peak.append(1e3 * contact.pressure_mpa.max())
        middle.append(1e3 * contact.pressure_mpa[inner].mean())
    hertz = 0.966 * 1.5 * force[-1] / (np.pi * 20.0 * 1.5) * 1e3  # mean over 2 mm of the radius sqrt(R d)
    print(np.round(force, 4), np.round(peak, 2), np.round(middle, 2), round(hertz, 2))
    assert np.abs(np.diff(force)).max() < 0.02 * force[-1] and abs(force[-1] / force[-2] - 1.0) < 0.01
    assert max(peak) / min(peak) < 1.1
    assert (np.diff(middle) < 0.0).all() and 1.0 < middle[-1] / hertz < 1.1, "it comes down to the ball's"
