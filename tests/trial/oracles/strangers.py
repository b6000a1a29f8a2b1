"""Which strangers of the closed forms an oracle could see: one that knows their form and the noise, and only weighs.

    PYTHONPATH=tests target/venv/bin/python -m trial.oracles.strangers [--cases 10] [--seed 1] [--noises white ...]
        [--keep DIR]

What a stranger adds to the forces is put in units of the noise of its family, and all is taken out that the modulus,
the first touch of each tool, and what the family lets differ between recordings (gain, first touch, zero, hum) can
make. The length of the rest is that by which an oracle sees it: with one of `SEEN` and 1.28 in 9 of 10 draws, as in
`trial.scoring.ceiling`. Prints the length of each case and how many can be seen; with the verdicts that
`accusations.py --truth stranger --keep DIR` has left, also how many of these are `unlisted`, with 95 % bounds.

Shares with a diagnosis nothing but the recordings' world. A sample that is astray counts like its neighbors, so that
lengths of `stray` and `stray_depth` are those without such samples.
"""

import argparse
import collections
import json
from dataclasses import dataclass
from unittest import mock

import numpy as np
from scipy.linalg import solve_triangular
from trial.scoring.ceiling import SEEN
from trial.worlds import closed_forms
from trial.worlds.accusations import STRANGER, Asked, bounds, judged

SURE = SEEN + 1.28  # seen in 9 of 10 draws
STEP_MM = 1e-3
FREE = 1e3  # standard deviations of what is not known at all
TOUCH_MM = 0.3  # as far off as the first touch of a tool may be


@dataclass
class Press:
    """One press: times (s), true depths (mm), force with and without the stranger, slope (N/mm)."""

    time: np.ndarray
    depth: np.ndarray
    force: np.ndarray
    without: np.ndarray
    slope: np.ndarray
    tool: str = ""


def drawn(seed, noise):
    """(presses, reader, stranger) of a case."""
    presses, seen = [], {}
    force, read = closed_forms._Tissue.force, closed_forms._Reader.read

    def forced(tissue, time, depth, radius):
        found = force(tissue, time, depth, radius)
        stranger, tissue.stranger = tissue.stranger, None
        at = [force(tissue, time, depth + off, radius) for off in (0.0, -STEP_MM, STEP_MM)]
        tissue.stranger = seen["stranger"] = stranger
        presses.append(Press(time, depth, found, at[0], (at[2] - at[1]) / (2.0 * STEP_MM)))
        return found

    def recorded(reader, time, depth, forces, tool):
        seen["reader"], presses[-1].tool = reader, tool
        return read(reader, time, depth, forces, tool)

    with (
        mock.patch.object(closed_forms._Tissue, "force", forced),
        mock.patch.object(closed_forms._Reader, "read", recorded),
    ):
        closed_forms.draw(seed, STRANGER, noise)
    return presses, seen["reader"], seen["stranger"]


def length(presses, reader):
    """Length of what the stranger adds, in units of the noise, free of what else can make it."""
    tools = sorted({press.tool for press in presses})
    shared = 1 + len(tools)  # the modulus, and the first touch of each tool
    normal, along, whole = np.zeros((shared, shared)), np.zeros(shared), 0.0
    normal[range(shared), range(shared)] = [FREE**-2, *[TOUCH_MM**-2] * len(tools)]
    for press in presses:
        white = _whitening(press, reader)
        added = white(press.force - press.without)
        columns = np.zeros((len(press.time), shared))
        columns[:, 0] = press.without
        columns[:, 1 + tools.index(press.tool)] = press.slope
        columns, own = white(columns), white(_own(press, reader))
        # What is one recording's own has a prior of 1.
        inner = np.linalg.inv(np.eye(own.shape[1]) + own.T @ own)

        def free(a, b, own=own, inner=inner):
            return a.T @ b - (a.T @ own) @ inner @ (own.T @ b)

        normal += free(columns, columns)
        along += free(columns, added)
        whole += free(added, added)
    return float(np.sqrt(max(whole - along @ np.linalg.solve(normal, along), 0.0)))


