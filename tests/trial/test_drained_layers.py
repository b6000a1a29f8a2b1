"""Drainage of layers in the contact model, against finite elements of a pad and spheres that it was not fitted to."""

from trial.finite_elements import drained_layers


def test_a_layers_curve_foresees_larger_spheres_and_a_half_spaces_does_not(monkeypatch):
    """Fitted to a small sphere; off by 3, 5 % of the peak load under two larger ones, less than half of the other."""
    monkeypatch.setattr(drained_layers, "SPACINGS", 5)
    monkeypatch.setattr(drained_layers, "EVALUATIONS", 6)
    missed = {}
    for curve in ("layer", "halfspace"):
        fit, missed[curve], _ = drained_layers.left("ring_finger", 1, 1.0, curve)
        assert fit < 1.0, "percent of the peak load, of the sphere that it is fitted to"
    assert missed["layer"][0] < 3.0 and missed["layer"][1] < 5.0
    for layer, half_space in zip(missed["layer"], missed["halfspace"], strict=True):
        assert layer < 0.5 * half_space
