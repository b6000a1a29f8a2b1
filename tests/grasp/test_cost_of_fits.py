"""What makes a search quick: no posture is evaluated twice, lost ways are left, and cross products cost little."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from thenar_blender.grasp import polishing, search, settling, ways
from thenar_blender.grasp_fit import fitter
from thenar_blender.grasp_fit.least_squares import Problem, minimize
from thenar_blender.hand import skinning


def test_a_fit_evaluates_no_posture_twice():
    """Rosenbrock's valley above 0.5: many steps fail, so that damping rises; each of them costs one evaluation."""
    asked = []

    def residuals(x):
        asked.append(tuple(x))
        return np.array([10.0 * (x[1] - x[0] ** 2), 1.0 - x[0], 0.5])

    def jacobian(x):
        assert tuple(x) == asked[-1], "slopes are those of the posture that was evaluated last"
        return np.array([[-20.0 * x[0], 10.0], [-1.0, 0.0], [0.0, 0.0]])

    wide = np.full(2, 9.0)
    problem = Problem(residuals, jacobian, -wide, wide, lambda values: np.zeros(3, bool))
    found = minimize(problem, np.array([-1.2, 1.0]), evaluations=200, tolerance=1e-6)
    assert found.x == pytest.approx([1.0, 1.0], abs=1e-4)
    assert len(asked) == found.evaluations == len(set(asked))


@pytest.mark.parametrize("seed", (2, 3, 4, 5, 9, 10, 11))
def test_a_fit_ends_at_the_best_place_within_its_bounds(seed):
    """Linear and badly scaled, so that a step cut off at a bound leads uphill; every set of bounds tried by itself."""
    rng, count = np.random.default_rng(seed), 6
    scales = np.diag(10.0 ** rng.uniform(-1.0, 1.0, count))
    slopes = rng.normal(size=(9, count)) @ scales @ rng.normal(size=(count, count))
    wanted, wide = 20.0 * rng.normal(size=9), rng.uniform(0.1, 2.0, count)
    none = np.zeros(9, bool)
    problem = Problem(lambda x: slopes @ x - wanted, lambda x: slopes, -wide, wide, lambda values: none, is_narrow=True)
    found = minimize(problem, np.zeros(count), evaluations=8, tolerance=1e-9)
    best = np.inf
    for at in itertools.product((-1.0, 0.0, 1.0), repeat=count):
        x, free = np.array(at) * wide, np.array(at) == 0.0
        x[free] = np.linalg.lstsq(slopes[:, free], wanted - slopes @ x, rcond=None)[0]
        if (np.abs(x) <= wide * (1.0 + 1e-12)).all():
            best = min(best, 0.5 * float(np.sum((slopes @ x - wanted) ** 2)))
    assert found.cost == pytest.approx(best, rel=1e-3)


@pytest.mark.parametrize("shapes", [((3,), (3,)), ((7, 3), (3,)), ((4, 3), (5, 4, 3)), ((4, 3), (6, 1, 3))])
def test_cross_products_have_the_bits_of_numpys(shapes):
    random = np.random.default_rng(3)
    first, second = (random.normal(size=shape) for shape in shapes)
    assert (skinning.cross(first, second) == np.cross(first, second)).all()


def test_a_way_with_a_finger_in_a_wall_is_settled_but_not_polished(monkeypatch):
    grasp = SimpleNamespace(warnings=(fitter.CROSSED_TEXT,))
    state = SimpleNamespace(
        grasp=grasp, sunk_mm=0.0, imbalance=0.1, lever=0.3, peaks_mpa=np.array([0.2]), total_n=150.0
    )
    way, settled = SimpleNamespace(stage=None, bar=None, aim=lambda aim: aim), []
    monkeypatch.setattr(search, "_rough", lambda ready, watch: [(None, None, way)])
    monkeypatch.setattr(search, "_fine", lambda *_: grasp)
    monkeypatch.setattr(search, "_found", lambda *_: search.Found(grasp, state, 9.0, way, 0.1, (), None, {}))
    monkeypatch.setattr(settling, "settle", lambda *_: settled.append(state) or state)
    monkeypatch.setattr(polishing, "polish", lambda *_: pytest.fail("small motions lead no finger out of a wall"))
    with pytest.raises(fitter.GraspError, match="has a finger in a thin wall"):
        search._best([way], settling.Aim(np.zeros(3), np.zeros(3), 200.0), fitter.ALONE)
    assert len(settled) == 2, "a little, then to the end"


