"""Effects that remember, against closed forms: Lee & Radok, Ting, the drainage master curve, and their own laws."""

import numpy as np
import pytest
import thenar
from proof import meshes, pressing
from proof.theory import viscoelastic_theory as theory

RADIUS = 10.0  # mm
TIMES = (0.004, 0.07, 1.4)  # s, Pawluk & Howe 1999
DOWN = (0.0, 0.0, -1.0)
ELASTIC = theory.elastic_sphere(pressing.SHEAR_MODULUS, RADIUS, 1.2)


def half_space(spacing=0.5, reach=4.6, **more):
    return thenar.Skin(*meshes.disc_patch(1.7 * reach, spacing), materials=[pressing.material(**more)])


def touching_sphere(radius=RADIUS, depth=1.0):
    reach = np.sqrt(2.0 * radius * depth)
    return meshes.sphere(radius, (0.0, 0.0, radius), 1.25 * reach, reach / 45.0)


def run(skin, times, depths, *effects, sphere=None):
    protocol = {"time_s": times, "offset_mm": depths}
    return skin.run(protocol, *(sphere or touching_sphere()), direction=DOWN, effects=list(effects))


@pytest.mark.parametrize("seconds", [0.05, 0.5, 5.0])
def test_loading_at_any_speed_is_lee_and_radok(seconds):
    """Force within 1 %, contact radius within 3 %, from the first third of the ramp on."""
    amplitude = 0.6
    times = np.linspace(0.0, seconds, 61)
    depths = times / seconds
    course = run(half_space(), times, depths, thenar.Effect("relaxation", amplitude))
    relaxation = theory.prony(amplitude, TIMES, (1, 1, 1))
    expected = [theory.ting(relaxation, lambda t: t / seconds, ELASTIC, t) for t in times]
    force, radius = np.array(expected).T
    late = depths > 0.34
    np.testing.assert_allclose(course.force_n[late], force[late], rtol=0.01)
    found = np.sqrt(course.contact_area_mm2[late] / np.pi)
    np.testing.assert_allclose(found, radius[late], rtol=0.03)


def test_unloading_is_ting():
    """Force within 1 % of the peak, contact radius within 3 % of the largest, until the sphere leaves."""
    amplitude, up, away = 0.6, 1.0, 1.0
    times = np.linspace(0.0, up + away, 161)

    def path(t):
        return np.minimum(t / up, 1.0 - (t - up) / away)

    course = run(half_space(), times, path(times), thenar.Effect("relaxation", amplitude))
    relaxation = theory.prony(amplitude, TIMES, (1, 1, 1))
    expected = [theory.ting(relaxation, path, ELASTIC, t) for t in times]
    force, radius = np.array(expected).T
    np.testing.assert_allclose(course.force_n, force, atol=0.01 * force.max())
    found = np.sqrt(course.contact_area_mm2 / np.pi)
    wide = radius > 0.5 * radius.max()
    np.testing.assert_allclose(found[wide], radius[wide], rtol=0.03)
    assert force[-10] == 0.0 and course.force_n[-10] < 1e-9, "the sphere leaves before the surface is back"


def test_a_step_relaxes_by_the_prony_series_and_its_area_stays():
    amplitude = 0.5
    times = np.concatenate([[0.0], np.geomspace(1e-3, 20.0, 60)])
    course = run(half_space(), times, np.ones_like(times), thenar.Effect("relaxation", amplitude))
    expected = theory.prony(amplitude, TIMES, (1, 1, 1))(times)
    np.testing.assert_allclose(course.force_n / course.force_n[0], expected, rtol=1e-3)
    np.testing.assert_allclose(course.contact_area_mm2, course.contact_area_mm2[0], rtol=0.01)


