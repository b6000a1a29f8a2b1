"""Effects on the tissue against closed forms: bone, compressibility, stiffening laws, inclusions."""

import numpy as np
import pytest
import thenar
from proof import meshes, pressing
from proof.theory import layer_theory

G = pressing.SHEAR_MODULUS
RADIUS = 10.0  # mm


def sphere_on_layer(effect, theory, depth=0.6, thickness=np.inf):
    """Force and contact radius with `effect`, relative to the Hankel solve of `theory` = (nu, thickness)."""
    edges = np.linspace(0.0, 1.6 * np.sqrt(2.0 * RADIUS * depth), 181)
    force, _, radius = layer_theory.press(
        lambda r: RADIUS - np.sqrt(RADIUS**2 - r * r) - depth, edges, G, theory[0], theory[1]
    )
    skin, product = pressing.sphere_on_flat(RADIUS, depth, radius / 9.0)
    prepared = thenar.Skin(*skin, materials=[pressing.material(thickness=thickness)], effects=[effect])
    contact = prepared.press(*product)
    found = np.sqrt(contact.contact_area_mm2 / np.pi)
    return pressing.relative(contact.total_force_n[2], force), pressing.relative(found, radius)


@pytest.mark.parametrize(
    ("base", "bone", "amplitude", "expected"),
    [(np.inf, 5.0, 1.0, 5.0), (9.0, 5.0, 1.0, 5.0), (9.0, 4.5, 0.5, 6.0), (np.inf, 4.0, 0.5, 8.0)],
)
def test_bone_is_the_fourier_kernel_of_its_thickness(base, bone, amplitude, expected):
    """Inverse thickness is blended; force within 1 %, contact radius within 3 %."""
    effect = thenar.Effect("bone", amplitude, thickness_mm=bone)
    force, radius = sphere_on_layer(effect, (0.5, expected), thickness=base)
    assert abs(force) < 0.01 and abs(radius) < 0.03


@pytest.mark.parametrize("nu", [0.3, 0.4, 0.45])
def test_compressible_tissue_is_boussinesq_and_the_layer_kernel(nu):
    effect = thenar.Effect("compressibility", 1.0, poisson_ratio=nu)
    depth = 0.6
    for thickness in (np.inf, 6.0):
        force, radius = sphere_on_layer(effect, (nu, thickness), depth, thickness)
        assert abs(force) < 0.01 and abs(radius) < 0.03
    a = np.linspace(1e-3, 3.0, 2000)
    true_depth, force = layer_theory.sneddon_sphere(RADIUS, a, G, nu)
    skin, product = pressing.sphere_on_flat(RADIUS, depth, 0.27)
    contact = thenar.Skin(*skin, materials=[pressing.material()], effects=[effect]).press(*product)
    assert abs(pressing.relative(contact.total_force_n[2], np.interp(depth, true_depth, force))) < 0.01


def test_compressible_tissue_loses_the_volume_of_its_kernel():
    """On a half space of ratio nu a point force moves (1 - nu) / (2 pi G r) at every distance."""
    skin, product = pressing.sphere_on_flat(RADIUS, 0.6, 0.3, extent=3.0)
    contact = {}
    for nu in (0.5, 0.3):
        effect = thenar.Effect("compressibility", 1.0, poisson_ratio=nu)
        contact[nu] = thenar.Skin(*skin, materials=[pressing.material()], effects=[effect]).press(*product)
    far = np.hypot(*skin[0][:, :2].T) > 6.0
    sink = {nu: -c.displacement_mm[far, 2] / c.total_force_n[2] for nu, c in contact.items()}
    np.testing.assert_allclose(sink[0.3] / sink[0.5], 0.7 / 0.5, rtol=0.01)


