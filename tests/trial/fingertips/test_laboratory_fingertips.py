"""The world of fingertips in a laboratory: its draws are what the docstring says, and answers are judged as written."""

import collections
import tomllib

import numpy as np
import pytest
from trial.fingertips import laboratory_fingertips as world
from trial.fingertips.session import NOISES
from trial.fingertips.tips import DEEPEST_MM, TIPS, Tip


def tip(variant="plain", stiffening=0.0, size=1.0, modulus_mpa=0.01, mirror=(1, 1)):
    return Tip("slim", variant, stiffening, size, modulus_mpa, mirror)


@pytest.mark.parametrize("key", [key for key in TIPS if not key.endswith("/map")])
def test_tables_grow_with_depth_and_are_smooth(key):
    depth, force, area = TIPS[key].astype(float).T
    assert depth[-1] == DEEPEST_MM and (np.diff(force) > 0.0).all() and (np.diff(area) > 0.0).all()
    # A convex curve, so that a bed of springs has it.
    assert (np.diff(force, 2) > 0.0).all()
    maps = TIPS[key + "/map"].astype(float)
    # Pressure acts across a curved face: its sum is more than the force along the press.
    ratio = maps.sum(axis=(1, 2)) * 0.25 / force
    assert (ratio > 0.999).all() and (ratio < (1.01 if "cylinder" in key else 1.001)).all()


def test_laws_order_as_they_must():
    deep = 2.5
    plain, stiffer = tip().force_n("plate", deep), tip(stiffening=1.0).force_n("plate", deep)
    assert 1.1 * plain < stiffer < 3.0 * plain
    assert tip().force_n("cylinder", deep) < plain < tip("spot_a").force_n("plate", deep)
    assert tip().force_n("plate", -0.1) == 0.0 == tip().area_mm2("plate", 0.0)
    # Lengths by s, forces by s^2 and modulus.
    larger = tip(size=1.1, modulus_mpa=0.02)
    assert larger.force_n("plate", 1.1 * deep) == pytest.approx(2.0 * 1.1**2 * plain, rel=1e-9)


@pytest.mark.parametrize("mirror", [(1, 1), (-1, 1)])
def test_pressure_is_highest_over_a_stiff_spot(mirror):
    spotted = tip("spot_a", mirror=mirror)
    ratio = spotted.image_kpa("plate", 2.5, 1.0) - tip(mirror=mirror).image_kpa("plate", 2.5, 1.0)
    row, col = np.unravel_index(ratio.argmax(), ratio.shape)
    peak = (np.array([row, col]) + 0.5 - 0.5 * np.array(ratio.shape)) * 0.5
    assert np.linalg.norm(peak - spotted.spot_mm) < 1.5
    assert spotted.image_kpa("plate", 2.5, 1.0).sum() * 0.25 == pytest.approx(1000.0)


@pytest.mark.parametrize("truth", world.TRUTHS)
def test_draws_are_what_they_say(truth):
    for seed in (1, 2):
        noise = NOISES[seed % len(NOISES)]
        one, again = (world.draw(seed, truth, noise) for _ in range(2))
        for a, b in zip(one.recordings, again.recordings, strict=True):
            np.testing.assert_array_equal(a.columns["force_n"], b.columns["force_n"])
        by_protocol = collections.Counter(each.protocol.split()[0] for each in one.recordings)
        assert by_protocol["cycles"] == by_protocol["slide_plate"] == 2 and by_protocol["press_plate"] >= 4
        assert [each.order for each in one.recordings] == list(range(len(one.recordings)))
        assert (one.friction > 0.0) == ("friction" in truth) and (one.pad.spot_mm is not None) == ("inclusion" in truth)
        assert (one.pad.variant == "skin") == ("stiff_skin" in truth)
        assert truth != "exponential" or one.pad.stiffening == 1.0
        along = np.concatenate([each.columns.get("tangential_force_n", []) for each in one.recordings])
        assert (np.abs(along).max() > 0.05) == ("friction" in truth)
    with pytest.raises(ValueError, match="no world"):
        world.draw(1, truth, "magic")


def top(case, frame=5):
    """Readings of the deepest frame under the plate."""
    return case.maps[0].frames[frame][3]


def test_faults_of_instruments_are_where_they_should_be():
    plain, dead, clipped = (world.draw(3, truth, "laboratory") for truth in ("nothing", "dead_cells", "mat_ceiling"))
    assert (top(clipped) == top(clipped).max()).sum() >= 3 and (top(plain) == top(plain).max()).sum() == 1
    for row, col in dead.maps[0].mat.dead:
        assert top(dead)[row, col] == 0.0 and top(dead)[row - 1 : row + 2, col - 1 : col + 2].max() > 5.0
    forces = [each.columns["force_n"] for each in world.draw(3, "saturation", "laboratory").recordings]
    largest = max(force.max() for force in forces)
    assert sum((force == largest).sum() for force in forces) > 20
    gained = world.draw(3, "mat_gain", "laboratory")
    force = max(each.columns["force_n"].max() for each in gained.recordings if each.protocol == "press_plate 2")
    assert abs(np.log(top(gained).sum() * 4e-3 / force)) > 0.25


