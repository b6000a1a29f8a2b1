"""A world of fingertips in a laboratory: presses, cycles, slides and mats, by finite elements of tips over bone.

    draw(seed, truth, noise) -> Case; Case.write(folder)
    named(case, findings) -> names; judged(truth, b, verdict, names) -> word

Studies of the kind of `../shared/studies`, drawn in number; none of those is read here. Force, contact area and the
pressure on plate and cylinder by depth come from `tips.npz` (FElupe, `tips_by_finite_elements.py`), scaled by a drawn
size and modulus, mirrored by lot. Nothing here is computed by Thenar. Force is smoothed as in `finite_element_pads.py`.

Truths, and the right answers, written down before any diagnosis ran:

- `nothing` (b = 0) and `exponential` (b = 1). Right: nothing missing, or parameters; with b = 1 also a stiffening law
  alone. *Too little data* is a miss, any other verdict is wrong.
- `stiff_skin`: an outer 1 mm that is 20 times as stiff as the pulp under it.
- `relaxation`: two terms of a Prony series in each spring of a bed (`tissue_bed.py`), so also in lifts and cycles.
- `drainage`, added after the first 50 verdicts had been seen, to see what a relaxation is confused with: the same bed
  with time constants that grow as the contact's area. This is the law that the diagnosis tries, in code of its own.
- `cycle_softening`: damage by work in each spring, which does not heal in the session.
- `inclusion`: a stiff spot (in the slim tip). Right: an inclusion within a sensel (2 mm) of its place in the skin's
  plane; one that is farther off is called `inclusion_elsewhere`, a wrong name.
- `friction`: Coulomb's, after the skin is sheared; its coefficient 0.15 to 0.5.
- `saturation`: a load cell that clips at 75 to 92 % of the largest force. `mat_ceiling`: a mat that clips at 40 to 75 %
  of the largest pressure (named `saturation` in channel `map` by the diagnosis; here `mat_ceiling`).
- `dead_cells`: three sensels that read 0. Right: that name or a threshold, or the verdict *instrument* without a name
  of the skin. `mat_gain`: a mat that reads 0.7 or 1.4 times what it should. Right: `gain`, or the same.
- pairs, joined by `_and_`. Right: both names and no other; one of them is a miss.

Of all but the first two, drawn with b = 0 and b = 1 where tips hold both, right is that name, with b = 1 also next to a
stiffening law. Nothing named, *unlisted*, too little data and *cannot tell* that holds a truth are misses; any other
name is wrong, and so is *cannot tell* without a truth.

Noise families (`NOISES`); area 3 % + 0.2 mm2 in each, a cell below 0.6 kPa reads 0, mats lie 0.3 mm off (rms):

- `laboratory`: force 1 % + 5 mN, depth 10 um, cells 3 % + 0.3 kPa, all white.
- `drifting`: the zero of the force walks by 6 mN in 10 s, 3 mN and 0.5 % white; depth 5 um; cells with fixed gains of
  4 % and 1 % + 0.3 kPa white.
- `remounted`: each recording with its own gain (2 %) and first touch (20 um), 4 mN white; depth 5 um; cells likewise.

Habits, drawn too: depths of 68 to 90 % of the table's 3.25 mm (times size); two or three of 0.5, 2 and 8 mm/s; 2 or 3
repeats; a hold of 2 to 4 s; cycles first or last; slides of 2 to 4 mm to one side and back beyond. Simplifications: a
relaxing or damaged pad keeps the shape of its pressure at a depth; a sheared one too, moved along with the skin.
"""

import numpy as np
from trial.fingertips.session import NOISES, Session
from trial.fingertips.study_files import PITCH_MM
from trial.fingertips.tips import PADS, SPOTS, TIPS, Tip

PAIRS = ("relaxation_and_mat_ceiling", "relaxation_and_friction", "stiff_skin_and_friction", "inclusion_and_friction")
TRUTHS = (
    "nothing",
    "exponential",
    "stiff_skin",
    "relaxation",
    "drainage",
    "inclusion",
    "friction",
    "cycle_softening",
    "saturation",
    "mat_ceiling",
    "dead_cells",
    "mat_gain",
    *PAIRS,
)
INSTRUMENT = {"dead_cells": {"dead_cells", "threshold"}, "mat_gain": {"gain"}}
STIFFENING = "stiffening_law"
SIZE, MODULUS_MPA = (0.9, 1.12), (0.006, 0.012)


def planted(truth):
    """Names of a truth."""
    return set() if truth in ("nothing", "exponential") else set(truth.split("_and_"))


def named(case, findings):
    """Names of findings, of `findings.json`, with the channel of a ceiling and the place of an inclusion in them."""
    names = set()
    for one in findings:
        name = one["effect"]
        if name == "saturation" and one.get("channel") == "map":
            name = "mat_ceiling"
        if name == "inclusion" and case.pad.spot_mm is not None:
            center = (one.get("where") or {}).get("center_mm") or [np.inf, np.inf]
            if np.linalg.norm(np.array(center[:2], dtype=float) - case.pad.spot_mm) > PITCH_MM:
                name = "inclusion_elsewhere"
        names.add(name)
    return names


def judged(truth, stiffening, verdict, names):
    """`right`, `missed` or `wrong`, as it is written above; `names` of the findings, or of what is not separable."""
    names, wanted = set(names), planted(truth)
    law = {STIFFENING} if stiffening else set()
    if verdict == "fault":
        return "wrong"
    if verdict == "insufficient_data":
        return "missed"
    if not wanted:
        is_silent = verdict in ("nothing_missing", "parameters")
        is_law = verdict in ("missing_physics", "cannot_tell") and bool(names) and names <= law
        return "right" if is_silent or is_law else "wrong"
    if verdict == "cannot_tell":
        return "missed" if wanted & names else "wrong"
    if truth in INSTRUMENT:
        if names - INSTRUMENT[truth] - law:
            return "wrong"
        return "right" if names & INSTRUMENT[truth] or verdict == "instrument" else "missed"
    if names - wanted - law:
        return "wrong"
    return "right" if wanted <= names else "missed"


def draw(seed, truth, noise):
    """A case; the same arguments give the same case. ValueError for an unknown truth or noise."""
    if truth not in TRUTHS or noise not in NOISES:
        raise ValueError(f"no world of {truth} with {noise}")
    random = np.random.default_rng([seed, 2, *truth.encode(), 0, *noise.encode()])
    return Session(_tip(truth, random), planted(truth), noise, random).recorded()


def _tip(truth, random):
    wanted = planted(truth)
    variant = "skin" if "stiff_skin" in wanted else "plain"
    stiffening = {"nothing": 0.0, "exponential": 1.0}.get(truth, float(random.integers(2)))
    if "inclusion" in wanted:
        variant = str(random.choice(list(SPOTS)))
        stiffening = SPOTS[variant][2]
    name = str(random.choice([each for each in PADS if f"{each}/{variant}/plate/{stiffening:g}" in TIPS]))
    modulus = np.exp(random.uniform(*np.log(MODULUS_MPA)))
    mirror = tuple(int(side) for side in random.choice([-1, 1], 2))
    return Tip(name, variant, stiffening, random.uniform(*SIZE), modulus, mirror)