@pytest.mark.parametrize("thickness", [np.inf, 6.0])
@pytest.mark.parametrize(("modulus", "skin_mm", "tension"), [(1.5, 0.5, 0.0), (1.5, 0.8, 0.0), (0.5, 0.5, 0.03)])
def test_stiff_skin_is_the_layered_fourier_kernel(modulus, skin_mm, tension, thickness):
    """Force of a sphere on plate, pulp below it and bone within 0.5 % of a Hankel solve; a bare one is far off."""
    depth, bending, stretch = 0.5, modulus * skin_mm**3 / 9.0, 4.0 / 3.0 * modulus * skin_mm
    edges = np.linspace(0.0, 4.5, 151)

    def gap(r):
        return RADIUS - np.sqrt(RADIUS**2 - r * r) - depth

    plate = (bending, tension, stretch, skin_mm / 2.0)
    pulp = thickness - skin_mm * (1.0 - min(3.0 * G / modulus, 1.0))
    expected = layer_theory.force_through_skin(gap, edges, (G, 0.5, pulp), plate)
    bare, _, _ = layer_theory.press(gap, edges, G, 0.5, thickness)
    effect = thenar.Effect("stiff_skin", 1.0, modulus_mpa=modulus, thickness_mm=skin_mm, tension_n_per_mm=tension)
    skin, product = pressing.sphere_on_flat(RADIUS, depth, 0.25)
    prepared = thenar.Skin(*skin, materials=[pressing.material(thickness=thickness)], effects=[effect])
    assert prepared.press(*product).total_force_n[2] == pytest.approx(expected, rel=0.005)
    assert expected > 1.05 * bare


def test_a_stiff_skin_has_both_limits():
    """Without stiffness it is the bonded layer; very stiff, a plate on a half space sinks P (1 - nu) / (27^0.5 G l)."""
    skin, product = pressing.sphere_on_flat(RADIUS, 0.5, 0.3, extent=3.0)
    layer = thenar.Skin(*skin, materials=[pressing.material(thickness=6.0)])
    base = layer.press(*product).total_force_n[2]
    layer.set_effects([thenar.Effect("stiff_skin", 1.0, modulus_mpa=1e-5, thickness_mm=0.3)])
    assert layer.press(*product).total_force_n[2] == pytest.approx(base, rel=2e-3)
    effect = thenar.Effect("stiff_skin", 1.0, modulus_mpa=500.0, thickness_mm=3.0)
    plate = thenar.Skin(*skin, materials=[pressing.material()], effects=[effect])
    contact = plate.press(*product)
    length = np.cbrt(0.5 / G * 500.0 * 27.0 / 9.0)
    sink = 0.5 / G / (np.sqrt(27.0) * length)
    assert contact.total_force_n[2] * sink == pytest.approx(0.5, rel=0.01)
    assert contact.in_contact.sum() < 20, "a stiff plate touches a sphere at its tip"


def fung(x, _):
    return np.exp(x)


def power(x, exponent):
    return 1.0 + x**exponent


def ogden(x, exponent):
    """Secant modulus over 3 G of a one-term Ogden solid in uniaxial compression, by differences of its energy."""

    def energy(stretch):
        return 2.0 / exponent**2 * (stretch**exponent + 2.0 * stretch ** (-exponent / 2.0) - 3.0)

    stretch, step = 1.0 / (1.0 + x), 1e-6
    stress = (energy(stretch + step) - energy(stretch - step)) / (2.0 * step)
    return -stress / (1.0 - stretch) / 3.0


