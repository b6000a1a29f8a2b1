"""What the thresholds of the diagnosis rest on: evidence that is reached, led by and taken up where it should not be.

Printed by `cargo xtask prove -- --split calibration`. The thresholds stand in rust/diagnosis/src/gates/decision.rs; no
case of the trial is looked at for them.
"""

import re

import numpy as np
from trial import observing


def noise(sealed, said):
    """Slow noise as repeats tell it, over what it is: (least, median, most) by study, of variance times memory."""
    found = []
    for name, label in sealed.items():
        told = said.get(name, {}).get("evidence", {})
        is_plain = label["stratum"] not in ("unlisted", "poor") and label.get("scatter") != "outliers"
        if is_plain and "noise" in label and told.get("noise_memory_s"):
            memory = observing.CORRELATION_S * (observing.SLOWER if label.get("scatter") == "slow" else 1.0)
            size = told["noise_share"] * told["noise_step"]
            found.append(size**2 * told["noise_memory_s"] / (label["noise"] ** 2 * memory))
    return (min(found), float(np.median(found)), max(found)) if found else None


def rhythms(sealed, said):
    """(effect or none, Hz, chance) of the clearest rhythm in the repeats of nulls and of what is on no list."""
    for name, label in sealed.items():
        told = said.get(name, {}).get("evidence", {})
        if label["stratum"] in ("null", "unlisted") and "rhythm_chance" in told:
            yield label.get("distortion", "nothing"), told["rhythm_hz"], told["rhythm_chance"]


def reached(sealed, said):
    """Largest evidence, nats, of every effect that was tried alone on cases without any."""
    found = {}
    for name, label in sealed.items():
        if label["stratum"] == "null" and name in said:
            for effect, nats in _alone(said[name]).items():
                found[effect] = max(nats, found.get(effect, nats))
    return found


def led_by(sealed, said):
    """Largest lead, nats, of another name over the one that is there, of cases of one effect: by effect and name."""
    found = {}
    for truth, verdict in _of_one(sealed, said):
        alone = _alone(verdict)
        for name, nats in alone.items() if truth in alone else ():
            if name != truth and nats > alone[truth]:
                found[truth, name] = max(nats - alone[truth], found.get((truth, name), 0.0))
    return found


def taken_up(sealed, said):
    """Most nats that a second name adds to the one that is there, and as a part of its own: by effect and name."""
    found = {}
    for truth, verdict in _of_one(sealed, said):
        alone = _alone(verdict)
        for one in verdict["rivals"] if truth in alone else ():
            if len(one["effects"]) == 2 and truth in one["effects"]:
                (second,) = set(one["effects"]) - {truth}
                more = one["evidence"] - max(alone[truth], alone.get(second, 0.0))
                most, share = found.get((truth, second), (0.0, 0.0))
                found[truth, second] = max(most, more), max(share, more / alone[truth])
    return {key: pair for key, pair in found.items() if pair[0] > 0.0}


SUSPECTED = re.compile(r"is suspected, .* they confirm (\d+) % of its evidence")


def confirmed(sealed, said):
    """(share of evidence that held-out recordings confirm, whether it is right, names) of what reaches that gate."""
    for name, label in sealed.items():
        verdict, there = said.get(name, {}), label.get("names", [])
        score = (verdict.get("fit") or {}).get("log_score") or {}
        names = [one["effect"] for one in verdict.get("findings", [])]
        if names and score.get("of_evidence") is not None:
            yield score["of_evidence"], set(names) <= set(there), " and ".join(names)
        for found in filter(None, map(SUSPECTED.search, verdict.get("notes", []))):
            yield 0.01 * int(found[1]), None, "only suspected" + (f" ({' and '.join(there)} is there)" if there else "")


def lines(sealed, said):
    """All of it as lines of text, the largest first."""
    told = ["largest evidence where nothing is missing, nats:"]
    told += [f"  {effect}: {nats:.1f}" for effect, nats in _sorted(reached(sealed, said))]
    least, middle, most = noise(sealed, said) or (np.nan, np.nan, np.nan)
    told.append(f"slow noise that repeats tell, over what it is: median {middle:.2f}, {least:.2f} to {most:.2f}")
    told.append("share of its evidence that held-out recordings confirm:")
    shares = sorted(confirmed(sealed, said), key=lambda one: one[0])
    right = [share for share, is_right, names in shares if is_right and names != "gain"]
    if right:
        told.append(
            f"  right names: {min(right):.2f} to {max(right):.2f}, median {np.median(right):.2f}, of {len(right)}"
        )
    told += [f"  {names}{'' if ok is None else ', wrong'}: {share:.2f}" for share, ok, names in shares if not ok]
    told.append("clearest rhythm in repeats, and how often noise alone shows one as clear:")
    found = sorted(rhythms(sealed, said), key=lambda one: one[2])
    nulls = [chance for what, _, chance in found if what == "nothing"]
    told += [f"  nothing: {min(nulls):.1e} at least, of {len(nulls)}"] if nulls else []
    told += [f"  {what}: {hz:.2f} Hz, {chance:.1e}" for what, hz, chance in found if what != "nothing"]
    told.append("largest lead of another name over the one that is there, nats:")
    told += [f"  {other} over {truth}: {nats:.1f}" for (truth, other), nats in _sorted(led_by(sealed, said))]
    told.append("most that a second name adds where one is there, nats and part of the first's:")
    for (truth, second), (nats, share) in _sorted(taken_up(sealed, said)):
        told.append(f"  {second} beside {truth}: {nats:.1f}, {100.0 * share:.1f} %")
    return told


def _of_one(sealed, said):
    """(effect or error that is there, verdict) of cases of one that show it at all."""
    for name, label in sealed.items():
        if label["stratum"] in ("single", "ambiguous", "decoy") and said.get(name, {}).get("rivals"):
            yield label.get("effect") or label["distortion"], said[name]


def _alone(verdict):
    """Evidence by name of what was tried alone."""
    return {one["effects"][0]: one["evidence"] for one in verdict.get("rivals", []) if len(one["effects"]) == 1}


def _sorted(found):
    """Pairs, the largest value first."""
    return sorted(found.items(), key=lambda pair: pair[1], reverse=True)
