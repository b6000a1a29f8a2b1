"""How far Thenar's ball on a layer is from the trial's finite elements where nothing is planted: at finite strain.

    python -m trial.finite_elements.against_ball        (in `tests`)

The calibration's pads under their three spheres. Of the force over `thenar.press_ball`, as a logarithm over depth,
prints the ways in which a form may be off (whole, tilt, bend, first touch; `stiffness::modes` in Rust), then what is
left of the first three once all tools of a pad share what a pair of moduli takes up.
"""

import numpy as np
import thenar
from trial import protocols
from trial.drawing import truths

SHEAR_MPA = 0.01
FIRST = 0.05  # part of the depth over which an error at first touch dies away, as `stiffness` has it
TOOLS = {"small": "slow, small sphere", "large": "large sphere", "wide": "wide sphere"}


def departure(pad, tool):
    """(whole, tilt, bend, first) of a tool, as logarithms."""
    first = protocols.STEPS[0]
    rows = slice(first + 1, 2 * first + 1)
    depths = protocols.course(pad, TOOLS[tool], protocols.STEPS)[rows, 1]
    theirs = truths.runs()[f"{pad}/none/0/0/{TOOLS[tool]}"].astype(float)[rows]
    ours = SHEAR_MPA * thenar.press_ball(protocols.radius(pad, tool), depths, protocols.PADS[pad][1])
    u = depths / depths[-1]
    ways = np.stack([np.ones_like(u), 2.0 * u - 1.0, 6.0 * u * (u - 1.0) + 1.0, np.exp(-u / FIRST)], axis=1)
    weight = u**1.5  # as readings of even noise weigh the logarithm of such a force
    return np.linalg.lstsq(weight[:, None] * ways, weight * np.log(theirs / ours), rcond=None)[0]


def departures():
    """By pad of the calibration, a row of `departure` for every tool."""
    pads = [pad for pad, (split, *_) in protocols.PADS.items() if split == "calibration"]
    return {pad: np.array([departure(pad, tool) for tool in TOOLS]) for pad in pads}


def not_shared(found):
    """rms of whole, tilt and bend that the tools of a pad do not share; of three, two degrees of freedom are left."""
    left = np.concatenate([rows[:, :3] - rows[:, :3].mean(axis=0) for rows in found.values()])
    return np.sqrt((left**2).sum(axis=0) / (2 * len(found)))


def main():
    """Prints the table."""
    found = departures()
    for pad, rows in found.items():
        for tool, ways in zip(TOOLS, 100.0 * rows, strict=True):
            print(f"{pad:10s} {tool:6s} " + ", ".join(f"{way:+.2f}" for way in ways) + " %")
    whole, tilt, bend = 100.0 * not_shared(found)
    print(f"rms of what tools do not share: whole {whole:.2f}, tilt {tilt:.2f}, bend {bend:.2f} %")


if __name__ == "__main__":
    main()
