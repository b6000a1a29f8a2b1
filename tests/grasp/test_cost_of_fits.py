"""What makes a search quick: no posture is evaluated twice, lost ways are left, and cross products cost little."""

from types import SimpleNamespace

import numpy as np
import pytest
from thenar_blender.grasp import polishing, search, settling
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
    way, settled = SimpleNamespace(stage=None, bar=None), []
    monkeypatch.setattr(search, "_rough", lambda ready, watch: [(None, None, way)])
    monkeypatch.setattr(search, "_fine", lambda *_: grasp)
    monkeypatch.setattr(search, "_found", lambda *_: search.Found(grasp, state, 9.0, way, 0.1, (), None, {}))
    monkeypatch.setattr(settling, "settle", lambda *_: settled.append(state) or state)
    monkeypatch.setattr(polishing, "polish", lambda *_: pytest.fail("small motions lead no finger out of a wall"))
    with pytest.raises(fitter.GraspError, match="has a finger in a thin wall"):
        search._best([way], settling.Aim(np.zeros(3), np.zeros(3), 200.0), fitter.ALONE)
    assert len(settled) == 2, "a little, then to the end"
