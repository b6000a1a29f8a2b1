"""Forces of every truth of the trial, before scatter and noise, at any amplitude, from truth_runs.npz. N, mm, s.

Between the amplitudes that were computed an effect is drawn on the parabola or line through two or one, on the pads of
the second trial on the monotone cubics through five. (A line is no drainage: the water of a stiffer skeleton leaves
sooner, and most under the widest tool.) Of a grip there are no others than those: where it lets go depends on its
strength. Two effects add up, and what both do together beyond that, computed at full amplitude, goes as the product of
theirs; with a grip, as far as it still pulls.
"""

import functools
from pathlib import Path

import numpy as np
from scipy.interpolate import PchipInterpolator
from trial import observing, protocols

HERE = Path(__file__).parent
REPEATS = 2
RICH = tuple(protocols.PROTOCOLS)


class Truth:
    """The forces of one pad with one effect at any amplitude between 0 and 1."""

    def __init__(self, pad, effect="none", variant=0):
        self.pad, self.parts, self.loading = pad, {}, {}
        known = forms(pad, effect, variant)
        self.grips = known if effect == "adhesion" else ()
        for name in RICH:
            rest = runs()[f"{pad}/none/0/0/{name}"].astype(float)
            time, depth = protocols.sampled(pad, name)
            added = {one: runs()[f"{pad}/{effect}/{variant}/{one}/{name}"].astype(float) - rest for one in known}
            drawn = _nearest if self.grips else _smooth if len(known) > len(protocols.AMPLITUDES) else _parabola
            more = drawn(added, lambda force, name=name, time=time: along(pad, name, force, time))
            self.parts[name] = (time, depth, along(pad, name, rest, time), more)
            self.loading[name] = _loading(pad, name, rest)

    def added(self, name, amplitude):
        """What the effect adds to a protocol's force, N for G = 0.01 MPa; of a grip the nearest that was computed."""
        return self.parts[name][3](amplitude)

    def whole(self, name, amplitude):
        """A protocol's force with the effect, N for G = 0.01 MPa."""
        return self.parts[name][2] + self.added(name, amplitude)

    def presses(self, amplitude, growth):
        """Every protocol twice, the second time after all the others; forces in N for moduli (G0, Glim)."""
        found = []
        for repeat in range(REPEATS):
            for number, name in enumerate(RICH):
                time, depth = self.parts[name][:2]
                force = self.whole(name, amplitude) / 0.01 * modulus(self.pad, depth, growth)
                order = number + repeat * len(RICH)
                found.append(observing.Press(name, repeat, order, time, depth, depth.copy(), force))
        return found

    def base(self, press):
        """Columns by which a recording's base model is linear in G0 and in Glim - G0, at the stated depths."""
        within, deepest, most, power = self.loading[press.protocol]
        stated = np.maximum(press.stated, 0.0)
        beyond = most * (np.maximum(stated, deepest) / deepest) ** power
        force = np.where(stated > deepest, beyond, within(np.minimum(stated, deepest))) / 0.01
        return np.stack([force, force * modulus(self.pad, stated, (0.0, 1.0))], axis=1)


class Pair(Truth):
    """The same with two effects, each at its own amplitude."""

    def __init__(self, pad, effects):
        super().__init__(pad)
        self.both = [truth_of(pad, one, 0) for one in effects]
        self.cross = {}
        for name in RICH:
            whole = runs()[f"{pad}/{'+'.join(effects)}/0/1.0/{name}"] - runs()[f"{pad}/none/0/0/{name}"].astype(float)
            alone = sum(one.added(name, 1.0) for one in self.both)
            self.cross[name] = along(pad, name, whole, self.parts[name][0]) - alone

    def added(self, name, amplitude):
        """What both add at the amplitudes (first, second), N for G = 0.01 MPa."""
        each = [one.added(name, share) for one, share in zip(self.both, amplitude, strict=True)]
        together = self.cross[name]
        for one, share, more in zip(self.both, amplitude, each, strict=True):
            most = one.added(name, 1.0)
            pulls = bool(one.grips) & (most < -1e-3 * np.abs(most).max())
            together = together * np.where(pulls, np.clip(more / np.where(pulls, most, 1.0), 0.0, 1.0), share)
        return each[0] + each[1] + together


@functools.cache
def truth_of(pad, effect, variant):
    """One `Truth` for all cases that share it, of an effect or of two joined by a plus."""
    return Pair(pad, effect.split("+")) if "+" in effect else Truth(pad, effect, variant)


def computed(pad):
    """Amplitudes at which effects are computed on a pad, ascending."""
    return protocols.FINER if pad in protocols.SECOND else protocols.AMPLITUDES


def forms(pad, effect, variant):
    """Amplitudes at which this effect was computed on this pad, ascending: what it looks like from weak to strong."""
    tried = protocols.GRIPS if effect == "adhesion" else computed(pad)
    return tuple(one for one in tried if f"{pad}/{effect}/{variant}/{one}/{RICH[-1]}" in runs())


def _nearest(added, seen):
    """Of a grip what was computed next to an amplitude; at 0 nothing. `seen`: a force as it is sampled."""
    found = {one: seen(force) for one, force in added.items()}
    return lambda amplitude: found[min(found, key=lambda one: abs(one - amplitude))] * (amplitude > 0.0)


def _smooth(added, seen):
    found = [seen(force) for force in added.values()]
    return PchipInterpolator([0.0, *added], np.array([0.0 * found[0], *found]), axis=0)


def _parabola(added, seen):
    """What goes as x and x^2 between nothing and what was computed at two amplitudes, at one (a line) or at none."""
    half, most = protocols.AMPLITUDES
    if most not in added:
        return lambda amplitude: 0.0
    low = added.get(half, half * added[most])
    bent = (added[most] - low / half) / (1.0 - half)
    parts = seen(added[most] - bent), seen(bent)
    return lambda amplitude: amplitude * parts[0] + amplitude**2 * parts[1]


def _loading(pad, name, rest):
    """A protocol's force over depth as it goes in, with its largest depth, force and the power it goes on with."""
    steps = protocols.STEPS[0]
    way = protocols.course(pad, name, protocols.STEPS)[steps : 2 * steps + 1, 1]
    force = rest[steps : 2 * steps + 1]
    power = np.log(force[-1] / force[-3]) / np.log(way[-1] / way[-3])
    return PchipInterpolator(way, force), way[-1], force[-1], power


_RUNS = {}


def runs():
    """The finite elements' forces."""
    if not _RUNS:
        _RUNS.update(np.load(HERE / "truth_runs.npz"))
    return _RUNS


def modulus(pad, depth, growth):
    """G at a depth, of (G0, Glim)."""
    share = np.clip(depth / (0.3 * protocols.PADS[pad][1]), 0.0, 1.0)
    return growth[0] + (growth[1] - growth[0]) * share


def along(pad, name, force, time):
    """Forces at other times: smooth on every leg of the motion."""
    motion = protocols.course(pad, name, protocols.STEPS)
    ends = protocols.legs(pad, name)[:, 0]
    out = np.zeros_like(time)
    for start, end in zip(ends[:-1], ends[1:], strict=True):
        within = (motion[:, 0] >= start - 1e-9) & (motion[:, 0] <= end + 1e-9)
        here = (time > start - 1e-9) & (time <= end + 1e-9)
        out[here] = PchipInterpolator(motion[within, 0], force[within])(time[here])
    return out