def test_relaxation_fades_and_softening_lasts():
    relaxed = next(r for r in world.draw(4, "relaxation", "remounted").recordings if r.protocol == "press_plate 2")
    force, depth = relaxed.columns["force_n"], relaxed.columns["depth_mm"]
    held = depth > depth.max() - 0.05
    assert force[held][-3:].mean() < 0.93 * force[held][:3].mean()
    cycled = [r.columns["force_n"].max() for r in world.draw(4, "cycle_softening", "laboratory").recordings[:2]]
    assert cycled[1] < 0.97 * cycled[0]


def test_a_study_is_written_as_the_shared_ones_are(tmp_path):
    one = world.draw(5, "inclusion_and_friction", "laboratory")
    one.write(tmp_path)
    study = tomllib.loads((tmp_path / "study.toml").read_text())
    assert study["sites"]["apex"]["point_mm"][2] == pytest.approx(one.pad.semi_axes_mm[2], abs=1e-4)
    for each in study["recordings"]:
        table = np.genfromtxt(tmp_path / each["file"], delimiter=",", names=True, dtype=None, encoding=None)
        if each["kind"] == "indentation":
            assert (np.diff(table["time_s"]) > 0.0).all()
            continue
        sensels = np.genfromtxt(tmp_path / each["sensels"], delimiter=",", names=True)
        assert len(table) % len(sensels) == 0 and sensels["area_mm2"].mean() == 4.0
        if each["indenter"] == "cylinder":
            radius = 24.0 * one.pad.size
            height = sensels["z_mm"] - one.pad.semi_axes_mm[2] - radius
            np.testing.assert_allclose(np.hypot(sensels["x_mm"], height), radius, rtol=1e-4)
    assert "spot" not in (tmp_path / "study.toml").read_text()


@pytest.mark.parametrize(
    ("truth", "stiffening", "verdict", "names", "wanted"),
    [
        ("nothing", 0.0, "parameters", [], "right"),
        ("nothing", 0.0, "missing_physics", ["stiffening_law"], "wrong"),
        ("nothing", 0.0, "cannot_tell", ["bone", "stiffening_law"], "wrong"),
        ("nothing", 0.0, "unlisted", [], "wrong"),
        ("exponential", 1.0, "missing_physics", ["stiffening_law"], "right"),
        ("exponential", 1.0, "insufficient_data", [], "missed"),
        ("stiff_skin", 1.0, "missing_physics", ["stiff_skin", "stiffening_law"], "right"),
        ("stiff_skin", 0.0, "missing_physics", ["stiff_skin", "stiffening_law"], "wrong"),
        ("relaxation", 0.0, "cannot_tell", ["drainage", "relaxation"], "missed"),
        ("relaxation", 0.0, "cannot_tell", ["bone", "drainage"], "wrong"),
        ("relaxation", 0.0, "missing_physics", ["rate_independent_loss", "relaxation"], "wrong"),
        ("inclusion", 0.0, "missing_physics", ["inclusion_elsewhere"], "wrong"),
        ("friction", 1.0, "missing_physics", ["stiffening_law"], "missed"),
        ("friction", 0.0, "unlisted", [], "missed"),
        ("mat_ceiling", 0.0, "instrument", ["mat_ceiling"], "right"),
        ("mat_ceiling", 0.0, "instrument", ["saturation"], "wrong"),
        ("dead_cells", 0.0, "instrument", [], "right"),
        ("dead_cells", 0.0, "parameters", [], "missed"),
        ("dead_cells", 0.0, "missing_physics", ["inclusion"], "wrong"),
        ("mat_gain", 0.0, "instrument", ["gain"], "right"),
        ("relaxation_and_friction", 0.0, "missing_physics", ["friction", "relaxation"], "right"),
        ("relaxation_and_friction", 0.0, "missing_physics", ["friction"], "missed"),
        ("relaxation_and_mat_ceiling", 0.0, "missing_physics", ["mat_ceiling", "relaxation", "bone"], "wrong"),
        ("saturation", 0.0, "fault", ["a sentence"], "wrong"),
    ],
)
def test_answers_of_laboratories_are_judged_as_written(truth, stiffening, verdict, names, wanted):
    assert world.judged(truth, stiffening, verdict, names) == wanted


def test_names_have_the_place_of_a_spot_and_the_channel_of_a_ceiling():
    case = world.draw(1, "inclusion", "laboratory")
    near, far = (case.pad.spot_mm + [step, 0.0] for step in (1.9, 2.1))

    def placed(at):
        return {"effect": "inclusion", "channel": "map", "where": {"center_mm": [*at, 9.0]}}

    assert world.named(case, [placed(near)]) == {"inclusion"}
    assert world.named(case, [placed(far)]) == {"inclusion_elsewhere"}
    ceilings = [{"effect": "saturation", "channel": channel} for channel in ("map", "force")]
    assert world.named(case, ceilings) == {"mat_ceiling", "saturation"}
