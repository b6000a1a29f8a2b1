"""Sequential BIC: fits the base, adds the effect whose closed form lowers the BIC most while any lowers it, and stops.

The strongest such fitter that is fair to compare with: the base is that of `thenar`, the noise knows of repeats.
"""

import hashlib
from pathlib import Path

import numpy as np
from trial.baselines import forms, verdict
from trial.baselines.curves import read
from trial.baselines.fitting import Problem

MOST = 3  # effects


class Bic:
    """The curve fitter (see `running`)."""

    rows = verdict.ALL - {"spots", "miss", "spot sets", "overlap", "followed", "random"}

    def __init__(self, case=None):
        self.key = key(__file__)

    def diagnose(self, study, out):
        """Writes out/findings.json."""
        verdict.write(out, said(read(Path(study))))


def key(*files):
    """Changes with these files and with those that all baselines share."""
    here = Path(__file__).parent
    shared = [here / name for name in ("curves.py", "fitting.py", "forms.py", "verdict.py")]
    return hashlib.sha256(b"".join(Path(file).read_bytes() for file in (*files, *shared))).hexdigest()


def said(curves):
    """The verdict on a study's curves."""
    if curves is None:
        return verdict.silent("there is no curve of a sphere")
    problem = Problem(curves)
    best, last = problem.fit([], np.zeros(2)), None
    while len(best.effects) < MOST:
        tried = {name: added(problem, best, name) for name in forms.FORMS if name not in best.effects}
        leader = min(tried.values(), key=lambda fit: fit.bic())
        if leader.bic() >= best.bic():
            break
        last, best = [best, *tried.values()], leader
    names = [{"effect": name, "confidence": 1.0} for name in best.effects]
    found = verdict.of_names(names)
    found["names_90"] = kept(last) if last else [[]]
    if names:
        found["fit"] = gain(curves, problem.noise, best)
    return found


def added(problem, fit, name):
    """The best fit with one effect more, over the places to start from."""
    form, found = forms.FORMS[name], []
    if name == "gain":
        halves = sorted(set(problem.curves.orders))[1:]
        middle = halves[len(halves) // 2 - 1 : len(halves) // 2 + 1]
        found = [problem.fit([*fit.effects, name], [*fit.numbers, 0.01], {**fit.fixed, name: k}) for k in middle]
    for start in form.starts:
        found.append(problem.fit([*fit.effects, name], [*fit.numbers, *start], fit.fixed))
    return min(found, key=lambda one: one.cost) if found else fit


def kept(fits):
    """Sets of names that hold 90 % of the weight exp(-BIC / 2)."""
    worth = np.array([fit.bic() for fit in fits])
    weight = np.exp(-0.5 * (worth - worth.min()))
    order, weight = np.argsort(-weight), weight / weight.sum()
    count = int(np.searchsorted(np.cumsum(weight[order]), 0.9)) + 1
    return [sorted(fits[k].effects) for k in order[:count]]


def gain(curves, noise, best):
    """Held-out error, every protocol left out in turn, of the base and with the effects."""
    protocols, sums = np.array(curves.protocols), np.zeros(3)
    for protocol in sorted(set(protocols)):
        out = protocols == protocol
        if out.all():
            return None
        rest, whole = Problem(curves.only(~out), noise), Problem(curves.only(out), noise)
        before = rest.fit([], best.numbers[:2])
        after = rest.fit(best.effects, best.numbers, best.fixed)
        sums += verdict.errors(whole, whole.model(before.numbers, [], {}), _model(whole, after))
    return verdict.gain(sums, sorted(set(protocols)))


def _model(problem, fit):
    return problem.model(fit.numbers, fit.effects, fit.fixed)
