"""Makes truth_runs.npz: forces of every protocol on every pad, with and without each effect, by finite elements.

Knows nothing of Thenar. Run it by hand in `tests`: `pip install numba`, then `python -m trial.drawing.truth_runs` (an
hour on one core); what the table holds is not computed again, and what finds no equilibrium (a grip that lets go at
once) is left out. Keys are `pad/effect/variant/amplitude/protocol`, values the forces (N, for G = 0.01 MPa) at the
times of `course(pad, protocol, STEPS)`. Other amplitudes are drawn between those computed and the pad without the
effect (truths.py); of a grip there are no others, since where it lets go depends on its strength, and a parabola
through pulls of which some have let go and some have not would push where nothing touches.
"""

import itertools
import os
import sys
import time
from pathlib import Path

import numpy as np
from trial.finite_elements.axisymmetric import Pad, Tissue, Tool, press
from trial.protocols import (
    AMPLITUDES,
    BETWEEN,
    COMPUTED,
    FINER,
    GRIPS,
    PADS,
    PAIRS,
    PROTOCOLS,
    SECOND,
    SINGLE,
    STEPS,
    TWO_FORMS,
    course,
    depth,
    radius,
)

TABLE = Path(__file__).with_suffix(".npz")


def stretched(power, time_s):
    """Shares of log-spaced branches that fade together about as exp(-(t/time_s)^power) from 0.02 to 60 s."""
    times = np.array(Tissue().times_s)
    t = np.geomspace(0.02, 60.0, 60)
    shares = np.exp(-t[:, None] / times)
    found = np.linalg.lstsq(
        np.vstack([shares, 0.03 * np.eye(5)]), np.append(np.exp(-((t / time_s) ** power)), np.zeros(5))
    )
    return np.maximum(found[0], 0.0)


def changed(effect, variant, amplitude):
    """(share of the thickness, changes of the tissue, grip) that an effect makes at an amplitude in 0..1."""
    second = variant == 1
    thickness, grip, tissue = 1.0, (0.0, 0.03), {}
    if effect == "relaxation":
        shape = stretched(0.65, 0.6) if second else stretched(0.45, 2.0)
        tissue = {"overstress": tuple(0.4 * amplitude * shape)}
    elif effect == "drainage":
        tissue = {"skeleton_ratio": 2.5 / amplitude, "permeability": 60.0 if second else 20.0}
    elif effect == "bone":
        thickness = 1.0 + 0.35 * amplitude if second else 1.0 - 0.25 * amplitude
    elif effect == "stiffening_law":
        tissue = {"rate": (16.0 if second else 10.0) * amplitude}
    elif effect == "adhesion":
        grip = (0.003 * amplitude, 0.05) if second else (0.006 * amplitude, 0.025)
    elif effect == "cycle_softening":
        tissue = {"damage": 0.45 * amplitude, "damage_energy": 0.05 if second else 0.15}
    elif effect == "rate_independent_loss":
        shares = (0.1, 0.25, 0.45) if second else (0.4, 0.3, 0.1)
        tissue = {"friction": tuple(amplitude * share for share in shares)}
    elif effect == "stiff_skin":
        tissue = {"skin_mm": 0.7 if second else 0.4, "skin_ratio": 1.0 + 19.0 * amplitude}
    elif effect == "compressibility":
        tissue = {"bulk_ratio": 1.0 / (0.001 + 0.3 * amplitude)}
    return thickness, tissue, grip


def forces(pad, effects, protocol):
    """A protocol's forces on a pad with `effects`, ((name, variant, amplitude), ...)."""
    thickness, tissue, grip = 1.0, {}, (0.0, 0.03)
    for effect in effects:
        share, more, hold = changed(*effect)
        thickness, tissue = thickness * share, tissue | more
        grip = hold if hold[0] > 0.0 else grip
    size, layer = radius(pad, PROTOCOLS[protocol].tool), PADS[pad][1]
    shape = Pad(np.inf, layer * thickness, 1.3 * np.sqrt(size * depth(pad)))
    return press(shape, Tissue(**tissue), Tool(size, grip), course(pad, protocol, STEPS))


def wanted():
    """Every (key, pad, effects) of the table: bases first, then by what the trial needs most."""
    yield from ((f"{pad}/none/0/0", pad, ()) for pad in PADS)
    for amplitude in AMPLITUDES[::-1]:
        singles = [((effect,), 0) for effect in SINGLE]
        more = [*((pair, 0) for pair in PAIRS), *(((effect,), 1) for effect in SINGLE)]
        for effects, variant in singles + more if amplitude == AMPLITUDES[-1] else singles:
            pads = COMPUTED[len(effects) - 1 + 2 * variant]
            for pad in TWO_FORMS.get(effects[0], pads) if variant == 1 else pads:
                key = f"{pad}/{'+'.join(effects)}/{variant}/{amplitude}"
                yield key, pad, tuple((effect, variant, amplitude) for effect in effects)
    finer = [*itertools.product(SECOND, FINER[::-1]), BETWEEN]
    for (pad, amplitude), effect, variant in itertools.product(finer, SINGLE, (0, 1)):
        if effect != "adhesion":
            yield f"{pad}/{effect}/{variant}/{amplitude}", pad, ((effect, variant, amplitude),)
    for amplitude in GRIPS[::-1]:
        for variant, pads in ((0, COMPUTED[1]), (1, COMPUTED[2])):
            for pad in pads:
                yield f"{pad}/adhesion/{variant}/{amplitude}", pad, (("adhesion", variant, amplitude),)


def main():
    """Computes what the table lacks and keeps it after every pad with an effect."""
    kept = dict(np.load(TABLE)) if TABLE.exists() else {}
    for key, pad, effects in wanted():
        if all(f"{key}/{name}" in kept for name in PROTOCOLS) or (sys.argv[1:] and sys.argv[1] not in key):
            continue
        start = time.time()
        lacking = [name for name in PROTOCOLS if f"{key}/{name}" not in kept]
        found = {f"{key}/{name}": forces(pad, effects, name).astype(np.float32) for name in lacking}
        if not all(np.isfinite(force).all() for force in found.values()):
            print(f"{key}: no equilibrium, left out", flush=True)
            continue
        kept |= found
        np.savez_compressed(TABLE.with_suffix(".part.npz"), **kept)
        os.replace(TABLE.with_suffix(".part.npz"), TABLE)
        print(f"{key} {time.time() - start:.1f} s {[round(float(f.max()), 4) for f in found.values()]}", flush=True)


if __name__ == "__main__":
    main()
