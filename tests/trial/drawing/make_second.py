"""Makes the second trial: second_cases.npz, second_cases.json (public), second_labels.json (sealed).

`python -m trial.drawing.make_second` in `tests`, after truth_runs; knows nothing of Thenar. The same generator as the
first trial's, on pads, with tools, speeds and seeds that neither that nor the calibration has. What a case counts as
is not what was planned but what its recordings hold, weighed by the oracle of ceiling.py (every cause's form and the
noise known, gains and touches of every press not) before any diagnosis has seen it:

- one effect that the oracle names in RICH of its draws is one to be named; one that it sees in as many and can tell
  from its closest rival in hardly any is ambiguous, with that rival;
- of two causes it must see each beside the other;
- an instrument's error is to be named if the oracle tells it from the skin's effects (`chance` in the label); to be
  blamed on the skin it is never;
- what is left over is `beyond`: no row asks for its name, and a wrong one counts as everywhere.

Drawn five times, each time with other seeds: what the draws of 54c3736, ce3241c, b5109a8 and 3b218da showed was
mended before the next. Before the third the truths were mended too: of amplitudes below a half, which most cases have,
they were parts of what stronger effects do, and a little drainage is no small part of much (truths.py).
"""

from trial.drawing import make_cases
from trial.scoring import ceiling, counts


def placed(plan, presses):
    """The plan in the stratum that its recordings put it, with the oracle's `chance` of the answer asked for there."""
    stratum = plan["stratum"]
    if stratum in ("single", "ambiguous"):
        return _of_one(plan)
    if stratum in ceiling.ASKED:
        _, what, weigh = ceiling.ASKED[stratum]
        plan = plan | {"chance": float(weigh(*what(plan, plan)))}
        is_kept = stratum == "decoy" or plan["chance"] >= counts.RICH
        return plan if is_kept else plan | {"stratum": "beyond"}
    return plan


def _of_one(plan):
    seen, told = ceiling.separations(plan, plan)
    chances = {"single": ceiling.chance(seen, told), "ambiguous": ceiling.chance_of_neither(seen, told)}
    rival = ceiling.closest(plan, plan)
    plan = plan | {"planned": plan["stratum"], "rival": rival, "stratum": "beyond", "names": [plan["effect"]]}
    for stratum, chance in chances.items():
        if chance >= counts.RICH:
            plan |= {"stratum": stratum, "chance": float(chance)}
    return plan | {"names": [plan["effect"], rival]} if plan["stratum"] == "ambiguous" else plan


def main():
    """Draws every case and writes the three files."""
    split = "second"
    plans = enumerate(make_cases.plans(split))
    make_cases.write([(split, *make_cases.drawn(plan, split, k, placed)) for k, plan in plans], "second_", (94, 10))


if __name__ == "__main__":
    main()
