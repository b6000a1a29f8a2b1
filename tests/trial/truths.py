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
        self.pad, self.grips, self.parts, self.loading, self.curves = pad, (), {}, {}, {}
        if effect == "adhesion":
            known = [one for one in protocols.GRIPS if f"{pad}/{effect}/{variant}/{one}/{RICH[-1]}" in runs()]
            self.grips = tuple(known)
        amplitudes = self.grips or computed(pad)
        for name in RICH:
            rest = runs()[f"{pad}/none/0/0/{name}"].astype(float)
            keys = {one: f"{pad}/{effect}/{variant}/{one}/{name}" for one in amplitudes}
            added = {one: runs()[key].astype(float) - rest for one, key in keys.items() if key in runs()}
            time, depth = protocols.sampled(pad, name)
            is_fine = len(added) > len(protocols.AMPLITUDES) and not self.grips
            if not self.grips and not is_fine:
                added = _parabola(added, rest)
            more = {one: along(pad, name, force, time) for one, force in added.items()}
            if is_fine:
                forces = np.array([np.zeros_like(time), *more.values()])
                self.curves[name] = PchipInterpolator([0.0, *more], forces, axis=0)
            self.parts[name] = (time, depth, along(pad, name, rest, time), more)
            self.loading[name] = _loading(pad, name, rest)

    def added(self, name, amplitude):
        """What the effect adds to a protocol's force, N for G = 0.01 MPa; of a grip the nearest that was computed."""
        more = self.parts[name][3]
        if name in self.curves:
            return self.curves[name](amplitude)
        if not self.grips:
            return amplitude * more[0] + amplitude**2 * more[1]
        nearest = min(self.grips, key=lambda one: abs(one - amplitude))
        return more[nearest] if amplitude > 0.0 else 0.0 * more[nearest]

    def whole(self, name, amplitude):
        """A protocol's force with the effect, N for G = 0.01 MPa."""
        _, _, rest, more = self.parts[name]
        if self.grips or name in self.curves:
            return rest + self.added(name, amplitude)
        # Summed in this order, so that the same cases keep their bytes.
        return rest + amplitude * more[0] + amplitude**2 * more[1]

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

    def whole(self, name, amplitude):
        """A protocol's force with both, N for G = 0.01 MPa."""
        return self.parts[name][2] + self.added(name, amplitude)

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
    """Amplitudes at which this effect was computed on this pad: what it looks like between weak and strong."""
    tried = sorted({*protocols.GRIPS, *computed(pad)})
    return tuple(one for one in tried if f"{pad}/{effect}/{variant}/{one}/{RICH[-1]}" in runs())


def _parabola(added, rest):
    """Both parts of what goes as x (first) + x^2 (second), from what was computed at two amplitudes or one (a line)."""
    half, most = protocols.AMPLITUDES
    high = added.get(most, np.zeros_like(rest))
    low = added.get(half, half * high)
    bent = (high - low / half) / (1.0 - half)
    return {0: high - bent, 1: bent}


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
