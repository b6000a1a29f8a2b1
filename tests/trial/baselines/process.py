"""A Gaussian process for what the base model leaves: it corrects and detects, but names nothing.

Kennedy & O'Hagan 2001: residuals of the fitted base over time since contact, depth, rate, cycle and tool radius. That
something is missing is claimed if the process fitted to one repeat of every protocol predicts the other by more than
on any of the calibration split's 40 nulls.
"""

import warnings
from pathlib import Path

import numpy as np
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
from trial.baselines import bic, verdict
from trial.baselines.curves import read
from trial.baselines.fitting import Problem

THRESHOLD = 0.10  # share of squared error that one repeat explains of the other
EVERY = 4  # samples kept
KERNEL = ConstantKernel(1e-3, (1e-7, 1.0)) * RBF(np.ones(5), (0.2, 50.0)) + WhiteKernel(1e-4, (1e-7, 1e-1))


class Process:
    """The process (see `running`)."""

    rows = {"nulls", "nulls, normal", "nulls, outliers", "nulls, slow", "nulls, wide", "unlisted", "removed by any"}

    def __init__(self, case=None):
        self.key = bic.key(__file__)

    def diagnose(self, study, out):
        """Writes out/findings.json."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ConvergenceWarning)  # a length at its bound: that input does not matter
            verdict.write(out, said(read(Path(study))))


def said(curves):
    """The verdict on a study's curves."""
    if curves is None:
        return verdict.silent("there is no curve of a sphere")
    repeat = repeats(curves)
    if repeat.max() == 0:
        return verdict.silent("there are no repeats")
    problem = Problem(curves)
    fit = problem.fit([], np.zeros(2))
    left = settled(problem, share(problem, fit))
    process = GaussianProcessRegressor(KERNEL).fit(*points(problem, left, repeat >= 0))
    kernel = process.kernel_
    explained = np.mean([across(problem, left, kernel, (repeat == k, repeat == 1 - k)) for k in (0, 1)])
    told = f"One repeat predicts {100.0 * explained:.0f} % of the other's misfit."
    found = verdict.unlisted(told) if explained > THRESHOLD else verdict.of_names([])
    found["sentence"], found["explained"] = told, float(explained)
    raw = GaussianProcessRegressor(KERNEL).fit(*points(problem, share(problem, fit), repeat >= 0))
    gained = gain(curves, problem.noise, raw.kernel_)
    return found | ({"fit": gained} if gained else {})


def repeats(curves):
    """Which repeat of its protocol each recording is."""
    return np.array([curves.protocols[:k].count(name) for k, name in enumerate(curves.protocols)])


def share(problem, fit):
    """Residuals as shares of each recording's largest force."""
    return (problem.measured - problem.model(fit.numbers, [], {})) / problem.scale


def settled(problem, left):
    """The same less what each recording's own gain and zero explain of them."""
    left = left.copy()
    for number, (basis, shrink) in enumerate(problem.white):
        here = problem.there[number]
        left[number, here] -= basis @ ((1.0 - (1.0 - shrink) ** 2) * (basis.T @ left[number, here]))
    return left


def features(problem):
    """(recordings, samples, 5): log time since contact, depth over thickness, rate, cycle, log radius."""
    motion = problem.motion
    touching = motion.depth > 0.0
    first = np.take_along_axis(motion.time, touching.argmax(axis=1)[:, None], axis=1)
    rate = np.diff(motion.depth, axis=1, prepend=motion.depth[:, :1])
    rate = rate / np.maximum(np.diff(motion.time, axis=1, prepend=motion.time[:, :1] - 1.0), 1e-6)
    falling = np.diff((rate < 0.0).astype(float), axis=1, prepend=0.0) > 0.0
    columns = [
        np.log(np.maximum(motion.time - first, 0.0) + 0.1),
        motion.depth / motion.thickness / 0.05,
        np.arcsinh(2.0 * rate),
        np.cumsum(falling, axis=1).astype(float),
        np.broadcast_to(np.log(motion.radius), motion.time.shape),
    ]
    return np.stack(columns, axis=2)


def points(problem, left, rows):
    """Features and residuals of some of the recordings, thinned."""
    kept = np.zeros_like(problem.there)
    kept[:, ::EVERY] = True
    kept &= problem.there & rows[:, None]
    return features(problem)[kept], left[kept]


def across(problem, left, kernel, rows):
    """Share of the squared residuals of the second rows that a process on the first explains."""
    process = GaussianProcessRegressor(kernel, optimizer=None).fit(*points(problem, left, rows[0]))
    where, seen = points(problem, left, rows[1])
    return 1.0 - ((seen - process.predict(where)) ** 2).sum() / (seen**2).sum()


def gain(curves, noise, kernel):
    """Held-out error, every protocol left out in turn, of the base and with the process."""
    protocols, sums = np.array(curves.protocols), np.zeros(3)
    for protocol in sorted(set(protocols)):
        out = protocols == protocol
        if out.all():
            return None
        rest, whole = Problem(curves.only(~out), noise), Problem(curves.only(out), noise)
        fit = rest.fit([], np.zeros(2))
        seen = points(rest, share(rest, fit), np.ones((~out).sum(), dtype=bool))
        process = GaussianProcessRegressor(kernel, optimizer=None).fit(*seen)
        model = whole.model(fit.numbers, [], {})
        flat = features(whole).reshape(-1, 5)
        more = process.predict(flat).reshape(model.shape) * model.max(axis=1, keepdims=True)
        sums += verdict.errors(whole, model, np.where(whole.there, model + more, 0.0))
    return verdict.gain(sums, sorted(set(protocols)))