def _own(press, reader):
    """What the family lets differ between recordings, each column of one standard deviation (N)."""
    time = press.time
    columns = [reader.gain * press.without, reader.touch * press.slope, np.full(len(time), reader.zero_n)]
    if reader.hum:
        turn = 2.0 * np.pi * reader.hum[1] * time
        columns += [FREE * np.sin(turn), FREE * np.cos(turn)]
    return np.column_stack(columns)


def _whitening(press, reader):
    """Function that makes a press's noise white and of size 1, of forces (N)."""
    time, n = press.time, len(press.time)
    even = reader.even.get(reader.family, 0.003)
    rate = np.gradient(press.without, time)
    late_s = min(0.004, 0.1 * np.diff(time).min()) if reader.family == "clock" else 0.0
    depth = reader.jitter**2 + reader.step**2 / 12.0
    white = (reader.share * press.without) ** 2 + depth * press.slope**2 + (late_s * rate) ** 2
    white = white + reader.step_n**2 / 12.0
    if not reader.memory and not reader.mean and reader.family != "wander":
        size = np.sqrt(white + even**2)
        return lambda forces: (forces.T / size).T
    apart = np.abs(time[:, None] - time)
    covariance = np.diag(white) + even**2 * (np.exp(-apart / reader.memory) if reader.memory else np.eye(n))
    if reader.family == "wander":
        covariance += 0.008**2 * np.minimum(time[:, None], time) / 10.0
    if reader.mean:
        covariance = _averaged(_averaged(covariance, reader).T, reader)
        covariance[range(n), range(n)] += 1e-4 * even**2  # neighbors' means are nearly alike, as files round them
    root = np.linalg.cholesky(covariance)
    return lambda forces: solve_triangular(root, _averaged(forces, reader), lower=True)


def _averaged(columns, reader):
    """Columns as an instrument's running mean has them."""
    if not reader.mean:
        return columns
    after = int(reader.mean[0] * reader.mean[1])
    before = reader.mean[0] - 1 - after
    number = np.arange(len(columns))
    at = np.clip(number[:, None] + np.arange(-before, after + 1), 0, len(columns) - 1)
    return columns[at].mean(axis=1)


def main():
    """Prints the lengths, and what was found of those that can be seen."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--noises", nargs="+", default=list(closed_forms.NOISES))
    parser.add_argument("--keep")
    given = parser.parse_args()
    counted = collections.defaultdict(collections.Counter)
    for noise in given.noises:
        for seed in range(given.seed, given.seed + given.cases):
            presses, reader, stranger = drawn(seed, noise)
            seen = length(presses, reader)
            said = _said(seed, noise, given.keep)
            print(f"{noise:16}{seed:6} {stranger.kind:11}{seen:8.1f}  {said}")
            group = "seen in 9 of 10 draws" if seen > SURE else "not always seen"
            counted[group, stranger.kind][said] += 1
            counted[group, "all"][said] += 1
    for (group, kind), counts in sorted(counted.items()):
        of, found = counts.total(), counts["right"]
        low, high = bounds(found, of)
        share = f"; right {found} of {of} ({100 * low:.0f} to {100 * high:.0f} %)" if given.keep else ""
        print(f"{group:22}{kind:11}{dict(counts)}{share}")


def _said(seed, noise, keep):
    """`right`, `missed` or `wrong`; nothing where no verdict is kept."""
    asked = Asked("closed_forms", seed, STRANGER, noise, "", keep)
    kept = asked.kept()
    if not kept or not kept.exists():
        return ""
    found = json.loads(kept.read_text())
    names = sorted({one["effect"] for one in found["findings"]}.union(*found["cannot_tell"]))
    return judged(asked, found["verdict"], names)


if __name__ == "__main__":
    main()
