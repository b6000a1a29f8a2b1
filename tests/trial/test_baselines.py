"""The baselines find what is planted in their own terms, say nothing of nothing, and write what the schema asks for."""

import json

import numpy as np
import pytest
from trial import cases, protocols
from trial.baselines import bic, classifier, curves, examples, fitting, forms, peers, process, verdict
from trial.scoring import findings, score

pytestmark = pytest.mark.filterwarnings("ignore::sklearn.exceptions.ConvergenceWarning")
RICH = next(name for name in cases.names("calibration") if len(cases.index()[name].get("published", [])) == 5)


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    cases.write(RICH, folder)
    return folder


@pytest.fixture(scope="module")
def planted(study):
    """A function that gives the study's curves with forces of the base and of effects by the closed forms."""
    found = curves.read(study)
    problem = fitting.Problem(found)

    def make(effects, numbers, noise, seed=1):
        random = np.random.default_rng(seed)
        force = problem.model(np.array([0.1, 0.4, *numbers]), effects, {})
        force = force + noise * force.max(axis=1, keepdims=True) * random.standard_normal(force.shape)
        force = np.where(problem.there, force, np.nan)
        kept = (found.protocols, found.orders, found.radii, found.time, found.depth)
        return curves.Curves(*kept, force, found.thickness, found.limit, found.base)

    return make


@pytest.mark.parametrize("name", [name for name, form in forms.FORMS.items() if form.act and name != "gain"])
def test_every_form_does_nothing_at_zero(study, name):
    motion = forms.Motion.of(curves.read(study))
    force = 0.01 + np.maximum(motion.depth, 0.0)
    changed = forms.FORMS[name].act(force, motion, np.array([0.0, 0.5])[: len(forms.FORMS[name].low)])
    assert np.allclose(changed, force, rtol=1e-6, atol=1e-9)


def test_the_layer_factor_is_dimitriadis():
    """Dimitriadis 2002, Eq. 13: 1 + 1.133 chi + 1.283 chi^2 + 0.769 chi^3 + 0.0975 chi^4 for nu of 1/2, bonded."""
    motion = forms.Motion(None, np.array([[0.1, 0.4]]), np.array([[10.0]]), None, 8.0, 1.0)
    chi = np.sqrt([1.0, 4.0]) / 8.0
    expected = 1.0 + 1.133 * chi + 1.283 * chi**2 + 0.769 * chi**3 + 0.0975 * chi**4
    assert forms.layer(motion, 8.0, 0.5)[0] == pytest.approx(expected, rel=2e-3)


def test_the_fading_force_is_the_hereditary_integral():
    """A step held: what is forgotten is 1 - exp(-t / tau) of it."""
    time = np.array([np.concatenate([[0.0, 1e-6], np.geomspace(0.01, 20.0, 40)])])
    force = np.where(time > 0.0, 1.0, 0.0)
    motion = forms.Motion(time, np.ones_like(time), np.array([[10.0]]), None, 8.0, 1.0)
    mean = sum(1.0 - np.exp(-time / (2.0 * factor)) for factor in forms.SPREAD) / len(forms.SPREAD)
    fading = force - forms.relaxation(force, motion, (0.5, np.log(2.0)))
    assert fading[0, 2:] == pytest.approx(0.5 * mean[0, 2:], abs=1e-4)


@pytest.mark.parametrize(("name", "numbers"), [("stiffening_law", [0.8]), ("rate_independent_loss", [0.3, -1.5])])
def test_the_curve_fitter_names_what_its_own_form_planted(planted, name, numbers):
    assert [one["effect"] for one in bic.said(planted([name], numbers, 0.01))["findings"]] == [name]


def test_the_peers_are_silent_where_the_base_made_the_curves(planted):
    clean = planted([], [], 0.01)
    assert bic.said(clean)["findings"] == []
    assert process.said(clean)["verdict"] == "parameters"


def test_the_process_sees_what_it_cannot_name(planted):
    said = process.said(planted(["rate_independent_loss"], [0.3, -1.5], 0.01))
    assert said["verdict"] == "unlisted" and said["explained"] > 0.5
    assert said["fit"]["reducible_error_removed"]["value"] > 0.2


def test_the_classifier_never_reads_the_trials_labels(monkeypatch):
    asked = []
    monkeypatch.setattr(score, "labels", lambda split: asked.append(split) or {})
    with pytest.raises(ValueError, match="not enough values"):
        classifier.labelled.__wrapped__()
    assert asked == ["calibration"]
    pads = {key.split("/")[0] for key in np.load(examples.TABLE).files}
    assert pads == {pad for pad, about in protocols.PADS.items() if about[0] == "calibration"}


@pytest.mark.parametrize("who", ["bic", "gp"])
def test_what_they_write_is_as_it_must_be(study, tmp_path, who):
    peers.BASELINES[who](RICH).diagnose(study, tmp_path / "out")
    assert findings.faults(json.loads((tmp_path / "out/findings.json").read_text())) == []
    assert peers.BASELINES[who].rows <= verdict.ALL


def test_the_gain_is_the_share_of_what_can_be_removed():
    found = verdict.gain(np.array([5.0, 2.0, 1.0]), ["slow"])
    assert found["reducible_error_removed"]["value"] == pytest.approx(0.75)
    assert "reducible_error_removed" not in verdict.gain(np.array([1.0, 1.0, 1.0]), ["slow"])


@pytest.mark.parametrize(
    ("chances", "told", "sets"),
    [
        ((0.95, 0.03, 0.02), ("missing_physics", ["bone"]), [["bone"]]),
        ((0.45, 0.05, 0.5), ("parameters", []), [[], ["bone"]]),
        ((0.49, 0.43, 0.08), ("cannot_tell", []), [["bone"], ["drift"]]),
        ((0.34, 0.33, 0.33), ("unlisted", []), [["bone"], ["drift"], []]),
    ],
)
def test_the_classifier_rejects_what_is_not_likely(study, chances, told, sets):
    class Model:
        classes_ = np.array(["bone", "drift", classifier.NOTHING])

        @staticmethod
        def predict_proba(rows):
            assert np.isfinite(rows).all()
            return np.array([chances])

    said = classifier.said(curves.read(study), Model)
    assert (said["verdict"], [one["effect"] for one in said["findings"]]) == told
    assert sorted(said["names_90"]) == sorted(sets) and findings.faults(said) == []
