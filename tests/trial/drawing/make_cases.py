"""Makes the trial's cases from truth_runs.npz: recordings (cases.npz), the public index (cases.json), labels.json.

Knows nothing of Thenar. `python -m trial.drawing.make_cases` in `tests`; the same tables give the same bytes. What a
careful person would take for the base model is the pad of nu = 0.4995, neo-Hookean, of the stated thickness, its force
times a modulus that grows evenly with depth, G0 to Glim over 0.3 thicknesses (`Truth.base`). Every truth is that,
times its own such modulus, and one of: nothing more, effects, an instrument's error, or what no list holds. `kappa`:
root mean square of what remains of the truth once G0 and Glim are refitted to all recordings together, over the
noise's; `r2` is of the same refit. labels.json is sealed: only score.py opens it; the index holds a salted hash of
every label.
"""

import hashlib
import json
from pathlib import Path

import numpy as np
from trial import observing, protocols
from trial.drawing.truths import REPEATS, RICH, Pair, runs, truth_of

HERE = Path(__file__).parents[1]
REPEAT_GAIN, ZERO_MM = 0.04, 0.02
NOISES = (0.01, 0.03)
KAPPAS = (0.5, 1.0, 2.0, 4.0)
USUAL = ("slow, small sphere", "fast, small sphere", "cycles, small sphere")
MOST_STEPS = 32000  # forces are kept as shares of each recording's largest

SEEDS = {"trial": 20, "calibration": 10, "second": 44, "larger": 77}
ALSO = {"larger": "calibration"}  # drawn with that one's counts, on its pads
# How many of each stratum, in the order of SEEDS.
NULLS = {"normal": (40, 16, 60), "outliers": (20, 8, 40), "slow": (20, 8, 30), "wide": (20, 8, 30)}
DECOYS, SINGLE, PAIR, UNLISTED = (7, 3, 8), (5, 2, 5), (4, 2, 4), (8, 3, 8)
MIXED, AMBIGUOUS, POOR = (3, 1, 5), (5, 2, 8), (4, 2, 2)
ALIKE = 0.3  # what may remain, over the noise, of an effect that another imitates
INSTEAD = (  # ambiguous by design: what is true, and the little that is recorded of it
    ("relaxation", USUAL[:2]),
    ("drainage", USUAL[:2]),
    ("relaxation", ("large sphere",)),
    ("drainage", ("large sphere",)),
)
MIXES = (("relaxation", "fixture_compliance"), ("adhesion", "offset"), ("bone", "saturation"), ("relaxation", "drift"))


def severity(truth, presses, noise):
    """(kappa, R2) of a case before scatter and noise."""
    scale = [1.0 / (noise * press.force.max()) for press in presses]
    columns = np.concatenate([truth.base(press) * s for press, s in zip(presses, scale, strict=True)])
    seen = [press.force * s for press, s in zip(presses, scale, strict=True)]
    all_seen = np.concatenate(seen)
    left = all_seen - columns @ np.linalg.lstsq(columns, all_seen, rcond=None)[0]
    about = sum(((one - one.mean()) ** 2).sum() for one in seen)
    return float(np.sqrt((left**2).mean())), float(1.0 - (left**2).sum() / about)


def distorted(truth, growth, what, amplitudes, seed):
    """The presses with an effect (or two) at its amplitude and a distortion at its own."""
    presses = truth.presses(amplitudes if isinstance(truth, Pair) else amplitudes[0], growth)
    if what:
        forms = observing.INSTRUMENT | observing.UNLISTED
        forms[what](presses, amplitudes[1], np.random.default_rng(seed))
    return presses


def amplitudes_for(plan, growth, seed):
    """Amplitudes of the effect (or of both) and of the distortion: each alone as severe as planned, or as can be."""
    effects, what = plan.get("effect", "none").split("+"), plan.get("distortion")
    alone = [(truth_of(plan["pad"], effect, plan["variant"]), growth, None, seed) for effect in effects]
    found = [_halved(plan, one) if effect != "none" else 0.0 for effect, one in zip(effects, alone, strict=True)]
    if len(found) < 2:
        found.append(_halved(plan, (truth_of(plan["pad"], "none", 0), growth, what, seed)) if what else 0.0)
    return tuple(found)


def alone(plan, amplitudes, growth):
    """How severe each of two effects is without the other."""
    for effect, amplitude in zip(plan["effect"].split("+"), amplitudes, strict=True):
        truth = truth_of(plan["pad"], effect, plan["variant"])
        yield severity(truth, published(plan, truth.presses(amplitude, growth)), plan["noise"])[0]


