"""Motions of a stage in the world of closed forms besides its straight ramps: protocols with their true depths.

    drawn(motion, deepest_mm, random) -> [(protocol, times in s, true depths in mm)]

- `kinked`: approach at 0.9 mm/s, press at 0.2 mm/s from a depth of 0 to 30 % of the largest, hold, lift; read at 10 or
  25 Hz. In half of the studies a second protocol presses at 0.4 mm/s.
- `short`: a stand, a ramp of 0.25 s read at 10 Hz, a hold, a lift of 2 s; and a slow press as a second protocol.
- `stand`: a stand of 0.2 to 0.9 s, a ramp at 0.5 to 2 mm/s, a hold of 3 s, a lift of 2 s, a stand; read at 10 or 25 Hz.
- `s_curve`: the same course of a stage that takes the first and the last 10 to 30 % of a way's time to reach its speed
  and to leave it, at constant acceleration.
- `sine`: four periods of 3 s, read every 0.06 s; in half of the studies a second protocol with periods of 1.5 s.

The depth of an indenter is continuous and piecewise smooth in each; nothing else is shared with a reader of motions.
"""

import numpy as np

MOTIONS = ("kinked", "short", "sine", "stand", "s_curve")
LIFT_MM = 0.15
JITTER_MM = 0.016


def drawn(motion, deepest, random):
    """Protocols of a study; ValueError for an unknown motion."""
    if motion == "kinked":
        kink, rate = random.uniform(0.0, 0.3) * deepest, random.choice([10.0, 25.0])
        speeds = [0.2, 0.4] if random.random() < 0.5 else [0.2]
        return [(f"press at {speed:g} mm/s", *_kinked((kink, deepest), speed, rate)) for speed in speeds]
    if motion == "short":
        step = [(0.0, -LIFT_MM), (1.0, -LIFT_MM), (1.25, deepest), (7.25, deepest), (9.25, -LIFT_MM), (10.0, -LIFT_MM)]
        down = (deepest + LIFT_MM) / 0.3
        slow = [(0.0, -LIFT_MM), (down, deepest), (down + 2.0, deepest), (down + 4.0, -LIFT_MM)]
        return [("step", *_read(step, 10.0)), ("slow press", *_read(slow, 10.0))]
    if motion == "sine":
        periods = [3.0, 1.5] if random.random() < 0.5 else [3.0]
        return [(f"period of {period:g} s", *_sine(deepest, period)) for period in periods]
    if motion in ("stand", "s_curve"):
        stand, speed, rate = random.uniform(0.2, 0.9), random.uniform(0.5, 2.0), random.choice([10.0, 25.0])
        part = random.uniform(0.1, 0.3) if motion == "s_curve" else 0.0
        speeds = [speed, 0.5 * speed] if random.random() < 0.5 else [speed]
        return [(f"press at {v:.3g} mm/s", *_stood((stand, deepest, v), part, rate)) for v in speeds]
    raise ValueError(f"no motion {motion}")


def _kinked(depths, speed, rate):
    kink, deepest = depths
    knots = [(0.0, -3.0 * LIFT_MM)]
    for depth, at in ((kink, 0.9), (deepest, speed), (deepest, None), (-LIFT_MM, 0.8)):
        time, last = knots[-1]
        knots.append((time + (3.0 if at is None else abs(depth - last) / at), depth))
    return _read(knots, rate)


def _sine(deepest, period):
    time = np.arange(0.0, 4.0 * period, 0.06)
    height = 0.5 * (deepest + LIFT_MM)
    return time, height - LIFT_MM - height * np.cos(2.0 * np.pi * time / period)


def _stood(course, part, rate):
    """Times and depths: a stand (s), a way to a depth (mm) at a mean speed (mm/s), a hold, a lift, a stand; each way
    starts and stops within `part` of its time."""
    stand, deepest, speed = course
    knots = np.array(
        [
            (0.0, -LIFT_MM),
            (stand, -LIFT_MM),
            (stand + (deepest + LIFT_MM) / speed, deepest),
            (stand + (deepest + LIFT_MM) / speed + 3.0, deepest),
            (stand + (deepest + LIFT_MM) / speed + 5.0, -LIFT_MM),
            (stand + (deepest + LIFT_MM) / speed + 5.0 + stand, -LIFT_MM),
        ]
    )
    time = np.arange(0.0, knots[-1, 0], 1.0 / rate)
    leg = np.clip(np.searchsorted(knots[:, 0], time, side="right") - 1, 0, len(knots) - 2)
    start, end = knots[leg], knots[leg + 1]
    along = (time - start[:, 0]) / (end[:, 0] - start[:, 0])
    return time, start[:, 1] + (end[:, 1] - start[:, 1]) * _way(along, part)


def _way(along, part):
    """Part of a way gone at a part of its time, where speed grows and falls evenly within `part` of the time."""
    if part == 0.0:
        return along
    near = np.minimum(along, 1.0 - along)
    gone = np.where(near < part, near**2 / (2.0 * part), near - 0.5 * part) / (1.0 - part)
    return np.where(along <= 0.5, gone, 1.0 - gone)


def _read(knots, rate):
    """Times at a rate (Hz) and depths on straight lines between knots (s, mm)."""
    knots = np.array(knots)
    time = np.arange(0.0, knots[-1, 0], 1.0 / rate)
    return time, np.interp(time, knots[:, 0], knots[:, 1])