def test_a_held_force_creeps_to_the_equilibrium_depth():
    """At constant force the depth ends where the long-term elastic half space lies: d^1.5 grows by 1 / g."""
    amplitude = 0.5
    times = np.concatenate([[0.0], np.geomspace(0.01, 60.0, 50)])
    course = half_space(reach=7.0).run(
        {"time_s": times, "force_n": np.full_like(times, 0.12)},
        *touching_sphere(depth=2.0),
        direction=DOWN,
        effects=[thenar.Effect("relaxation", amplitude)],
    )
    np.testing.assert_allclose(course.force_n, 0.12, rtol=1e-3)
    assert pressing.relative((course.offset_mm[-1] / course.offset_mm[0]) ** 1.5, 2.0) == pytest.approx(0.0, abs=0.01)
    assert (np.diff(course.offset_mm) > -1e-6).all()


@pytest.mark.parametrize("depth", [0.25, 1.0])
def test_drainage_follows_the_master_curve_in_time_over_area(depth):
    """Two depths, contact radii 1 : 2: one curve of D t / a^2, within 1 % of the force, down to F0 / (2 (1 - nu))."""
    diffusivity, drained = 0.5, 0.3
    a2 = RADIUS * depth
    times = np.concatenate([[0.0], np.geomspace(1e-3, 30.0, 80) * a2 / diffusivity])
    effect = thenar.Effect("drainage", 1.0, diffusivity_mm2_per_s=diffusivity, drained_poisson_ratio=drained)
    skin = half_space(spacing=0.5 * np.sqrt(depth), reach=4.6 * np.sqrt(depth))
    course = run(skin, times, np.full_like(times, depth), effect, sphere=touching_sphere(depth=depth))
    lasting = 0.5 / (1.0 - drained)
    expected = lasting + (1.0 - lasting) * theory.master_curve(diffusivity * times / a2)
    np.testing.assert_allclose(course.force_n / course.force_n[0], expected, rtol=0.01)


@pytest.mark.parametrize("radius", [3.0, 12.0, 40.0])
def test_a_drained_layer_bears_what_compressible_tissue_bears(radius):
    """Fast, the undrained force; in the end, within 4 % of it, that of compressible tissue."""
    depth, thickness, drained = 0.6, 5.0, 0.3
    contact = np.sqrt(radius * depth)
    skin, _ = pressing.sphere_on_flat(radius, depth, contact / 12.0)
    softer = thenar.Effect("compressibility", 1.0, poisson_ratio=drained)
    drains = thenar.Effect("drainage", 1.0, drained_poisson_ratio=drained, curve="layer", radius_mm=3.0)
    times = np.concatenate([np.linspace(0.0, 1e-4, 13), np.geomspace(1e-2, 1e5, 30)])
    depths = np.minimum(times / 1e-4, 1.0) * depth
    prepared = thenar.Skin(*skin, materials=[pressing.material(thickness=thickness)])

    def forces(*effects):
        return run(prepared, times, depths, *effects, sphere=touching_sphere(radius, depth)).force_n

    elastic, with_fluid = forces(), forces(drains)
    assert with_fluid[12] == pytest.approx(elastic[12], rel=0.02), "fast, nothing drains"
    assert with_fluid[-1] == pytest.approx(forces(softer)[-1], abs=0.04 * elastic[12])


def test_a_layer_drains_with_time_alone_whatever_the_steps():
    """Pressed in one row, out, and less deep again, all fast: the elastic forces, though shares follow the contact."""
    prepared = thenar.Skin(*meshes.disc_patch(8.0, 0.4), materials=[pressing.material(thickness=4.0)])
    drains = thenar.Effect("drainage", 1.0, curve="layer", radius_mm=1.0)
    times, depths = np.arange(8) * 1e-6, np.array([1.0, 1.0, 1.0, -0.1, -0.1, 0.2, 0.2, 0.8])
    elastic, with_fluid = run(prepared, times, depths).force_n, run(prepared, times, depths, drains).force_n
    np.testing.assert_allclose(with_fluid, elastic, rtol=1e-3, atol=1e-6)