def _halved(plan, made_of):
    """The amplitude, found by halving; of those computed the closest."""
    truth, growth, what, seed = made_of

    def severe(amplitude):
        presses = published(plan, distorted(truth, growth, what, (amplitude, amplitude), seed))
        return severity(truth, presses, plan["noise"])[0]

    if truth.grips:
        return min(truth.grips, key=lambda share: abs(np.log(severe(share) / plan["kappa"])))
    low, high = 0.0, 1.0
    for _ in range(14):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if severe(middle) < plan["kappa"] else (low, middle)
    return low


def published(plan, presses):
    """The presses that a plan's study holds."""
    return [press for press in presses if press.protocol in plan["published"]]


def rival(plan, presses, name):
    """What remains over the noise if effect `name` is fitted instead: G0, Glim and an amplitude, in either form."""
    best = np.inf
    scale = [1.0 / (plan["noise"] * press.force.max()) for press in presses]
    seen = np.concatenate([press.force * s for press, s in zip(presses, scale, strict=True)])
    for variant in (0, 1):
        if f"{plan['pad']}/{name}/{variant}/1.0/wide sphere" not in runs():
            continue
        made = [truth_of(plan["pad"], name, variant).presses(*how) for how in ((0.0, (1.0, 1.0)), (0.0, (0.0, 1.0)))]
        made += [truth_of(plan["pad"], name, variant).presses(1.0, plan["g_mpa"])]
        made += [truth_of(plan["pad"], name, variant).presses(0.0, plan["g_mpa"])]
        kept = [k for k, press in enumerate(made[0]) if press.protocol in plan["published"]]
        flat, grown, most, none = (
            np.concatenate([one[k].force * s for k, s in zip(kept, scale, strict=True)]) for one in made
        )
        columns = np.stack([flat, grown, most - none], axis=1)
        amplitude = np.clip(np.linalg.lstsq(columns, seen, rcond=None)[0][2], 0.0, 1.0)
        rest = seen - amplitude * columns[:, 2]
        left = rest - columns[:, :2] @ np.linalg.lstsq(columns[:, :2], rest, rcond=None)[0]
        best = min(best, float(np.sqrt((left**2).mean())))
    return best


def with_rival(plan, presses):
    """The plan with the effect that imitates its own best: a single effect that is matched so is ambiguous."""
    if plan["stratum"] not in ("single", "ambiguous"):
        return plan
    others = [name for name in protocols.SINGLE if name != plan["effect"]]
    rest = {name: rival(plan, presses, name) for name in others}
    closest = min(rest, key=rest.get)
    plan = plan | {"rival": closest, "rival_kappa": rest[closest]}
    if plan["stratum"] == "single" and plan["kappa"] < ALIKE:
        return plan | {"stratum": "faint"}
    if rest[closest] < ALIKE or plan["stratum"] == "ambiguous":
        plan |= {"stratum": "ambiguous", "names": [plan["effect"], closest]}
    return plan


def plans(split):
    """Every case of a split as a plan, in the order of the strata; the numbers are drawn from the plan's own seed."""
    split = ALSO.get(split, split)
    which = list(SEEDS).index(split)
    for scatter, counts in NULLS.items():
        yield from ({"stratum": "null", "scatter": scatter, "names": []} for _ in range(counts[which]))
    for name in observing.INSTRUMENT:
        yield from ({"stratum": "decoy", "distortion": name, "names": [name]} for _ in range(DECOYS[which]))
    for name in protocols.SINGLE:
        for kappa in KAPPAS:
            one = {"stratum": "single", "effect": name, "names": [name], "kappa": kappa}
            yield from (dict(one) for _ in range(SINGLE[which]))
    for pair in protocols.PAIRS:
        both = {"stratum": "pair", "effect": "+".join(pair), "names": list(pair)}
        yield from (dict(both) for _ in range(PAIR[which] if _pads(both, split) else 0))
    for name in observing.UNLISTED:
        yield from ({"stratum": "unlisted", "distortion": name, "names": []} for _ in range(UNLISTED[which]))
    for effect, error in MIXES:
        both = {"stratum": "mixed", "effect": effect, "distortion": error, "names": [effect, error]}
        yield from (dict(both) for _ in range(MIXED[which]))
    for effect, held in INSTEAD:
        cannot = {"stratum": "ambiguous", "effect": effect, "published": held, "names": [effect]}
        cannot |= {"kappa": 1.0, "noise": NOISES[0]}
        yield from (dict(cannot) for _ in range(AMBIGUOUS[which]))
    for effect in ("none", "relaxation"):
        poor = {"stratum": "poor", "effect": effect, "names": [], "published": ("wide sphere",), "repeats": 1}
        yield from (dict(poor) for _ in range(POOR[which]))


