"""How much of the trial an oracle could answer: one that knows every cause's form and the noise, and only weighs.

    python -m trial.ceiling [--split trial]      (in `tests`)

What separates two explanations of a case is the length, in units of its noise, of what a cause adds to the curves once
G0 and Glim are refitted and every press may have its own gain (4 %) and first touch (0.02 mm): `detect` against no
cause, `name` against the closest other single effect (its amplitude refitted too). With a detect of SEEN a cause that
is known in form is found in half of the draws at 1 % false alarms over a list of twenty; with a name of TOLD its
evidence leads by LEAD in half of them. `expected` is the share that such an oracle would name: no diagnosis of these
recordings can be asked for much more. Reads the labels: for judging the trial, not for tuning.
"""

import argparse

import numpy as np
from scipy.stats import norm
from trial import cases, counts, make_cases, observing, protocols, score

SEEN, LEAD = 3.3, 5.0
TOLD = (2.0 * LEAD) ** 0.5
STEP_MM = 1e-3


class Case:
    """A case's recordings in the units of their noise, with what is refitted taken out."""

    def __init__(self, name, label):
        about = cases.index()[name]
        self.label, self.pad = label, about["pad"]
        self.growth, published = label["g_mpa"], set(about["published"])
        self.kept = [k for k, press in enumerate(self._presses("none", 0.0)) if press.protocol in published]
        self.rest = self._presses("none", 0.0)
        truth = make_cases.truth_of(self.pad, "none", 0)
        self.white = [self._whitening(truth, self.rest[k]) for k in self.kept]
        self.basis = np.linalg.qr(self._white([truth.base(self.rest[k]) for k in self.kept]))[0]

    def signature(self, effect, variant, amplitude):
        """What an effect adds, free of what is refitted."""
        made = self._presses(effect, amplitude, variant)
        return self._free([made[k].force - self.rest[k].force for k in self.kept])

    def distortion(self, what, amplitude):
        """The same of an instrument's error; a depth misread counts as the force that it hides."""
        made = self._presses("none", 0.0)
        observing.INSTRUMENT[what](made, amplitude, np.random.default_rng(1))
        truth, found = make_cases.truth_of(self.pad, "none", 0), []
        for k in self.kept:
            moved = made[k].stated - self.rest[k].stated
            found.append(made[k].force - self.rest[k].force - self._slope(truth, self.rest[k]) * moved)
        return self._free(found)

    def _presses(self, effect, amplitude, variant=0):
        return make_cases.truth_of(self.pad, effect, variant).presses(amplitude, self.growth)

    def _free(self, columns):
        flat = self._white(columns)
        return flat - self.basis @ (self.basis.T @ flat)

    def _white(self, columns):
        return np.concatenate([_apply(*white, one) for white, one in zip(self.white, columns, strict=True)])

    def _slope(self, truth, press):
        """Change of the base's force with depth, N/mm."""
        more = observing.Press(**{**vars(press), "stated": press.stated + STEP_MM})
        moduli = np.array([self.growth[0], self.growth[1] - self.growth[0]])
        return (truth.base(more) - truth.base(press)) @ moduli / STEP_MM

    def _whitening(self, truth, press):
        """How to take the memory out of a recording's noise, and its own gain and touch."""
        sigma = self.label["noise"] * press.force.max()
        keep = np.exp(-np.diff(press.time) / observing.CORRELATION_S)[:, None]
        nuisance = [make_cases.REPEAT_GAIN * press.force, make_cases.ZERO_MM * self._slope(truth, press)]
        basis, strength, _ = np.linalg.svd(_fresh(np.stack(nuisance, axis=1) / sigma, keep), full_matrices=False)
        return sigma, keep, basis, 1.0 - 1.0 / np.sqrt(1.0 + strength**2)


def _fresh(rows, keep):
    return np.concatenate([rows[:1], (rows[1:] - keep * rows[:-1]) / np.sqrt(1.0 - keep**2)])


def _apply(sigma, keep, basis, shrink, column):
    rows = _fresh(np.reshape(column, (len(column), -1)) / sigma, keep)
    rows = rows - basis @ (shrink[:, None] * (basis.T @ rows))
    return rows[:, 0] if np.ndim(column) == 1 else rows


def separations(name, label):
    """(detect, name) of a case of one effect; of an instrument's error (detect, None)."""
    case = Case(name, label)
    if label["stratum"] == "decoy":
        return float(np.linalg.norm(case.distortion(label["distortion"], label["amplitudes"][1]))), None
    own = case.signature(label["effect"], label["variant"], label["amplitudes"][0])
    least = np.linalg.norm(own)
    for other in protocols.SINGLE:
        for variant in (0, 1):
            if other != label["effect"] and f"{case.pad}/{other}/{variant}/1.0/wide sphere" in make_cases.runs():
                rival = case.signature(other, variant, label["amplitudes"][0] or 1.0)
                share = max(0.0, float(rival @ own) / float(rival @ rival))
                least = min(least, np.linalg.norm(own - share * rival))
    return float(np.linalg.norm(own)), float(least)


def chance(detect, name):
    """That the oracle finds a cause and that its evidence leads by LEAD (normal, mean name^2 / 2, deviation name)."""
    told = 1.0 if name is None else norm.cdf(name / 2.0 - LEAD / max(name, 1e-9))
    return min(norm.cdf(detect - SEEN), told)


def main():
    """Prints shares by stratum."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--split", default="trial", choices=score.SPLITS)
    sealed = score.labels(parser.parse_args().split)
    groups = {
        "one effect, kappa >= 1": lambda one: one["stratum"] == "single" and one["kappa"] >= counts.REACHED,
        "one effect, kappa 0.5": lambda one: one["stratum"] == "single" and one["kappa"] < counts.REACHED,
        "decoys": lambda one: one["stratum"] == "decoy",
        **{f"  {what}": lambda one, what=what: one.get("distortion") == what and one["stratum"] == "decoy"
           for what in observing.INSTRUMENT},
        **{f"  {effect}": lambda one, effect=effect: one["stratum"] == "single" and one["kappa"] >= counts.REACHED
           and one["effect"] == effect for effect in protocols.SINGLE},
    }  # fmt: skip
    wanted = [name for name, label in sealed.items() if label["stratum"] in ("single", "decoy")]
    found = {name: separations(name, sealed[name]) for name in wanted}
    print(f"{'':30s} {'of':>4s} {'seen':>6s} {'and told':>9s} {'expected':>9s} {'median detect':>14s} {'name':>6s}")
    for group, belongs in groups.items():
        of = [found[name] for name in wanted if belongs(sealed[name])]
        if of:
            seen = np.mean([one >= SEEN for one, _ in of])
            told = np.mean([one >= SEEN and (two is None or two >= TOLD) for one, two in of])
            expected = np.mean([chance(*one) for one in of])
            names = [two for _, two in of if two is not None]
            middle = np.median([one for one, _ in of])
            tail = f"{np.median(names):6.1f}" if names else ""
            print(f"{group:30s} {len(of):4d} {seen:6.2f} {told:9.2f} {expected:9.2f} {middle:14.1f} {tail}")


if __name__ == "__main__":
    main()