def test_cycles_soften_by_their_law_and_rest_restores():
    """Peaks fall as 1 - alpha (1 - exp(-travel / c)); 5 s of rest restore little, 5 min nearly all."""
    alpha, travel, recovery, depth = 0.4, 3.0, 60.0, 1.0
    skin, effect = half_space(1.0), thenar.Effect("cycle_softening", alpha, travel_mm=travel, recovery_s=recovery)

    def cycles(rest):
        ups = [(i * 1.0 + 0.5, depth) for i in range(6)]
        downs = [(i * 1.0 + 1.0, -1e-3) for i in range(6)]
        rows = sorted([(0.0, -1e-3), *ups, *downs, (6.0 + rest, -1e-3), (6.5 + rest, depth)])
        times, depths = np.array(rows).T
        course = run(skin, times, depths, effect)
        return course.force_n[depths == depth]

    def softened(used):
        return 1.0 - alpha * used

    elastic = run(skin, [0.0], [depth]).force_n[0]
    for rest in (5.0, 300.0):
        peaks, used, expected = cycles(rest), 0.0, []
        for cycle in range(7):
            if cycle:
                pause = 0.5 + (rest if cycle == 6 else 0.0)
                used *= np.exp(-pause / recovery)
            used = 1.0 - (1.0 - used) * np.exp(-depth / travel)
            expected.append(elastic * softened(used))
        np.testing.assert_allclose(peaks, expected, rtol=5e-3)
    assert peaks[-1] > 0.99 * peaks[0]


def test_the_loop_without_a_clock_is_the_same_at_every_speed():
    """Four decades of speed, one loop area; a hold loses no force; with relaxation in its place the areas differ."""
    skin = half_space(1.0)
    depths = np.concatenate([np.linspace(0.0, 1.0, 31), np.linspace(1.0, 0.0, 31)[1:]])
    loss = thenar.Effect("rate_independent_loss", 0.6, length_mm=0.5)

    def loop(effect, seconds):
        course = run(skin, np.linspace(0.0, seconds, len(depths)), depths, effect)
        return course.work_mj[-1], course.work_mj.max()

    areas = [loop(loss, seconds)[0] for seconds in (0.02, 0.2, 2.0, 20.0, 200.0)]
    np.testing.assert_allclose(areas, areas[0], rtol=1e-9)
    lost, put_in = loop(loss, 1.0)
    assert 0.2 < lost / put_in < 0.6
    with_clock = [loop(thenar.Effect("relaxation", 0.6), seconds)[0] for seconds in (0.2, 200.0)]
    assert max(with_clock) > 1.2 * min(with_clock)
    held = run(skin, [0.0, 0.5, 1.0, 10.0, 100.0], [0.0, 0.5, 1.0, 1.0, 1.0], loss).force_n
    np.testing.assert_allclose(held[3:], held[2], rtol=1e-3)


def test_a_protocol_that_cannot_be_followed_is_refused_in_one_sentence():
    skin, sphere = half_space(2.0), touching_sphere()
    for protocol, words in [
        ({"time_s": [0.0, 0.0], "depth_mm": [0.0, 1.0]}, "row 1: time_s is 0"),
        ({"time_s": [0.0], "depth_mm": [np.inf]}, "row 0: depth_mm is inf"),
        ({"time_s": [0.0], "force_n": [-1.0]}, "row 0: force_n is -1"),
        ({"time_s": [0.0], "force_n": [1.0], "depth_mm": [1.0]}, "row 0: more than one"),
        ({"time_s": [0.0, 1.0], "force_n": [1.0, np.nan]}, "row 1: give one of"),
        ({"time_s": [], "depth_mm": []}, "no rows"),
        ({"time_s": [0.0], "deep": [1.0]}, "no column"),
    ]:
        with pytest.raises(thenar.SolveError, match=words):
            skin.run(protocol, *sphere, direction=DOWN)
    for number in ("time_1_s", "time_2_s", "time_3_s"):
        with pytest.raises(thenar.SolveError, match=f"{number} is 0, but must be from"):
            skin.set_effects([thenar.Effect("relaxation", 0.5, **{number: 0.0})])
    assert skin.effects == []
