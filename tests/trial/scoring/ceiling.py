"""How much of the trial an oracle could answer: one that knows every cause's form and the noise, and only weighs.

    python -m trial.scoring.ceiling [--split trial]      (in `tests`)

What separates two explanations of a case is the length, in units of its noise, of what a cause adds to the curves once
G0 and Glim are refitted and every press may have its own gain (4 %) and first touch (0.02 mm): `detect` against no
cause, `name` against the closest other single effect (its amplitude refitted too). With a detect of SEEN a cause that
is known in form is found in half of the draws at 1 % false alarms over a list of twenty; with a name of TOLD its
evidence leads by LEAD in half of them. `expected` is the share that such an oracle would name: no diagnosis of these
recordings can be asked for much more. Of two causes it must see each beside the other; of what is ambiguous by design
it must see the cause, and no name may lead. Reads the labels: for judging the trial, not for tuning.
"""

import argparse

import numpy as np
from scipy.stats import norm
from trial import cases, observing, protocols
from trial.drawing import make_cases, truths
from trial.scoring import counts, following, score

SEEN, LEAD = 3.3, 5.0
TOLD = (2.0 * LEAD) ** 0.5
STEP_MM = 1e-3


class Case:
    """A case's recordings in the units of their noise, with what is refitted taken out; `more` presses by protocol.

    `about`: the pad, and which protocols are published, as the public index has them.
    """

    def __init__(self, about, label, more=None):
        self.label, self.pad, self.growth = label, about["pad"], label["g_mpa"]
        self.rest = self._presses("none", 0.0)
        known = [press.protocol for press in self.rest]
        self.kept = [k for k, protocol in enumerate(known) if protocol in about["published"]]
        self.kept += [known.index(protocol) for protocol, times in (more or {}).items() for _ in range(times)]
        truth = truths.truth_of(self.pad, "none", 0)
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
        truth, found = truths.truth_of(self.pad, "none", 0), []
        for k in self.kept:
            moved = made[k].stated - self.rest[k].stated
            found.append(made[k].force - self.rest[k].force - self._slope(truth, self.rest[k]) * moved)
        return self._free(found)

    def _presses(self, effect, amplitude, variant=0):
        return truths.truth_of(self.pad, effect, variant).presses(amplitude, self.growth)

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


def separations(about, label, more=None):
    """(detect, name) of a case of one effect or of an instrument's error, with presses added."""
    own, but, case = _own(about, label, more)
    return float(np.linalg.norm(own)), min(_left(case, own, but).values())


def closest(about, label):
    """The other effect of the skin that leaves least of a case's own, its amplitude refitted."""
    own, but, case = _own(about, label)
    left = _left(case, own, but)
    return min(left, key=left.get)


def _own(about, label, more=None):
    """What a case's cause adds, the effect's name if it is one of the skin, and the case."""
    case = Case(about, label, more)
    if label["stratum"] == "decoy":
        return case.distortion(label["distortion"], label["amplitudes"][1]), None, case
    return case.signature(label["effect"], label["variant"], label["amplitudes"][0]), label["effect"], case


def _left(case, own, but):
    """What every other effect of the skin leaves of `own`, its amplitude refitted; no more than there is."""
    found = {}
    for other in protocols.SINGLE:
        found[other] = float(np.linalg.norm(own))
        for variant in (0, 1):
            for amplitude in truths.forms(case.pad, other, variant):
                rival = case.signature(other, variant, amplitude)
                share = max(0.0, float(rival @ own)) / max(float(rival @ rival), np.finfo(float).tiny)
                found[other] = min(found[other], float(np.linalg.norm(own - share * rival)))
    found.pop(but, None)
    return found


def chance(detect, name):
    """That the oracle finds a cause and that its evidence leads by LEAD (normal, mean name^2 / 2, deviation name)."""
    return min(norm.cdf(detect - SEEN), norm.cdf(name / 2.0 - LEAD / max(name, 1e-9)))


def beside(about, label):
    """Of two causes: what each adds that the other, its amplitude refitted, does not take up."""
    case = Case(about, label)
    first, second = label["amplitudes"]
    if label["stratum"] == "pair":
        whole = case.signature(label["effect"], label["variant"], (first, second))
        both = zip(label["effect"].split("+"), (first, second), strict=True)
        parts = [case.signature(effect, 0, amplitude) for effect, amplitude in both]
    else:
        parts = [case.signature(label["effect"], label["variant"], first), case.distortion(label["distortion"], second)]
        whole = parts[0] + parts[1]
    shares = [max(0.0, float(part @ whole) / float(part @ part)) for part in parts]
    return tuple(float(np.linalg.norm(whole - share * part)) for share, part in zip(shares, parts, strict=True))


