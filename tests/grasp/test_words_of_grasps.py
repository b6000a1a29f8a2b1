"""What the report says of a grasp: balance, friction, a grip that falls short, a product that would slip."""

from types import SimpleNamespace

import numpy as np
from thenar_blender.grasp import words


def state(total, net):
    """A state that leaves `net` N over."""
    return SimpleNamespace(total_n=total, net_n=np.array([net, 0.0, 0.0]), imbalance=net / total)


def test_a_balanced_grasp_is_in_balance():
    assert words.held(state(200.0, 1.0), (0.0, 0.4)) == ("INFO", "In balance: 200 N of grip, 1.0 N left over")
    assert words.held(state(200.0, 1.0), (0.02, 0.4))[1].endswith("held by a friction of 0.02")


def test_friction_that_suffices_is_named():
    level, text = words.held(state(200.0, 20.0), (0.15, 0.4))
    assert level == "INFO" and text.startswith("Held by friction") and "0.15" in text


def test_a_product_that_would_slip_is_a_warning():
    level, text = words.held(state(200.0, 90.0), (0.7, 0.4))
    assert level == "WARNING" and "0.70" in text and "0.40" in text and "slip" in text
    level, text = words.held(state(200.0, 90.0), (np.inf, 0.4))
    assert level == "WARNING" and "inf" not in text


def test_a_grip_that_falls_short_says_of_how_much():
    assert "50 of 200 N of grip" in words.held(state(50.0, 0.5), (0.0, 0.4), 200.0)[1]
    assert "195 N of grip" in words.held(state(195.0, 0.5), (0.0, 0.4), 200.0)[1]
