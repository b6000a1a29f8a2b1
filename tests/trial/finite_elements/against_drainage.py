"""How Thenar's form of drainage fits loads that finite elements lose by it, on pads that the trial does not use.

    python -m trial.finite_elements.against_drainage        (in `tests`; `pip install numba` first, as truth_runs)

Three spheres are pressed to 14 % of a pad's thickness within 0.05 s and held. Three forms are fitted to 9 s of the
loads over those of the first moment, with a gain of its own for every tool: a spectrum with its clock as it is under
every tool (relaxation), one whose times grow as the contact's radius to the 1.5, and that of
`rust/inference/src/forward/surrogate/tissue_laws.rs`, both with shares as what is lost in the end. Prints what is
left, rms, as a part of the load, and before it the spectrum that each tool's load has by itself over 100 s.
"""

import numpy as np
from scipy.optimize import least_squares
from trial import protocols
from trial.finite_elements.axisymmetric import Pad, Tissue, Tool, press

PADS = {pad: (about[1], about[2:]) for pad, about in protocols.PADS.items() if about[0] == "calibration"}
PADS["between"] = (6.2, (3.5, 15.0, 40.0))
HELD_S = np.array([0.02, 0.05, 0.1, 0.2, 0.35, 0.6, 1.0, 1.6, 2.5, 4.0, 6.0, 9.0, 30.0, 100.0])
SEEN = HELD_S < 10.0
RISE_S, STEPS = 0.05, 8
AMPLITUDES = (0.25, 1.0)  # of the trial's drainage
FORMS = {  # power of the contact's radius: at a small share, less for a share of 1; loss of width per factor e
    "a clock as it is": (0.0, 0.0, 0.0),
    "radius to the 1.5": (1.5, 0.0, 0.0),
    "ours": (1.6, 1.4, 0.3),
}
Z = np.linspace(-3.0, 3.0, 25)
WEIGHTS = np.exp(-0.5 * Z**2) / np.exp(-0.5 * Z**2).sum()


def held(thickness, radius, amplitude):
    """Part of the load that is left over HELD_S."""
    deep = protocols.STRAIN * thickness
    rise = np.arange(1, STEPS + 1) / STEPS
    motion = np.concatenate(
        [np.stack([RISE_S * rise, deep * rise], axis=1), np.stack([RISE_S + HELD_S, 0.0 * HELD_S + deep], axis=1)]
    )
    tissue = Tissue(skeleton_ratio=2.5 / amplitude, permeability=20.0)
    force = press(Pad(np.inf, thickness, 1.3 * np.sqrt(radius * deep)), tissue, Tool(radius), motion)
    return force[STEPS:] / force[STEPS - 1]


def alone(load):
    """(share, median time in s, width) of the spectrum that fits one tool's load best."""

    def residual(x):
        fades = 1.0 - np.exp(-HELD_S[:, None] / np.exp(x[1] + x[2] * Z)) @ WEIGHTS
        return 1.0 - x[0] * fades - load

    fit = least_squares(residual, [1.0 - load[-1], 1.0, 1.0], bounds=([0.0, -6.0, 0.05], [1.0, 8.0, 4.0]))
    return fit.x[0], float(np.exp(fit.x[1])), fit.x[2]


def left(loads, sizes, form):
    """rms of what a form leaves, with the numbers (share, log of the median time, width) that fit best."""
    power, less, narrows = form
    lost = np.array([1.0 - load[-1] for load in loads])
    factor = lost / lost.mean() if power else np.ones(len(lost))

    def residual(x):
        found = []
        for load, size, more, gain in zip(loads, sizes, factor, x[3:], strict=True):
            times = np.exp(x[1] + (x[2] - narrows * np.log(size)) * Z) * size ** np.clip(power - less * x[0], 0.0, 2.0)
            faded = 1.0 - np.exp(-HELD_S[SEEN, None] / times) @ WEIGHTS
            found.append((1.0 - x[0] * more * faded) * (1.0 + gain) - load[SEEN])
        return np.concatenate(found)

    bounds = ([0.0, -4.0, 0.6, -0.2, -0.2, -0.2], [0.95, 6.0, 3.0, 0.2, 0.2, 0.2])
    fits = [least_squares(residual, [0.2, 1.5, width, 0.0, 0.0, 0.0], bounds=bounds) for width in (0.8, 1.2, 2.0)]
    best = min(fits, key=lambda fit: fit.cost)
    return float(np.sqrt(np.mean(best.fun**2))), best.x[:3]


def main():
    """Prints the table."""
    for pad, (thickness, radii) in PADS.items():
        for amplitude in AMPLITUDES:
            loads = [held(thickness, radius, amplitude) for radius in radii]
            each = (f"{share:.3f}, {time:.1f} s, {width:.2f}" for share, time, width in map(alone, loads))
            print(f"{pad:12s} {amplitude:.2f} each by itself: {'; '.join(each)}")
            sizes = np.sqrt(np.array(radii) / np.exp(np.mean(np.log(radii))))
            for name, form in FORMS.items():
                rms, (share, median, width) = left(loads, sizes, form)
                numbers = f"share {share:.2f}, median {np.exp(median):.1f} s, width {width:.2f}"
                print(f"{pad:12s} {amplitude:.2f} {name:18s} {100.0 * rms:.3f} %  {numbers}", flush=True)


if __name__ == "__main__":
    main()
