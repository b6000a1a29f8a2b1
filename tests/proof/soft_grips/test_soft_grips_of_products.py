"""Soft grips against closed forms, and against finite elements of two layers that share nothing with Thenar."""

import numpy as np
import pytest
import thenar
from proof import meshes, pressing
from proof.soft_grips import two_layers

RADIUS = 60.0
"""mm, of the pressed paraboloid: contacts stay flat, as the finite elements take them."""
FORCE, GRIP, PRESSURE = 0.02, 0.02, 0.05
"""Most that force, the grip's greatest yield and the mean over the inner contact may be off."""
SKIN = {"fingertip": (7.0, 0.023, 0.5), "palm": (12.0, 0.0132, 0.8)}
"""Thickness (mm), shear modulus (MPa) and approach (mm)."""
GRIPS = {
    "sponge": (4.0, 0.02, 0.0),
    "soft foam": (3.0, 0.05, 0.3),
    "foam, no lateral strain": (2.0, 0.2, 0.0),
    "gel": (4.0, 0.1, 0.49),
    "thin gel": (1.0, 0.1, 0.49),
    "silicone": (3.0, 1.14, 0.49),
    "EVA foam": (5.0, 2.1, 0.0),
}
"""Thickness (mm), Young's modulus (MPa), Poisson's ratio."""


def paraboloid(half, spacing, depth, radius=RADIUS):
    """A surface that faces down, its lowest point at z = -depth."""
    vertices, triangles = meshes.disc_patch(half, spacing, seed=4)
    vertices[:, 2] = (vertices[:, 0] ** 2 + vertices[:, 1] ** 2) / (2.0 * radius) - depth
    return vertices, triangles[:, ::-1].copy()


def pressed(skin, elastomer, spacing=0.7, half=24.0):
    """(contact, skin's vertices, product's vertices)."""
    thickness, shear, depth = SKIN[skin]
    flat, product = meshes.disc_patch(half, spacing), paraboloid(half, spacing, depth)
    material = pressing.material(shear, thickness)
    return pressing.press(flat, product, [material], grip=elastomer), flat[0], product[0]


@pytest.mark.parametrize("grip", GRIPS)
@pytest.mark.parametrize("skin", SKIN)
def test_two_layers_meet_finite_elements(skin, grip):
    thickness, shear, depth = SKIN[skin]
    exact = two_layers.press(
        two_layers.Layer.of_shear(thickness, shear, 0.4999), two_layers.Layer(*GRIPS[grip]), RADIUS, depth
    )
    contact, vertices, product = pressed(skin, thenar.Elastomer(*GRIPS[grip]))
    r, at = np.hypot(vertices[:, 0], vertices[:, 1]), np.hypot(product[:, 0], product[:, 1])
    inner, middle = r < 0.8 * exact.contact_radius_mm, at < 2.0
    wanted = np.interp(r, exact.r_mm, exact.pressure_mpa)
    yielded = np.interp(at, exact.r_mm, exact.grip_displacement_mm)
    force = contact.total_force_n[2] / exact.force_n - 1.0
    grip_off = contact.grip_displacement_mm[middle, 2].mean() / yielded[middle].mean() - 1.0
    pressure = contact.pressure_mpa[inner].mean() / wanted[inner].mean() - 1.0
    print(f"{skin}, {grip}: force {force:+.1%}, grip {grip_off:+.1%}, pressure {pressure:+.1%}")
    assert abs(force) < FORCE and abs(pressure) < PRESSURE
    assert abs(grip_off) < GRIP or abs(grip_off) * yielded.max() < 0.002


@pytest.mark.parametrize("youngs_mpa", [0.3, 0.06, 0.02])
def test_two_half_spaces_meet_hertz(youngs_mpa):
    """1 / E* is the sum of both (Johnson, Contact Mechanics 4.2)."""
    radius, depth, spacing = 10.0, 0.4, 0.35
    skin = meshes.disc_patch(8.0, spacing)
    elastomer = thenar.Elastomer(np.inf, youngs_mpa, 0.3)
    contact = pressing.press(skin, paraboloid(8.0, spacing, depth, radius), grip=elastomer)
    modulus = 1.0 / (1.0 / pressing.CONTACT_MODULUS + (1.0 - 0.3**2) / youngs_mpa)
    hertz = 4.0 / 3.0 * modulus * np.sqrt(radius) * depth**1.5
    print(f"E {youngs_mpa} MPa: force {contact.total_force_n[2] / hertz - 1.0:+.2%}")
    assert contact.total_force_n[2] == pytest.approx(hertz, rel=0.02)
    share = contact.grip_displacement_mm[:, 2].max() / depth
    assert share == pytest.approx(modulus * (1.0 - 0.3**2) / youngs_mpa, rel=0.03), "depth is shared as the moduli"


