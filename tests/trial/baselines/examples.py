"""Examples for the classifier: simulated protocols with a cause of some severity, scatter and noise, as features."""

import functools
from pathlib import Path

import numpy as np
from scipy.interpolate import PchipInterpolator
from trial import protocols
from trial.baselines import forms
from trial.baselines.curves import UNIT_MPA, Curves
from trial.baselines.stretches import residual, stretches

TABLE = Path(__file__).with_name("simulated.npz")
EACH = 120  # examples of a cause
SEVERITIES = (0.4, 6.0)  # what is left after refitting, over the noise
GAIN, ZERO_MM, MEMORY_S = 0.04, 0.02, 0.15
USUAL = 0.15  # share of examples with only some of the protocols


@functools.cache
def drawn():
    """(features, names of the causes) of all examples; "none" where nothing is missing."""
    random = np.random.default_rng(7)
    tissue = sorted({key.split("/")[1] for key in _table()} - {"none"})
    instrument = [name for name, form in forms.FORMS.items() if form.stage in (-1, 4)]
    found, names = [], []
    for cause in ["none"] * 3 + tissue + instrument:
        for _ in range(EACH):
            found.append(stretches(_noisy(_example(cause, random), random)))
            names.append(cause)
    return np.stack(found), np.array(names)


@functools.cache
def _table():
    with np.load(TABLE) as found:
        return {name: found[name].astype(float) for name in found.files}


def _example(cause, random):
    """Curves of one study with a cause, before scatter and noise, and the noise they shall get."""
    pad = str(random.choice([name for name, about in protocols.PADS.items() if about[0] == "calibration"]))
    low = np.exp(random.uniform(np.log(0.005), np.log(0.015)))
    growth, noise = (low, low * random.uniform(0.9, 2.5)), float(random.choice([0.01, 0.03], p=[0.65, 0.35]))
    shapes = sorted({key.split("/")[2] for key in _table() if key.startswith(f"{pad}/{cause}/")})
    shape = str(random.choice(shapes)) if shapes else None
    rest = _curves(pad, growth, "none", "0")
    if cause == "none":
        return rest, noise
    wanted = noise * np.exp(random.uniform(*np.log(SEVERITIES)))
    chosen = _instrument(cause, random) if shape is None else None
    whole = None if shape is None else _curves(pad, growth, cause, shape)
    least, most, curves = 0.0, 1.0, rest
    for _ in range(9):
        amount = 0.5 * (least + most)
        curves = _with(rest, whole, chosen, amount)
        least, most = (amount, most) if np.sqrt(np.nanmean(residual(curves) ** 2)) < wanted else (least, amount)
    return curves, noise


def _curves(pad, growth, effect, shape):
    """Every protocol twice, as `Curves`."""
    order, thickness = list(protocols.PROTOCOLS) * 2, protocols.PADS[pad][1]
    longest = max(len(protocols.sampled(pad, name)[0]) for name in order)
    tables, base = np.full((3, len(order), longest), np.nan), []
    for number, name in enumerate(order):
        time, depth = protocols.sampled(pad, name)
        share = np.clip(depth / (0.3 * thickness), 0.0, 1.0)
        force = _table()[f"{pad}/{effect}/{shape}/{name}"]
        force = force / UNIT_MPA * (growth[0] + (growth[1] - growth[0]) * share)
        tables[:, number, : len(time)] = time, depth, force
        base.append(_loading(pad, name))
    radii = np.array([protocols.radius(pad, protocols.PROTOCOLS[name].tool) for name in order])
    return Curves(order, np.arange(len(order)), radii, *tables, thickness, 0.3 * thickness, base)


@functools.cache
def _loading(pad, name):
    """Force over depth of the base, from the way in."""
    depth, force = protocols.sampled(pad, name)[1], _table()[f"{pad}/none/0/{name}"]
    last = int(depth.argmax()) + 1
    return PchipInterpolator(
        np.concatenate([[-1.0, 0.0], depth[:last][depth[:last] > 0.0], [2.0 * depth.max()]]),
        np.concatenate([[0.0, 0.0], force[:last][depth[:last] > 0.0], [force.max() * 2.0**1.7]]),
    )


def _instrument(cause, random):
    """How an instrument errs: at the largest amount."""
    sign = random.choice([-1.0, 1.0])
    most = {"gain": sign * 0.6, "offset": sign * 0.3, "drift": sign * 0.05, "timing": 0.25}
    return cause, most.get(cause, {"saturation": 0.7, "threshold": 0.25, "fixture_compliance": 0.4}.get(cause))


def _with(rest, whole, chosen, amount):
    """An amount of an effect (between none and the whole), or of an instrument's error."""
    if whole is not None:
        return _replaced(rest, rest.depth, rest.force + amount * (whole.force - rest.force))
    cause, most = chosen
    if cause == "fixture_compliance":
        yielding = amount * most * np.nanmax(rest.depth) / float(rest.scale().max())
        return _replaced(rest, rest.depth + yielding * np.maximum(rest.force, 0.0), rest.force)
    motion, force = forms.Motion.of(rest), np.nan_to_num(rest.force)
    numbers = (amount * most, len(rest.orders) // 2) if cause == "gain" else (amount * most,)
    changed = forms.FORMS[cause].act(force, motion, numbers)
    return _replaced(rest, rest.depth, np.where(np.isfinite(rest.force), changed, np.nan))


def _replaced(curves, depth, force):
    kept = (curves.protocols, curves.orders, curves.radii, curves.time)
    return Curves(*kept, depth, force, curves.thickness, curves.limit, curves.base)


def _noisy(example, random):
    """Scatter between presses and colored noise; now and then only some of the protocols."""
    (curves, noise), count = example, len(example[0].orders)
    gains = 1.0 + GAIN * random.standard_normal((count, 1))
    depth = curves.depth + ZERO_MM * random.standard_normal((count, 1))
    force = curves.force * gains
    step = np.diff(curves.time, axis=1, prepend=curves.time[:, :1])
    keep, white = np.exp(-np.nan_to_num(step) / MEMORY_S), random.standard_normal(force.shape)
    for k in range(1, force.shape[1]):
        white[:, k] = keep[:, k] * white[:, k - 1] + np.sqrt(1.0 - keep[:, k] ** 2) * white[:, k]
    found = _replaced(curves, depth, force + noise * np.nanmax(force, axis=1, keepdims=True) * white)
    if random.random() > USUAL:
        return found
    kept = set(random.choice(list(protocols.PROTOCOLS), random.integers(1, 4), replace=False))
    return found.only(np.array([name in kept for name in found.protocols]))