def drawn(plan, split, number, placed=None):
    """(plan with what is drawn, presses with scatter and noise); `placed` may move it to another stratum."""
    seed = [SEEDS[split], number]
    random = np.random.default_rng(seed)
    plan = {"noise": float(random.choice(NOISES, p=[0.65, 0.35])), "pad": str(random.choice(_pads(plan, split)))} | plan
    usual = plan["stratum"] == "null" and random.random() < 0.25
    plan.setdefault("published", USUAL if usual else RICH)
    plan.setdefault("kappa", float(random.choice([1.0, 2.0, 4.0])))
    plan["variant"] = int(random.integers(2)) if _has_two(plan) else 0
    low = np.exp(random.uniform(np.log(0.005), np.log(0.015)))
    growth = (float(low), float(low * random.uniform(0.9, 2.5)))
    plan, presses = _as_severe(plan, growth, seed)
    plan = (placed or with_rival)(plan, published(plan, presses))
    wide = 2.0 if plan.get("scatter") == "wide" else 1.0
    observing.scatter(presses, random, wide * REPEAT_GAIN, wide * ZERO_MM)
    observing.disturb(presses, random, plan["noise"], plan.get("scatter", "normal"))
    return plan, presses


def _as_severe(plan, growth, seed):
    """The plan with its amplitudes, and the presses; with less noise if the effect cannot be as strong."""
    truth = truth_of(plan["pad"], plan.get("effect", "none"), plan["variant"])
    amplitudes = (0.0, 0.0) if plan["stratum"] == "null" else amplitudes_for(plan, growth, seed)
    presses = distorted(truth, growth, plan.get("distortion"), amplitudes, seed)
    kappa, r2 = severity(truth, published(plan, presses), plan["noise"])
    least = min(alone(plan, amplitudes, growth)) if plan["stratum"] == "pair" else kappa
    if plan["stratum"] in ("single", "pair") and least < 0.9 * plan["kappa"] and plan["noise"] > NOISES[0]:
        return _as_severe(plan | {"noise": NOISES[0]}, growth, seed)
    made = {"g_mpa": growth, "wanted_kappa": plan["kappa"], "kappa": kappa, "r2": r2, "amplitudes": amplitudes}
    return plan | made, presses


def _pads(plan, split):
    """Pads of the split for which the finite elements of a plan were computed."""
    pads = [pad for pad, what in protocols.PADS.items() if what[0] == ALSO.get(split, split)]
    key = "none/0/0" if plan.get("effect", "none") == "none" else f"{plan['effect']}/0/1.0"
    return [pad for pad in pads if f"{pad}/{key}/{RICH[-1]}" in runs()]


def _has_two(plan):
    """Whether the second form of an effect was computed on the plan's pad."""
    return f"{plan['pad']}/{plan.get('effect')}/1/{protocols.AMPLITUDES[1]}/{RICH[-1]}" in runs()


def main():
    """Draws every case, shuffles them, and writes the three files."""
    splits = ("trial", "calibration")
    found = [(split, *drawn(plan, split, k)) for split in splits for k, plan in enumerate(plans(split))]
    write(found, "", (99, 5))


def write(found, kind, seeds, folder=HERE):
    """Writes (split, plan, presses) shuffled, as the three files of a `kind`; `seeds`: of the order, of the salt."""
    shuffled = np.random.default_rng(seeds[0]).permutation(len(found))
    salt = hashlib.sha256(np.random.default_rng(seeds[1]).bytes(16)).hexdigest()[:16]
    public, labels, forces, depths, first = {}, {}, [], [], 0
    for number, where in enumerate(shuffled):
        split, plan, presses = found[where]
        steps, begin = [], first
        for press in presses:
            steps.append(float(f"{np.abs(press.force).max() / MOST_STEPS:.6g}"))
            forces.append(np.round(press.force / steps[-1]).astype(np.int16))
            depths.append(np.round(press.stated / protocols.STEP_MM).astype(np.int16))
            first += len(press.force)
        label = {key: value for key, value in plan.items() if key not in ("pad", "published")}
        sealed = hashlib.sha256((salt + json.dumps(label, sort_keys=True)).encode()).hexdigest()
        name = f"{kind or 'case_'}{number:03d}"
        public[name] = {"split": split, "pad": plan["pad"], "label": sealed, "first": begin, "steps_n": steps}
        public[name] |= {"published": list(plan["published"]), "repeats": plan.get("repeats", REPEATS)}
        labels[name] = label
    kept = {f"{kind}force": np.concatenate(forces), f"{kind}depth": np.concatenate(depths)}
    np.savez_compressed(folder / f"{kind}cases.npz", **kept)
    lines = {"cases": {"cases": public}, "labels": {"salt": salt, "labels": labels}}
    for what, table in lines.items():
        text = json.dumps(table).replace(f'"{kind or "case_"}', f'\n"{kind or "case_"}')
        (folder / f"{kind}{what}.json").write_text(text + "\n")


if __name__ == "__main__":
    main()