@pytest.mark.parametrize("poisson_ratio", [0.0, 0.3, 0.49])
def test_grips_far_thinner_than_the_skin_s_spacing_come_near_the_rigid_product(poisson_ratio):
    """A hand's vertices are 2.5 mm apart and more: a film under them is no half space."""
    skin, product = meshes.disc_patch(30.0, 2.5), paraboloid(30.0, 1.5, 1.0)
    prepared = thenar.Skin(*skin, materials=[pressing.material(thickness=7.0)])
    rigid = prepared.press(*product).total_force_n[2]
    forces = [
        prepared.press(*product, grip=thenar.Elastomer(h, 0.2, poisson_ratio)).total_force_n[2] / rigid
        for h in (2.0, 1.0, 0.5, 0.2, 0.05)
    ]
    print([round(float(force), 4) for force in forces])
    assert np.all(np.diff(forces) > -2e-3) and forces[-1] == pytest.approx(1.0, abs=0.02)


def test_a_foam_far_softer_than_the_skin_carries_what_a_foundation_does():
    """E 0.02 MPa under hard rubber (G 4 MPa), 12 times wider than it is thick (Johnson, Contact Mechanics 4.3)."""
    skin, product = meshes.disc_patch(6.5, 0.3), paraboloid(6.5, 0.3, 0.08, 150.0)
    contact = pressing.press(skin, product, [pressing.material(4.0)], grip=thenar.Elastomer(0.4, 0.02, 0.3))
    wanted = two_layers.winkler_force_n(two_layers.Layer(0.4, 0.02, 0.3), 150.0, 0.08)
    print(f"force {contact.total_force_n[2] / wanted - 1.0:+.1%}")
    assert contact.total_force_n[2] == pytest.approx(wanted, rel=0.06)


def edge_over(depth, longest=0.8):
    """A bar of square section whose edge, along y, lies `depth` mm below z = 0."""
    vertices, triangles = refined(*meshes.box((-8.0, -14.0, -8.0), (8.0, 14.0, 8.0)), longest)
    vertices = vertices @ meshes.rotation((0.0, 1.0, 0.0), np.pi / 4.0).T
    return vertices + [0.0, 0.0, 8.0 * np.sqrt(2.0) - depth], triangles


@pytest.mark.parametrize("grip", [(4.0, 0.3, 0.3), (4.0, 0.1, 0.3), (8.0, 0.05, 0.0)])
def test_skin_on_a_sharp_edge_of_a_soft_grip_settles(grip):
    skin, product = meshes.disc_patch(12.0, 1.0), edge_over(1.5)
    prepared = thenar.Skin(*skin, materials=[pressing.material(thickness=7.0)])
    rigid = prepared.press(*product)
    contact = prepared.press(*product, grip=thenar.Elastomer(*grip))
    stiff = prepared.press(*product, grip=thenar.Elastomer(grip[0], 1e4, grip[2]))
    gap = contact.pressed_product.gap_mm(pressing.written(skin, contact))["gap_mm"]
    share = contact.total_force_n[2] / rigid.total_force_n[2]
    print(f"{grip}: {share:.2f} of the rigid edge's force, skin within {np.abs(gap[contact.in_contact]).max():.4f} mm")
    assert contact.grade != "do not use" and 0.02 < share < 0.98
    assert np.abs(gap[contact.in_contact]).max() < 0.005 and gap.min() > -0.02
    assert stiff.total_force_n[2] == pytest.approx(rigid.total_force_n[2], rel=0.01)


