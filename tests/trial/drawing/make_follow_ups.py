"""Makes follow_ups.npz: what is recorded after a study of the trial whose protocols are not all published.

Every protocol TIMES more times, each with a scatter and noise of its own, by the truth that the case was made with.
Knows nothing of Thenar, as make_cases.py, and opens the labels to make recordings, as that does to write them.
`python -m trial.drawing.make_follow_ups` in `tests`, after make_cases; the same cases give the same bytes.
"""

import zlib

import numpy as np
from trial import cases, observing, protocols
from trial.drawing import make_cases, truths
from trial.scoring import score

TIMES = 12  # as often as any protocol can be recorded again


def made(case, label):
    """Presses of every protocol, TIMES each, in the order of protocols."""
    truth = truths.truth_of(cases.index()[case]["pad"], label.get("effect", "none"), label["variant"])
    random = np.random.default_rng([30, zlib.crc32(case.encode())])
    once = truth.presses(label["amplitudes"][0], label["g_mpa"])[: len(protocols.PROTOCOLS)]
    presses = []
    for press in once:
        for _ in range(TIMES):
            own = {"force": press.force.copy(), "stated": press.stated.copy()}
            presses.append(observing.Press(**{**vars(press), **own}))
    observing.scatter(presses, random, make_cases.REPEAT_GAIN, make_cases.ZERO_MM)
    observing.disturb(presses, random, label["noise"], label.get("scatter", "normal"))
    return presses


def main():
    """Writes the forces as shares of each recording's largest, and by how much its depths are off."""
    found = {}
    for split in score.SPLITS:
        for case, label in score.labels(split).items():
            if not cases.held_back(case) or label["stratum"] == "poor":
                continue
            presses = made(case, label)
            steps = [float(f"{np.abs(press.force).max() / make_cases.MOST_STEPS:.6g}") for press in presses]
            forces = [np.round(press.force / step) for press, step in zip(presses, steps, strict=True)]
            found[f"{case}/force"] = np.concatenate(forces).astype(np.int16)
            found[f"{case}/step_n"] = np.array(steps)
            found[f"{case}/zero_mm"] = np.array([press.stated[0] - press.depth[0] for press in presses], np.float32)
    np.savez_compressed(cases.HERE / "follow_ups.npz", **found)


if __name__ == "__main__":
    main()