def aim_of(total_n=200.0):
    return settling.Aim(np.zeros(3), np.zeros(3), total_n)


def state_of(net_n, warnings=()):
    grasp = SimpleNamespace(warnings=warnings)
    return settling.State(grasp, None, 200.0, np.array([net_n, 0.0, 0.0]), np.zeros(3), np.array([0.1]))


def test_a_finger_in_a_wall_costs_more_than_balance_gains():
    crossed = state_of(0.0, (fitter.CROSSED_TEXT,))
    assert settling.is_settled(state_of(0.0), aim_of()) and not settling.is_settled(crossed, aim_of())
    assert settling.cost_of(crossed, aim_of()) > settling.cost_of(state_of(70.0), aim_of())


class Slide:
    """A grasp that one motion, along x, brings into balance at 2 mm; a thin wall stands at `wall_mm`."""

    def __init__(self, monkeypatch, wall_mm):
        joints = SimpleNamespace(bones={})
        self.stage = SimpleNamespace(
            hand=SimpleNamespace(joints=joints, pads=[]), fit=SimpleNamespace(wish=fitter.Wish({}))
        )
        self.first = fitter.Grasp(np.zeros((1, 3)), np.eye(4), {}, {}, 0.0, 0, 0.0, (), None)
        self.wall_mm = wall_mm
        monkeypatch.setattr(settling, "pressed", lambda stage, grasp, aim, cancel=None: self.state(grasp))
        monkeypatch.setattr(fitter, "is_crossed", lambda hand, grasp: grasp.place[0, 3] > wall_mm)
        monkeypatch.setattr(fitter, "refit", self.read)

    def read(self, hand, grasp, *_):
        warnings = (fitter.CROSSED_TEXT,) if grasp.place[0, 3] > self.wall_mm else ()
        return fitter.Grasp(grasp.angles, grasp.place, {}, {}, 0.0, 0, 0.0, warnings, None)

    def state(self, grasp):
        net = np.array([20.0 * (2.0 - grasp.place[0, 3]), 0.0, 0.0])
        return settling.State(grasp, None, 200.0, net, np.zeros(3), np.array([0.1]))

    def polished(self):
        before = self.state(self.first)
        after = polishing.polish(self.stage, before, aim_of())
        return before, after, after.grasp.place[0, 3]


def test_small_motions_find_the_balance(monkeypatch):
    _, after, moved_mm = Slide(monkeypatch, 99.0).polished()
    assert settling.is_settled(after, aim_of())
    assert moved_mm == pytest.approx(2.0, abs=0.3)


@pytest.mark.parametrize("wall_mm", [0.0, 0.6, 1.3])
def test_small_motions_lead_through_no_wall_and_end_no_worse(monkeypatch, wall_mm):
    before, after, moved_mm = Slide(monkeypatch, wall_mm).polished()
    assert moved_mm <= wall_mm
    assert fitter.CROSSED_TEXT not in after.grasp.warnings
    assert settling.cost_of(after, aim_of()) <= settling.cost_of(before, aim_of())


