"""Which recordings repeat each other: they follow the same path of load. Knows nothing of files and Blender."""

from dataclasses import dataclass

import numpy as np

LOADED = 0.15
"""Share of the largest force from which on a recording counts as loaded; waits before and after are left out."""
_QUIET = 5
"""Samples whose median is taken before that, where there are enough: single readings of noise do not count."""
SAME_TIME = 0.15
"""Most that the loaded times of repeats differ, relative."""
SAME_PATH = 0.1
"""Largest standard deviation between paths that the machine follows, as a share of their range;
their sizes differ by no more either."""
SAME_SIZE = 1.2
"""Most that what the skin answers differs between repeats, as a factor: more is another tool, place or person."""
_POINTS = 80
_HOLD = 0.97
_LEAST_HOLD_S = 0.5


@dataclass(frozen=True)
class Track:
    """One recording: times (n), s; depth or travel (n), mm; force (n), N, pressing positive.

    `is_from_touch`: the length is a depth, which counts from first touch.
    """

    time_s: np.ndarray
    length_mm: np.ndarray
    force_n: np.ndarray
    is_from_touch: bool = True


def groups(tracks):
    """Number of the group, from 0 in order of appearance, of each track; None, which cannot be compared, is alone."""
    firsts, numbers = [], []
    for track in tracks:
        part = None if track is None else _loaded(track)
        number = next((k for k, first in enumerate(firsts) if _are_alike(first, part)), len(firsts))
        if number == len(firsts):
            firsts.append(part)
        numbers.append(number)
    return numbers


def _are_alike(first, second):
    """Whether two loaded parts follow one path; None does not."""
    if first is None or second is None:
        return False
    if abs(first.time_s[-1] - second.time_s[-1]) > SAME_TIME * max(first.time_s[-1], second.time_s[-1]):
        return False
    lengths, forces = (first.length_mm, second.length_mm), (first.force_n, second.force_n)
    return (_is_same(*lengths) and _is_near(*forces)) or (_is_same(*forces) and _is_near(*lengths))


def describe(track):
    """The path in words, as `1 mm/s to 0.8 mm, hold 4 s`; empty where nothing was pressed."""
    part = None if track is None else _loaded(track)
    if part is None or np.ptp(part.length_mm) <= 0.0:
        return ""
    depth, time = part.length_mm, part.time_s
    deepest = int(depth.argmax())
    rise = depth[: deepest + 1]
    marks = [int((rise >= depth[0] + share * (depth[deepest] - depth[0])).argmax()) for share in (0.2, 0.8)]
    took = time[marks[1]] - time[marks[0]]
    speed = 0.6 * (depth[deepest] - depth[0]) / took if took > 0.0 else 0.0
    text = f"{_short(speed)} mm/s to " if speed > 0.0 else "press to "
    text += f"{_short(reach_mm(track))} mm"
    held = _longest_s(time, depth >= depth[0] + _HOLD * (depth[deepest] - depth[0]))
    is_held = held > max(_LEAST_HOLD_S, 4.0 * (1.0 - _HOLD) / max(speed, 1e-9) * depth[deepest])
    return f"{text}, hold {_short(held)} s" if is_held else text


def is_still(track):
    """Whether the tool presses and does not move."""
    part = _loaded(track)
    return part is not None and np.ptp(part.length_mm) <= 0.0


def _longest_s(time, is_deep):
    """The longest stretch of time through which it is deep without a break."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], is_deep.astype(np.int8), [0]])))
    return max((float(time[last - 1] - time[first]) for first, last in edges.reshape(-1, 2)), default=0.0)


def reach_mm(track):
    """How deep the tool went, mm: of a travel about, as Hertz's force would have it (depth to the power 3/2)."""
    part = _loaded(track)
    if part is None:
        return 0.0
    if track.is_from_touch and track.length_mm.max() > 0.0:
        return float(track.length_mm.max())
    return float(np.ptp(part.length_mm)) / (1.0 - LOADED ** (2.0 / 3.0))


def _loaded(track):
    """The loaded part on `_POINTS` even times from 0, its length from 0; None where nothing was pressed."""
    force = track.force_n
    if len(force) < 3 or not np.isfinite(force).all() or force.max() <= 0.0:
        return None
    quiet = force
    if np.count_nonzero(force > 0.5 * force.max()) >= 3 * _QUIET:
        padded = np.pad(force, _QUIET // 2, mode="edge")
        quiet = np.median(np.lib.stride_tricks.sliding_window_view(padded, _QUIET), axis=1)
    threshold = LOADED * quiet.max()
    pressed = np.flatnonzero(quiet > threshold)
    if not len(pressed) or threshold <= 0.0:
        return None
    start = _crossing(track.time_s, quiet - threshold, pressed[0], -1)
    end = _crossing(track.time_s, quiet - threshold, pressed[-1], 1)
    if end <= start:
        return None
    time = np.linspace(start, end, _POINTS)
    length = np.interp(time, track.time_s, track.length_mm)
    return Track(time - time[0], length - length[0], np.interp(time, track.time_s, force))


def _crossing(time, over, inside, step):
    """When `over` passes zero between the sample `inside` and the one `step` from it, s."""
    outside = inside + step
    if not 0 <= outside < len(time):
        return time[inside]
    return time[inside] + (time[outside] - time[inside]) * over[inside] / (over[inside] - over[outside])


def _is_same(one, other):
    """Whether two paths agree but for their zero, which a coarse sampling leaves open."""
    span, sizes = max(np.ptp(one), np.ptp(other)), sorted((np.std(one), np.std(other)))
    is_along = np.std(one - other) <= SAME_PATH * span
    return bool(sizes[0] > 0.0 and is_along and sizes[1] <= (1.0 + SAME_PATH) * sizes[0])


def _is_near(one, other):
    """Whether two answers are of one size."""
    one, other = one - one.min(), other - other.min()
    whole = float(one @ one)
    return whole > 0.0 and 1.0 / SAME_SIZE <= float(one @ other) / whole <= SAME_SIZE


def _short(value):
    return f"{float(f'{value:.2g}'):g}"