def chance_of_both(one, other):
    """That the oracle sees each of two causes beside the other."""
    return norm.cdf(one - SEEN) * norm.cdf(other - SEEN)


def chance_of_neither(detect, name):
    """That the oracle sees a cause and finds no name for it that leads."""
    return norm.cdf(detect - SEEN) * (1.0 - chance(99.0, name))


def settled(name, label):
    """(detect, name) with the protocol held back that tells best, as often as can be, in turn with a known one."""
    about, often = cases.index()[name], following.MOST
    tried = [{one: often, other: often} for one in cases.held_back(name) for other in about["published"]]
    return max((separations(about, label, more) for more in tried), key=lambda pair: pair[1])


def groups(sealed):
    """Separations by group of cases."""
    found, severe = {}, {}
    for name, label in sealed.items():
        if label["stratum"] == "single":
            big, kind = label["kappa"] >= counts.REACHED, separations(cases.index()[name], label)
            found.setdefault("one effect, kappa >= 1" if big else "one effect, kappa 0.5", []).append(kind)
            severe.setdefault(f"  {label['effect']}" if big else "  at kappa 0.5", []).append(kind)
        elif label["stratum"] == "decoy":
            found.setdefault("decoys", []).append(separations(cases.index()[name], label))
            severe.setdefault(f"  {label['distortion']}", []).append(found["decoys"][-1])
        elif label["stratum"] == "ambiguous" and cases.held_back(name):
            found.setdefault("ambiguous", []).append(separations(cases.index()[name], label))
            found.setdefault("  with the best recording", []).append(settled(name, label))
    return found | {name: severe[name] for name in sorted(severe)}


def chances(sealed):
    """By row of the table, what the oracle's chance is in every case that counts there."""
    found = {}
    for name, label in sealed.items():
        key = label["stratum"]
        if key == "single":
            key = "severe" if label["kappa"] >= counts.REACHED else "mild"
        if key in ASKED and counts.holds_answer(label):
            row, what, weigh = ASKED[key]
            found.setdefault(row, {})[name] = float(weigh(*what(cases.index()[name], label)))
        if key == "ambiguous" and cases.held_back(name):
            found.setdefault("followed", {})[name] = float(chance(*settled(name, label)))
    return found


ASKED = {
    "severe": ("severe", separations, chance),
    "mild": ("mild", separations, chance),
    "decoy": ("instrument", separations, chance),
    "pair": ("pairs", beside, chance_of_both),
    "mixed": ("mixed", beside, chance_of_both),
    "ambiguous": ("ambiguous", separations, chance_of_neither),
}


def column(found):
    """What the oracle would reach in the rows of the table that it can be asked about; `found` as `chances` has it."""
    nothing = (float("nan"), float("nan"))
    return [counts.Row(key, key, float(np.mean([*of.values()])), len(of), nothing) for key, of in found.items()]


def rich(found):
    """By row, the cases that the oracle answers in nine of ten draws: their recordings hold the answer."""
    return {key: [name for name, share in of.items() if share >= counts.RICH] for key, of in found.items()}


def main():
    """Prints shares by group."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--split", default="trial", choices=score.SPLITS)
    head = ("of", "seen", "and told", "expected", "detect", "name")
    print(f"{'':28s}" + "".join(f"{one:>10s}" for one in head))
    sealed = score.labels(parser.parse_args().split)
    for group, of in groups(sealed).items():
        seen = np.mean([one >= SEEN for one, _ in of])
        told = np.mean([one >= SEEN and two >= TOLD for one, two in of])
        detect, names = np.median(of, axis=0)
        shares = f"{seen:10.2f}{told:10.2f}{np.mean([chance(*one) for one in of]):10.2f}{detect:10.1f}"
        print(f"{group:28s}{len(of):10d}{shares}{names:10.1f}")
    for row in column(chances(sealed)):
        if row.key in ("pairs", "mixed", "ambiguous"):
            print(f"{row.name:28s}{row.of:10d}{'':20s}{row.value:10.2f}")


if __name__ == "__main__":
    main()