@pytest.mark.parametrize(
    ("count", "turns", "tray"), [(800, (1.3, 0.3), (3.6, 1.5, 6.0)), (500, (2.3, 0.0), (4.0, 3.4, 7.0))]
)
def test_a_fingertip_over_the_edge_of_a_soft_tray_settles(count, turns, tray):
    """Skin at the edge met one wall or the other from press to press, and its yield jumped by 0.33 and 0.10 mm.

    The tray: depth of its face in the pad, how far the pad lies from its edge, and its thickness (mm).
    """
    depth, over, thick = tray
    tray = meshes.box((-30.0, -over, -depth), (30.0, 60.0, thick - depth))
    vertices, triangles = pressing.fingertip(count)
    about_z, about_x = meshes.rotation((0.0, 0.0, 1.0), turns[0]), meshes.rotation((1.0, 0.0, 0.0), turns[1])
    vertices = vertices @ (about_x @ about_z).T
    vertices -= [0.0, 0.0, vertices[:, 2].max()]
    prepared = thenar.Skin(vertices, triangles, materials=[thenar.Material.finger_layer()])
    contact = prepared.press(*tray, grip=thenar.Elastomer(8.0, 0.1, 0.3))
    warm = prepared.press(*tray, grip=thenar.Elastomer(8.0, 0.1, 0.3), warm_start=True)
    gap = contact.pressed_product.gap_mm(vertices + contact.displacement_mm)["gap_mm"]
    change = np.linalg.norm(warm.total_force_n - contact.total_force_n) / np.linalg.norm(contact.total_force_n)
    print(f"skin within {np.abs(gap[contact.in_contact]).max():.1e} mm of the grip, again {change:.1e} of the force")
    assert contact.grade != "do not use" and not any("settled to" in text for text in contact.warnings)
    assert np.abs(gap[contact.in_contact]).max() < 1e-3 and gap.min() > -1e-3
    assert change < 1e-3, "a press that starts from the result ends there"
    borne = (contact.force_n[:, None] * contact.product_normal).sum(axis=0)
    assert contact.total_force_n == pytest.approx(-borne, abs=1e-6)


def test_a_foam_is_pressed_no_thinner_than_it_can_be():
    skin, product = meshes.disc_patch(16.0, 0.8), paraboloid(16.0, 0.8, 1.5)
    foam = thenar.Elastomer(0.5, 0.004, 0.0)
    contact = pressing.press(skin, product, [pressing.material(thickness=7.0)], grip=foam)
    yielded = contact.grip_displacement_mm[:, 2].max()
    print(f"yields {yielded:.3f} of {foam.thickness_mm} mm")
    assert 0.9 * 0.5 < yielded < 0.5 and contact.grade == "do not use"


@pytest.mark.parametrize("grip", [thenar.Elastomer(0.0, 1.0), "rigid vertices"])
def test_a_grip_without_thickness_is_the_rigid_product_bit_for_bit(grip):
    skin, product = meshes.disc_patch(12.0, 0.8), paraboloid(12.0, 0.8, 0.5)
    more = {"grip": grip} if grip != "rigid vertices" else {}
    if not more:
        more = {"grip": thenar.Elastomer(3.0, 0.1), "grip_of_vertex": np.full(len(product[0]), -1)}
    rigid, soft = pressing.press(skin, product), pressing.press(skin, product, **more)
    assert np.array_equal(rigid.displacement_mm, soft.displacement_mm)
    assert np.array_equal(rigid.force_n, soft.force_n) and not soft.grip_displacement_mm.any()


def test_a_wanted_force_is_reached_and_skin_lies_on_the_pressed_grip():
    skin, product = meshes.disc_patch(16.0, 0.8), paraboloid(16.0, 0.8, 0.2)
    contact = pressing.press(
        skin, product, [pressing.material(thickness=7.0)], grip=thenar.Elastomer(3.0, 0.1, 0.3), force_n=0.5
    )
    assert contact.total_force_n @ contact.direction == pytest.approx(-0.5, rel=1e-3)
    moved = pressing.written(skin, contact) - contact.offset_mm * contact.direction
    gap = contact.pressed_product.gap_mm(moved)["gap_mm"]
    assert np.abs(gap[contact.in_contact]).max() < 0.005
    rigid = thenar.Product(*product).gap_mm(moved)["gap_mm"]
    assert rigid[contact.in_contact].max() < -0.01, "without the grip's yield the skin would lie inside"


def test_the_same_press_gives_the_same_bits():
    skin, product = meshes.disc_patch(12.0, 0.8), paraboloid(12.0, 0.8, 0.5)
    prepared = thenar.Skin(*skin, materials=[pressing.material(thickness=7.0)])
    first, second = (prepared.press(*product, grip=thenar.Elastomer(3.0, 0.1, 0.3)) for _ in range(2))
    assert np.array_equal(first.displacement_mm, second.displacement_mm)
    assert np.array_equal(first.grip_displacement_mm, second.grip_displacement_mm)


