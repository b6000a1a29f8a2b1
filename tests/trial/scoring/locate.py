"""Whether Thenar finds a stiff or soft spot that finite elements put into a pad, and finds none where there is none.

    python -m trial.scoring.locate --nulls 1000 --spots 96    # in `tests`, with the environment of `cargo xtask setup`

Studies are those of `studies.py`: pads in turn, mats fine and coarse in turn, a seed each. A false alarm is a place
named on a pad without a spot (stretches of time, which name no place, are counted apart). The miss is the distance
along the skin from the named center of the strongest place to the point above the spot's center, in pitches of the mat.
The model's own error that locating allows for was set on nulls of these pads at 1 % noise with seeds below
`FIRST_SEED`: seeds, mountings, moduli and noise are others here, the six shapes are the same.
"""

import argparse
import json
import tempfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import thenar
from trial import pads, studies

NULLS = tuple(pads.PADS)
SPOTS = tuple(pads.SPOTS)
FIRST_SEED = 1000  # calibration used those below


@dataclass(frozen=True)
class Found:
    """What locating said of one study: places and stretches of time named, the strongest place's miss in pitches."""

    case: str
    places: int
    times: int
    miss: float | None


def located(case, number, noise):
    """Locates in study `number` of a case; even numbers have the fine mat, odd ones the coarse one."""
    mat = ("fine", "coarse")[number % 2]
    with tempfile.TemporaryDirectory() as folder:
        truth = studies.make(case, FIRST_SEED + number, noise, Path(folder), mat)
        said = json.loads(thenar.compare(thenar.Study.load(folder)).to_json())
    mismatches = said["location"]["mismatches"]
    places = [one["where"] for one in mismatches if one["where"]]
    miss = None
    if places and truth.center_mm:
        away = np.subtract(places[0]["center_mm"], truth.center_mm)[:2]
        miss = float(np.linalg.norm(away) / studies.MATS[mat][0])
    return Found(case, len(places), len(mismatches) - len(places), miss)


def score(cases, count, noise, workers):
    """`located` for `count` studies, cases in turn."""
    jobs = [(cases[(k // 2) % len(cases)], k, noise) for k in range(count)]
    with ProcessPoolExecutor(workers) as pool:
        return list(pool.map(located, *zip(*jobs, strict=True)))


def wilson(hits, count):
    """95 % bounds of a share."""
    z, share = 1.959964, hits / count
    middle = (share + z * z / (2 * count)) / (1 + z * z / count)
    half = z / (1 + z * z / count) * np.sqrt(share * (1 - share) / count + z * z / (4 * count * count))
    return middle - half, middle + half


def main():
    """Prints the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--nulls", type=int, default=1000)
    parser.add_argument("--spots", type=int, default=96)
    parser.add_argument("--workers", type=int, default=2)
    asked = parser.parse_args()
    for noise in (0.01, 0.03):
        nulls = score(NULLS, asked.nulls // 2, noise, asked.workers)
        alarms, times = sum(one.places > 0 for one in nulls), sum(one.times > 0 for one in nulls)
        low, high = wilson(alarms, len(nulls))
        bounds = f"{100 * low:.1f} to {100 * high:.1f} %"
        print(
            f"noise {noise:.0%}: places named on {alarms} of {len(nulls)} nulls ({bounds}), times on {times}",
            flush=True,
        )
        spots = score(SPOTS, asked.spots // 2, noise, asked.workers)
        misses = np.array([one.miss for one in spots if one.miss is not None])
        found = f"{len(misses)} of {len(spots)} spots found"
        where = f"median miss {np.median(misses):.2f} pitches, {np.mean(misses < 1.0):.0%} within one"
        print(f"noise {noise:.0%}: {found}, {where}", flush=True)


if __name__ == "__main__":
    main()