@pytest.mark.parametrize(("law", "growth"), [("exponential", fung), ("power", power), ("ogden", ogden)])
@pytest.mark.parametrize("exponent", [1.5, 4.0])
def test_stiffening_laws_are_their_closed_forms_and_leave_the_area(law, growth, exponent):
    skin, product = pressing.sphere_on_flat(RADIUS, 1.0, 0.5)
    prepared = thenar.Skin(*skin, materials=[pressing.material()])
    base = prepared.press(*product)
    cap = np.sqrt(1.0 / (RADIUS - 1.0 / 3.0))  # sqrt(pi d^3 / V) of a spherical cap; Hertz has a/R = sqrt(d / R)
    for measure, x in [("depth", base.regions[0].dmax_mm / 1.7), ("strain", cap / 0.5)]:
        numbers = {"law": law, "measure": measure, "exponent": exponent}
        effect = thenar.Effect("stiffening_law", 0.5, reference_depth_mm=1.7, reference_strain=0.5, **numbers)
        prepared.set_effects([effect])
        contact = prepared.press(*product)
        expected = 0.5 + 0.5 * growth(x, exponent)
        found = contact.total_force_n[2] / base.total_force_n[2]
        assert found == pytest.approx(expected, rel=1e-5 if measure == "depth" else 0.01)
        assert contact.contact_area_mm2 == pytest.approx(base.contact_area_mm2, rel=1e-3)


def test_an_inclusion_larger_than_the_contact_is_tissue_of_its_modulus():
    skin, product = pressing.sphere_on_flat(RADIUS, 0.6, 0.5)
    base = pressing.press(skin, product).total_force_n[2]
    for contrast in (0.4, 3.0):
        effect = thenar.Effect("inclusion", 0.5, radius_mm=1e4, contrast=contrast)
        prepared = thenar.Skin(*skin, materials=[pressing.material()], effects=[effect])
        expected = 1.0 + 0.5 * (contrast - 1.0)
        assert prepared.press(*product).total_force_n[2] / base == pytest.approx(expected, rel=1e-5)


def test_a_small_inclusion_draws_force_to_its_place_and_less_so_when_deep():
    skin, product = pressing.sphere_on_flat(RADIUS, 1.0, 0.5)
    near = np.hypot(skin[0][:, 0] - 1.5, skin[0][:, 1]) < 1.0

    def share(*effects):
        prepared = thenar.Skin(*skin, materials=[pressing.material()], effects=list(effects))
        force = prepared.press(*product).force_n
        return force[near].sum() / force.sum()

    def at(depth, contrast):
        return thenar.Effect("inclusion", 1.0, center_x_mm=1.5, radius_mm=1.0, depth_mm=depth, contrast=contrast)

    base, shallow, deep, soft = share(), share(at(0.0, 4.0)), share(at(2.0, 4.0)), share(at(0.0, 0.25))
    assert soft < 0.95 * base < base < deep < shallow
    assert shallow > 1.2 * base


def test_an_inclusion_deeper_than_the_tissue_is_refused():
    skin = thenar.Skin(*meshes.disc_patch(8.0, 1.0), materials=[pressing.material(thickness=5.0)])
    with pytest.raises(
        thenar.SolveError, match="depth_mm is 6, but must be less than the 5.00 mm of soft tissue there"
    ):
        skin.set_effects([thenar.Effect("inclusion", 1.0, depth_mm=6.0)])
    with pytest.raises(thenar.SolveError, match="needs model layer"):
        thenar.Skin(*meshes.disc_patch(8.0, 1.0), model="paper", effects=[thenar.Effect("bone")])


def test_the_catalogue_tells_numbers_ranges_and_sources():
    catalogue = {entry.name: entry for entry in thenar.effects()}
    for name, entry in catalogue.items():
        effect = thenar.Effect(name, 0.5)
        assert set(effect.numbers) == {n.name for n in entry.shape} | {c.name for c in entry.choices}
        assert all(
            n.source and n.low <= n.physiological[0] <= n.default <= n.physiological[1] <= n.high for n in entry.shape
        )
        assert all(sign.sentence for sign in entry.consequences) and entry.source
        for number in entry.shape if entry.kind == "tissue" else []:
            low = np.nextafter(number.low, -np.inf)
            skin = thenar.Skin(*meshes.disc_patch(4.0, 1.0))
            with pytest.raises(thenar.SolveError, match=f"effect {name}: {number.name} is .*, but must be"):
                skin.set_effects([thenar.Effect(name, 0.5, **{number.name: low})])