def test_two_walls_of_a_thin_plate_do_not_yield_for_each_other():
    """Skin on one side of a plate 2 mm thick: the other side stays where it was."""
    skin = meshes.disc_patch(7.0, 0.8)
    plate = meshes.box((-9.0, -9.0, -0.4), (9.0, 9.0, 1.6))
    vertices, triangles = refined(*plate, 1.0)
    contact = pressing.press(
        skin, (vertices, triangles), [pressing.material(thickness=7.0)], grip=thenar.Elastomer(0.8, 0.1, 0.3)
    )
    moved = np.abs(contact.grip_displacement_mm).max(axis=1)
    inner = np.hypot(vertices[:, 0], vertices[:, 1]) < 4.0
    assert moved[inner & (vertices[:, 2] < 0.0)].min() > 0.01 and moved[inner & (vertices[:, 2] > 1.0)].max() < 1e-6


def refined(vertices, triangles, longest):
    """Every triangle cut in four until no edge is longer."""
    while np.linalg.norm(vertices[triangles] - vertices[np.roll(triangles, 1, axis=1)], axis=2).max() > longest:
        a, b, c = triangles.T
        ends = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
        pairs, place = np.unique(ends, axis=0, return_inverse=True)
        ab, bc, ca = (len(vertices) + place.ravel()).reshape(3, -1)
        vertices = np.concatenate([vertices, vertices[pairs].mean(axis=1)])
        triangles = np.concatenate([np.stack(t, 1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return vertices, triangles.astype(np.int32)


@pytest.mark.parametrize(
    ("numbers", "wanted"),
    [
        ((-1.0, 1.0, 0.3), "thickness_mm is -1"),
        ((1.0, 0.0, 0.3), "youngs_mpa is 0"),
        ((1.0, 1.0, 0.6), "poisson_ratio is 0.6"),
        ((np.nan, 1.0, 0.3), "thickness_mm is NaN"),
    ],
)
def test_impossible_elastomers_are_refused(numbers, wanted):
    with pytest.raises(thenar.MaterialError, match=wanted):
        thenar.Elastomer(*numbers)


def test_what_a_press_cannot_take_is_refused():
    skin, product = meshes.disc_patch(8.0, 0.8), paraboloid(8.0, 0.8, 0.3)
    soft = thenar.Elastomer(2.0, 0.1)
    with pytest.raises(thenar.MeshError, match="grip_of_vertex"):
        pressing.press(skin, product, grip=soft, grip_of_vertex=[0, 0])
    with pytest.raises(thenar.MaterialError, match="names elastomer 3 at vertex 0"):
        pressing.press(skin, product, grip=soft, grip_of_vertex=np.full(len(product[0]), 3))
    with pytest.raises(thenar.MaterialError, match="no thenar.Elastomer"):
        pressing.press(skin, product, grip=["soft"])
    with pytest.raises(thenar.MaterialError, match="there is no grip"):
        pressing.press(skin, product, grip_of_vertex=np.zeros(len(product[0])))
    with pytest.raises(thenar.SolveError, match="needs the model layer"):
        pressing.press(skin, product, [thenar.Material.finger()], model="paper", grip=soft)
    with pytest.raises(thenar.MaterialError, match="20 to 80 Shore A"):
        thenar.Elastomer.of_shore_a(90.0, 2.0)


def test_shore_a_follows_gent():
    """Gent 1958: E of 50 Shore A is 2.46 MPa; of 30, 1.14 MPa."""
    assert thenar.Elastomer.of_shore_a(50.0, 1.0).youngs_mpa == pytest.approx(2.46, abs=0.01)
    assert thenar.Elastomer.of_shore_a(30.0, 1.0).youngs_mpa == pytest.approx(1.14, abs=0.01)


def test_a_grip_that_is_pressed_far_says_so():
    skin, product = meshes.disc_patch(16.0, 0.8), paraboloid(16.0, 0.8, 1.5)
    contact = pressing.press(skin, product, [pressing.material(thickness=7.0)], grip=thenar.Elastomer(2.0, 0.04, 0.0))
    assert contact.grade == "read this" and "soft grip is pressed in by" in contact.reason


def test_esc_stops_it():
    skin, product = meshes.disc_patch(16.0, 0.8), paraboloid(16.0, 0.8, 0.5)
    with pytest.raises(thenar.Cancelled):
        pressing.press(skin, product, grip=thenar.Elastomer(2.0, 0.1), cancel=lambda: True)