@pytest.mark.parametrize(("left_n", "kept"), [((30.0, 60.0, 110.0, 110.0), 0), ((60.0, 40.0, 20.0, 45.0), 2)])
def test_a_way_ends_where_it_is_balanced_best(monkeypatch, left_n, kept):
    """Each of settling, polishing and freeing the thumb may end worse than it began; touch and place do not count."""
    states, way = [state_of(net) for net in left_n], SimpleNamespace(stage=None, bar=None, aim=lambda aim: aim)
    scores = {id(state): 10.0 - place for place, state in enumerate(reversed(states))}

    def found(state, aim, way):
        return search.Found(state.grasp, state, scores[id(state)], way, 0.1, (), None, {})

    after = iter(states[1:])
    monkeypatch.setattr(search, "_rough", lambda ready, watch: [(None, None, way)])
    monkeypatch.setattr(search, "_fine", lambda *_: states[0].grasp)
    monkeypatch.setattr(search, "_found", found)
    monkeypatch.setattr(search, "_settled", lambda *_: next(after))
    monkeypatch.setattr(search, "_with_thumb_freed", lambda *_: next(after))
    monkeypatch.setattr(search, "_refuse_what_does_not_hold", lambda state: None)
    monkeypatch.setattr(settling, "settle", lambda *_: states[0])
    monkeypatch.setattr(polishing, "polish", lambda *_: next(after))
    best = search._best([way], aim_of(), fitter.ALONE)
    assert best[0].state is states[kept]


def found_of(score, friction, kind=ways.POWER, net_n=8.0):
    way = SimpleNamespace(kind=kind, stage=None, bar=None, aim=lambda aim: aim)
    causes = {"settled": 3.0, "touch": score - 3.0}
    return search.Found(state_of(net_n).grasp, state_of(net_n), score, way, friction, (), None, causes)


@pytest.mark.parametrize(("friction", "first"), [(0.02, 9.0), (0.9, 7.0)])
def test_a_way_balanced_a_little_goes_behind_one_that_is_held(friction, first):
    """Pads that touch better do not outweigh a fifth of the forces left over; where the product slips they may."""
    ended, begun = found_of(9.0, friction), found_of(7.0, 0.2, net_n=40.0)
    ranked = search._behind([ended], [begun])
    assert ranked[0].score == first
    assert all(one.score == pytest.approx(sum(one.causes.values())) for one in ranked), "causes explain the score"


def test_a_way_balanced_a_little_goes_behind_one_that_balancing_settled(monkeypatch):
    """The first way settles while it is balanced to the end; the second stays as it is, 20 % left over."""
    begun = [found_of(5.0, 0.1, net_n=40.0), found_of(6.0, 0.3, net_n=40.0)]
    ended = found_of(7.0, 0.1, net_n=0.0)
    monkeypatch.setattr(search, "_settled", lambda *_: ended.state)
    monkeypatch.setattr(search, "_found", lambda state, aim, way: ended)
    for further in (polishing, "polish"), (search, "_with_thumb_freed"):
        monkeypatch.setattr(*further, lambda stage, state, *_: state)
    monkeypatch.setattr(search, "_faced", lambda one, aim, watch: one)
    monkeypatch.setattr(search, "_averted", lambda way, grasp: 0.0)
    ranked = search._ended(begun, aim_of(), fitter.ALONE)
    assert ranked[0].state is ended.state and ranked[1].state is begun[1].state


@pytest.mark.parametrize(
    ("pinched", "ended", "best"),
    [(0.1, [ways.PINCH], ways.PINCH), (None, [ways.PINCH, ways.POWER], ways.POWER)],
    ids=["held", "refused"],
)
def test_a_hopeless_power_grip_is_balanced_only_where_no_pinch_holds(monkeypatch, pinched, ended, best):
    seen = []
    monkeypatch.setattr(settling, "is_settled", lambda state, aim: True)

    def end(begun, aim, watch, most=np.inf):
        seen.append(begun[0].way.kind)
        if seen[-1] == ways.PINCH and pinched is None:
            raise fitter.GraspError("none")
        return begun

    begun = {30.0: [found_of(5.0, pinched, ways.PINCH)], 200.0: [found_of(2.0 * search.HOPELESS, 0.3)]}
    monkeypatch.setattr(search, "stage_of", lambda fit: None)
    monkeypatch.setattr(ways, "powers", lambda *_: [])
    monkeypatch.setattr(ways, "pinched", lambda *_: [])
    monkeypatch.setattr(search, "_begun", lambda ready, aim, watch: begun[aim.total_n])
    monkeypatch.setattr(search, "_ended", end)
    monkeypatch.setattr(search, "_finished", lambda one, seconds: one)
    found = search.search(None, asked=search.Asked(200.0, 30.0))
    assert seen == ended and found[0].way.kind == best
