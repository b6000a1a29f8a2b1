"""Least squares of base and effects on curves, in the noise of the repeats: what curve fitter and process stand on.

Noise of a recording: `sigma` (a share of its largest force), which forgets within a time, plus a gain and a zero of
their own, whose spreads come from the repeats, if there are any; residuals are whitened by that.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import least_squares
from trial.baselines import forms
from trial.baselines.curves import UNIT_MPA

GAIN, ZERO_MM, SIGMA = 0.04, 0.02, 0.02  # where no repeats tell
MEMORY_S = (0.02, 0.05, 0.1, 0.2, 0.4, 0.8)
LEAST = (0.01, 0.005, 0.003)


@dataclass
class Fit:
    """Parameters by effect (`base`: log G0, log Glim over UNIT_MPA), whitened residuals, their sum of squares."""

    effects: list
    numbers: np.ndarray
    residual: np.ndarray
    cost: float
    fixed: dict = field(default_factory=dict)

    def bic(self):
        """n log(RSS / n) + k log n."""
        count = len(self.residual)
        return count * np.log(self.cost / count) + (len(self.numbers) + len(self.fixed)) * np.log(count)


class Problem:
    """The recordings with their noise, ready to be fitted."""

    def __init__(self, curves, noise=None):
        self.curves, self.motion = curves, forms.Motion.of(curves)
        self.there = np.isfinite(curves.force)
        self.measured = np.where(self.there, curves.force, 0.0)
        self.scale = curves.scale()
        self._loaded = {}
        start = self._least(np.zeros(2), [], {}, np.ones_like(self.scale))
        self.noise = noise or _noise(self, self.model(start.numbers, [], {}))
        self._whiten(self.model(start.numbers, [], {}))

    def model(self, numbers, effects, fixed):
        """Forces (recordings, samples) of base and effects."""
        g0, limit = UNIT_MPA * np.exp(numbers[:2])
        parts, at = {}, 2
        for name in effects:
            count = len(forms.FORMS[name].low) - (name in fixed)
            parts[name] = (
                np.append(numbers[at : at + count], fixed[name]) if name in fixed else numbers[at : at + count]
            )
            at += count
        depth = self.motion.depth
        if "fixture_compliance" in parts:
            away = parts["fixture_compliance"][0] * depth.max() * np.maximum(self.measured, 0.0) / self.motion.scale
            depth = depth - away
        base = self._base(depth)
        force = base * (g0 + (limit - g0) * np.clip(depth / self.curves.limit, 0.0, 1.0)) / UNIT_MPA
        for name in sorted((name for name in effects if forms.FORMS[name].act), key=_stage):
            force = forms.FORMS[name].act(force, self.motion, parts[name])
        return np.where(self.there, force, 0.0)

    def fit(self, effects, start, fixed=None):
        """From numbers to start with, within the bounds of the effects."""
        return self._least(np.asarray(start, dtype=float), effects, fixed or {}, None)

    def whitened(self, residual):
        """Residuals (N) in units of their noise, one row after the other."""
        out = []
        for number, (basis, shrink) in enumerate(self.white):
            row = (residual[number] / self.scale[number] / self.noise[2])[self.there[number]]
            row = self._fresh(row, number)
            out.append(row - basis @ (shrink * (basis.T @ row)))
        return np.concatenate(out)

    def _fresh(self, rows, number):
        """What of every sample the one before does not foretell, for noise that forgets in the recording's time."""
        keep = np.exp(-np.diff(self.motion.time[number][self.there[number]]) / self.noise[3])
        keep = keep.reshape((-1,) + (1,) * (rows.ndim - 1))
        return np.concatenate([rows[:1], (rows[1:] - keep * rows[:-1]) / np.sqrt(1.0 - keep**2)])

    def _least(self, start, effects, fixed, plain):
        low, high = [-4.0, -4.0], [5.0, 5.0]
        for name in effects:
            keep = len(forms.FORMS[name].low) - (name in fixed)
            low += forms.FORMS[name].low[:keep]
            high += forms.FORMS[name].high[:keep]

        def residual(numbers):
            left = self.measured - self.model(numbers, effects, fixed)
            return (left / self.scale)[self.there] if plain is not None else self.whitened(left)

        inside = np.clip(start, np.array(low) + 1e-9, np.array(high) - 1e-9)
        found = least_squares(residual, inside, bounds=(low, high), x_scale="jac", max_nfev=20, xtol=1e-4, ftol=1e-5)
        return Fit(list(effects), found.x, found.fun, float(found.fun @ found.fun), dict(fixed))

    def _base(self, depth):
        key = None if depth is self.motion.depth else id(depth)
        if key is None and "base" in self._loaded:
            return self._loaded["base"]
        found = np.stack([one(row) for one, row in zip(self.curves.base, np.maximum(depth, 0.0), strict=True)])
        if key is None:
            self._loaded["base"] = found
        return found

    def _whiten(self, model):
        """By recording: a basis of its nuisances, and how much of each is taken off."""
        gain, zero, sigma, _ = self.noise
        self.white = []
        for number in range(len(model)):
            here = self.there[number]
            columns = np.stack([gain * model[number], zero * _slope(model[number], self.motion, number)], axis=1)
            columns = self._fresh(columns[here] / self.scale[number] / sigma, number)
            basis, strength, _ = np.linalg.svd(columns, full_matrices=False)
            self.white.append((basis, 1.0 - 1.0 / np.sqrt(1.0 + strength**2)))


def _stage(name):
    return forms.FORMS[name].stage


def _slope(force, motion, number):
    """Change of a recording's force with its depth, N/mm, as on its deepest way in."""
    depth = np.maximum(motion.depth[number], 0.0)
    return 1.5 * force / np.maximum(depth, 0.02 * depth.max()) * (depth > 0.0)


def _noise(problem, model):
    """(gain, zero mm, sigma, memory s) from repeats of protocols; the usual where there are none."""
    gains, zeros, rest, steps = [], [], [], []
    protocols = np.array(problem.curves.protocols)
    for protocol in sorted(set(protocols)):
        rows = np.flatnonzero(protocols == protocol)
        for one, two in zip(rows[:-1], rows[1:], strict=True):
            here = problem.there[one] & problem.there[two]
            gap = (problem.measured[one] - problem.measured[two])[here] / problem.scale[one]
            slope = _slope(model[one], problem.motion, one)
            shift = (problem.motion.depth[one] - problem.motion.depth[two])[here]
            columns = np.stack([model[one][here], slope[here]], axis=1) / problem.scale[one]
            found = np.linalg.lstsq(columns, gap, rcond=None)[0]
            gains.append(found[0])
            zeros.append(found[1] - np.median(shift))
            rest.append((gap - columns @ found) / np.sqrt(2.0))
            steps.append(np.diff(problem.motion.time[one][here]))
    if not gains:
        return GAIN, ZERO_MM, SIGMA, MEMORY_S[0]
    spread = [np.sqrt(np.mean(np.square(values)) / 2.0) for values in (gains, zeros)]
    sigma = np.median([one.std() for one in rest])
    return (*np.maximum([*spread, sigma], LEAST), _memory(rest, steps))


def _memory(rest, steps):
    """The time in which noise forgets, s: the likeliest of MEMORY_S."""

    def cost(memory):
        total = 0.0
        for left, step in zip(rest, steps, strict=True):
            keep = np.exp(-step / memory)
            fresh = (left[1:] - keep * left[:-1]) / left.std()
            total += (fresh**2 / (1.0 - keep**2) + np.log(1.0 - keep**2)).sum()
        return total

    return min(MEMORY_S, key=cost)
