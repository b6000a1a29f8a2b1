"""A world of closed forms: spheres on a half-space, with the noise and the habits of laboratories.

    draw(seed, truth, noise, motion="ramps") -> Case; Case.write(folder)

Nothing here is computed by finite elements or by Thenar, and there is no error of form: what a diagnosis finds besides
the truth is its own fault. Noise and habits of recording are drawn apart, by families that no other world shares.

Truths: `nothing` (a rigid sphere in an incompressible half-space: Sneddon 1965, International Journal of Engineering
Science 3:47, of which Hertz is the limit at small depth) and `relaxation` (the same with a modulus that fades in two
terms; Lee and Radok 1960, Journal of Applied Mechanics 27:438, valid while the contact does not shrink, so that these
recordings end with their hold), `cycle_softening` (the modulus loses a share of up to 15 to 40 % as work is done on the
tissue: damage D grows as dD = (1 - D) dW / W1 in loading, and does not heal within the session), `nothing_in_cycles`
(the sessions of `cycle_softening`, and nothing missing) and `saturation` (the presses of `nothing`, read by a cell that
clips at 75 to 92 % of the largest force of the tool that needs least). A session of cycles begins with four, and states
the order of its recordings and no rest. Either each recording takes up the tissue as the last one left it, or each
repeat begins as the first of its protocol did.

Two together: `relaxation_and_saturation`, and `relaxation_and_cycle_softening` (presses that end with their hold, each
on the tissue as the last one left it; what fades has come back by then). `stranger` is one of three that are on no list
of effects: a pocket that collapses at a depth and takes 8 to 15 % of the force, a pulse of 6 to 12 % at 0.9 to 1.6 Hz,
or a joint that sticks and slips, 5 to 10 % every 0.12 to 0.25 mm.

Noise families (`NOISES`): what is recorded is the truth at the true depth, read with errors.

- `white`: 5 mN.
- `autocorrelated`: 5 mN that forgets itself in 0.3 s.
- `in_proportion`: 1 % of the reading and 2 mN.
- `depth_jitter`: the depth's reading jitters by 2 to 20 um; 3 mN.
- `encoder`: the depth is read in steps of 5 to 20 um; 3 mN.
- `fast_encoder`: the same with 20 times as many samples, so that many in a row read the same depth.
- `clock`: time stamps jitter by 4 ms, a tenth of the time between samples at most; 3 % of the samples are lost; 3 mN.
- `wander`: the zero of the force wanders by 8 mN in 10 s; 3 mN.
- `gain_scatter`: repeats differ by 4 % in force and 20 um in first touch; 5 mN.
- `stray`: 5 mN and one sample a recording that is off by a fifth of the peak.
- `mixture`: 1 %, 10 um of jitter, 3 % of gain, 3 mN that forgets itself in 0.1 s.
- `trigger`: depth counts from where the force passes 5 to 20 mN, so that all recordings begin late alike; 3 mN.
- `tared`: each recording's zero of the force is off by its own 5 to 20 mN (standard deviation); 3 mN.
- `coarse_force`: the force is read in steps of 5 to 20 mN, and has 0.5 to 5 mN of noise before.
- `precise`: 0.03 to 0.1 mN, a gain and a first touch that differ by 0.05 % and 0.5 um.
- `hum`: 2 to 8 mN at 0.3 to 4 Hz, in all recordings and without contact too, of any phase; 3 mN.
- `smoothed`: each force is the mean of 3 to 8 readings: those about it, or the last; 3 mN before.
- `stray_depth`: three depths a recording are off by 0.1 mm; 3 mN.
- `tool_length`: depth counts from where each tool's tip was measured to be, 40 to 120 um off either way; 3 mN.

Habits, drawn too: 2 to 4 repeats, 25 or 100 samples a ramp, with or without a hold, one tool or two, one speed or two.

Motions: straight ramps, or those of `motions.py` (where the truth is `nothing` or `saturation`), in which the depth of
`depth_jitter` jitters by 16 um.
"""

import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.spatial import Delaunay
from trial.worlds import motions

NOISES = (
    *("white", "autocorrelated", "in_proportion", "depth_jitter", "encoder", "fast_encoder", "clock", "wander"),
    *("gain_scatter", "stray", "mixture", "tared", "trigger", "tool_length", "precise", "coarse_force", "hum"),
    *("smoothed", "stray_depth"),
)
TRUTHS = (
    *("nothing", "relaxation", "cycle_softening", "nothing_in_cycles", "saturation"),
    *("relaxation_and_saturation", "relaxation_and_cycle_softening", "stranger"),
)
MOTIONS = ("ramps", *motions.MOTIONS)
MOVED = ("nothing", "saturation")  # truths with motions besides ramps
CEILING = (0.75, 0.92)
MODULUS_MPA, RADIUS_MM, DEEPEST_MM = (0.006, 0.02), (4.0, 9.0), (0.8, 1.6)
PATCH_MM = 16.0
TOOLS = ("ball", "large_ball")
TRIGGER_N = ZERO_N = (0.005, 0.02)
OFF_MM = (0.04, 0.12)


@dataclass(frozen=True)
class Recording:
    """One file: protocol, tool, and columns time (s), read depth (mm), read force (N)."""

    protocol: str
    tool: str
    table: np.ndarray


@dataclass(frozen=True)
class Case:
    """A study: radii of its tools (mm) and what was recorded."""

    radii: dict
    recordings: list
    deepest_mm: float
    rest_s: float | None = 120.0

    def write(self, folder):
        """Writes `study.toml`, `skin.ply` and the recordings."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "skin.ply").write_text(_patch(self.deepest_mm))
        text = '[study]\ntitle = "Spheres on a half-space"\n[skin]\nmesh = "skin.ply"\n[skin.materials.default]\n'
        text += 'g0_mpa = 0.009\ng_lim_mpa = 0.012\nd_lim_mm = 4.0\nthickness_mm = "inf"\n'
        for name, radius in self.radii.items():
            text += f'[indenters.{name}]\nshape = "sphere"\nradius_mm = {radius:.4f}\n'
        text += "[sites.middle]\npoint_mm = [0.0, 0.0, 0.0]\ndirection = [0.0, 0.0, -1.0]\n"
        for number, one in enumerate(self.recordings):
            buffer = io.StringIO()
            np.savetxt(buffer, one.table, "%.5f,%.5f,%.6f")
            (folder / f"r{number:02d}.csv").write_text("time_s,depth_mm,force_n\n" + buffer.getvalue())
            text += f'[[recordings]]\nname = "{one.protocol}, {one.tool}, number {number}"\nkind = "indentation"\n'
            text += f'file = "r{number:02d}.csv"\nindenter = "{one.tool}"\nsite = "middle"\n'
            text += f'protocol = "{one.protocol} {one.tool}"\norder = {number}\n'
            text += "" if self.rest_s is None else f"rest_s = {self.rest_s}\n"
        (folder / "study.toml").write_text(text)


def draw(seed, truth, noise, motion="ramps"):
    """A case; the same arguments give the same case. ValueError for what is not in this world."""
    is_moved = motion == "ramps" or (motion in MOTIONS and truth in MOVED)
    if truth not in TRUTHS or noise not in NOISES or not is_moved:
        raise ValueError(f"no world of {truth} with {noise} and {motion}")
    random = np.random.default_rng([seed, *truth.encode(), 0, *noise.encode()])
    modulus = np.exp(random.uniform(*np.log(MODULUS_MPA)))
    deepest = random.uniform(*DEEPEST_MM)
    first = random.uniform(*RADIUS_MM)
    radii = {"ball": first} | ({"large_ball": 2.2 * first} if random.random() < 0.5 else {})
    fades = truth.startswith("relaxation")
    speeds = [0.5, 4.0] if fades or random.random() < 0.6 else [1.0]
    has_hold = fades or random.random() < 0.6
    repeats, samples = random.integers(2, 5), random.choice([25, 100]) * (20 if noise == "fast_encoder" else 1)
    fading = None
    if fades:
        fading = [
            (random.uniform(0.12, 0.25), random.uniform(0.2, 0.6)),
            (random.uniform(0.1, 0.2), random.uniform(2.0, 5.0)),
        ]
    reader = _Reader(noise, random)
    if truth in ("cycle_softening", "nothing_in_cycles"):
        session = _Session(truth, modulus, random)
        protocols = [(tool, speed, has_hold) for tool in radii for speed in speeds]
        return Case(radii, session.recordings((radii, deepest), protocols, (reader, repeats, samples)), deepest, None)
    if truth == "saturation":
        reader.ceiling_n = random.uniform(*CEILING) * modulus * pressed(np.array([deepest]), first)[0]
    tissue = _Tissue(truth, (modulus, deepest), fading, random)
    if motion == "ramps":
        unloads = fading is None
        protocols = [(f"{v:g} mm/s", *_motion(deepest, v, has_hold, samples, unloads)) for v in speeds]
    else:
        protocols = motions.drawn(motion, deepest, np.random.default_rng([seed, *motion.encode()]))
        reader.jitter = motions.JITTER_MM if noise == "depth_jitter" else reader.jitter
    if truth == "relaxation_and_saturation":
        reader.ceiling_n = random.uniform(*CEILING) * max(tissue.force(*each[1:], first).max() for each in protocols)
    recordings = []
    for tool, radius in radii.items():
        for protocol, time, depth in protocols:
            for _ in range(repeats):
                at, true = reader.clocked(time, depth)
                read = reader.read(at, true, tissue.force(at, true, radius), tool)
                recordings.append(Recording(protocol, tool, read))
    return Case(radii, recordings, deepest, None if truth.endswith("cycle_softening") else 120.0)


class _Tissue:
    """What presses that end with their hold, or lift, meet, one after the other."""

    def __init__(self, truth, size, fading, random):
        self.modulus, deepest = size
        self.fading, self.damage = fading, 0.0
        self.session = _Session(truth, self.modulus, random) if truth.endswith("cycle_softening") else None
        self.stranger = Stranger(deepest, random) if truth == "stranger" else None

    def force(self, time, depth, radius):
        """N, of the next press: at times (s) and true depths (mm) of a sphere."""
        force = self.modulus * _faded(time, depth, radius, self.fading)
        if self.session is not None:
            course = self.session.damage(depth, self.modulus * pressed(depth, radius), self.damage)
            force, self.damage = force * (1.0 - self.session.share * course), course[-1]
        return force if self.stranger is None else force * self.stranger.factor(time, depth)


class Stranger:
    """What is on no list of effects, as a factor on the force."""

    def __init__(self, deepest, random):
        self.kind = random.choice(["pocket", "pulse", "stick_slip"])
        self.random = random
        self.at_mm = random.uniform(0.4, 0.7) * deepest
        self.width_mm = 0.04 * deepest
        self.share = random.uniform(*{"pocket": (0.08, 0.15), "pulse": (0.06, 0.12)}.get(self.kind, (0.05, 0.1)))
        self.rate_hz = random.uniform(0.9, 1.6)
        self.period_mm = random.uniform(0.12, 0.25)

    def factor(self, time, depth):
        """Of one recording: times (s) and true depths (mm)."""
        if self.kind == "pocket":
            return 1.0 - self.share / (1.0 + np.exp(-(depth - self.at_mm) / self.width_mm))
        if self.kind == "pulse":
            return 1.0 + self.share * np.sin(2.0 * np.pi * (self.rate_hz * time + self.random.random()))
        # It sticks while the way goes on, in either direction, and lets go all at once.
        way = np.cumsum(np.abs(np.diff(depth, prepend=depth[0])))
        side = np.sign(np.gradient(depth, time))
        return 1.0 + side * self.share * (way / self.period_mm % 1.0 - 0.5)


class _Session:
    """A session without rest on tissue that use softens; of `nothing_in_cycles`, by nothing."""

    def __init__(self, truth, modulus, random):
        self.modulus = modulus
        self.share, self.work = random.uniform(0.15, 0.4), random.uniform(0.5, 3.0)
        self.begins_alike = random.random() < 0.5
        if truth == "nothing_in_cycles":
            self.share = 0.0

    def recordings(self, tools, protocols, readings):
        """All recordings; `tools` radii and the largest depth (mm), `readings` the reader, repeats and samples."""
        (radii, deepest), (reader, repeats, samples) = tools, readings
        cycles = (next(iter(radii)), 1.0, False)
        damage, found = 0.0, []
        for tool, speed, has_hold in [cycles, *protocols]:
            is_cycled = not found
            time, depth = _motion(deepest, speed, has_hold, samples, unloads=True)
            if is_cycled:
                step = time[-1] + time[1]
                time = np.concatenate([time + k * step for k in range(4)])
                depth = np.tile(depth, 4)
            start = damage
            for _ in range(2 if is_cycled else repeats):
                before = start if self.begins_alike else damage
                at, true = reader.clocked(time, depth)
                elastic = self.modulus * pressed(true, radii[tool])
                course = self.damage(true, elastic, before)
                damage = course[-1]
                name = "four cycles" if is_cycled else f"{speed:g} mm/s"
                force = elastic * (1.0 - self.share * course)
                found.append(Recording(name, tool, reader.read(at, true, force, tool)))
        return found

    def damage(self, depth, elastic, before):
        """D at each moment: the scale of work is that of one press to this depth."""
        rises = np.maximum(np.diff(np.maximum(depth, 0.0), prepend=depth[0]), 0.0)
        work = np.cumsum(elastic * rises)
        one = np.max(elastic) * np.max(depth) * 0.4
        return 1.0 - (1.0 - before) * np.exp(-work / (self.work * one))


def _motion(deepest, speed, has_hold, samples, unloads):
    """Times (s) and true depths (mm): a little above the skin, down, a hold, up, apart."""
    lift = 0.15
    knots = [(0.0, -lift), ((deepest + lift) / speed, deepest)]
    if has_hold:
        knots.append((knots[-1][0] + 4.0, deepest))
    if unloads:
        knots.append((knots[-1][0] + (deepest + lift) / speed, -lift))
        knots.append((knots[-1][0] + 1.0, -lift))
    knots = np.array(knots)
    counts = [samples] + [max(samples // 2, 16)] * (len(knots) - 2)
    pieces = [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(knots[:-1, 0], knots[1:, 0], counts, strict=True)]
    time = np.append(np.concatenate(pieces), knots[-1, 0])
    return time, np.interp(time, knots[:, 0], knots[:, 1])


def pressed(depth, radius):
    """Force over shear modulus (mm2) of a rigid sphere, radius in mm, at depths (mm); 0 above the skin.

    Sneddon: d = a/2 ln((R + a)/(R - a)) and F = 2 G ((a^2 + R^2) ln((R + a)/(R - a)) - 2 a R), a the contact's radius.
    """
    a = np.linspace(0.0, 0.95 * radius, 4000)
    log = np.log((radius + a) / (radius - a))
    force = 2.0 * ((a**2 + radius**2) * log - 2.0 * a * radius)
    # Over a power of the depth both are smooth.
    found = np.interp(np.maximum(depth, 0.0) ** 0.5, (0.5 * a * log) ** 0.5, np.cbrt(force))
    return np.where(np.asarray(depth) > 0.0, found, 0.0) ** 3


def _faded(time, depth, radius, fading):
    """`pressed` with a modulus that fades: sum over steps of what each adds times what is left of it."""
    if fading is None:
        return pressed(depth, radius)
    fine = np.linspace(time[0], time[-1], 8000)
    rises = np.diff(pressed(np.interp(fine, time, depth), radius), prepend=0.0)
    faded = np.zeros_like(fine)
    for share, period in [(1.0 - sum(s for s, _ in fading), np.inf), *fading]:
        keep, now, course = np.exp(-(fine[1] - fine[0]) / period), 0.0, np.empty_like(fine)
        for k, rise in enumerate(rises):
            now = now * keep + rise
            course[k] = now
        faded += share * course
    return np.interp(time, fine, faded)


class _Reader:
    """Instruments of one family: what they make of times, depths and forces."""

    def __init__(self, family, random):
        self.family, self.random = family, random
        self.jitter = {"depth_jitter": random.uniform(0.002, 0.02), "mixture": 0.01}.get(family, 0.0)
        self.step = random.uniform(0.005, 0.02) if family.endswith("encoder") else 0.0
        self.share = {"in_proportion": 0.01, "mixture": 0.01}.get(family, 0.0)
        self.gain = {"gain_scatter": 0.04, "mixture": 0.03, "precise": 0.0005}.get(family, 0.005)
        self.touch = {"gain_scatter": 0.02, "precise": 0.0005}.get(family, 0.004)
        self.even = {
            "white": 0.005,
            "autocorrelated": 0.005,
            "gain_scatter": 0.005,
            "stray": 0.005,
            "in_proportion": 0.002,
            "precise": random.uniform(3e-5, 1e-4) if family == "precise" else 0.0,
        }
        self.step_n = 0.0
        if family == "coarse_force":
            self.step_n, self.even[family] = random.uniform(0.005, 0.02), random.uniform(0.0005, 0.005)
        self.hum = (random.uniform(0.002, 0.008), random.uniform(0.3, 4.0)) if family == "hum" else None
        self.mean = (random.integers(3, 9), random.choice([0.0, 0.5])) if family == "smoothed" else None
        self.memory = {"autocorrelated": 0.3, "mixture": 0.1}.get(family, 0.0)
        self.ceiling_n = np.inf
        self.trigger_n = random.uniform(*TRIGGER_N) if family == "trigger" else 0.0
        self.zero_n = random.uniform(*ZERO_N) if family == "tared" else 0.0
        self.off_mm = {}
        if family == "tool_length":
            self.off_mm = {tool: random.uniform(*OFF_MM) * random.choice([-1.0, 1.0]) for tool in TOOLS}

    def clocked(self, time, depth):
        """The moments at which samples were taken, and the true depths then."""
        if self.family != "clock":
            return time, depth
        kept = self.random.random(len(time)) > 0.03
        kept[[0, -1]] = True
        return time[kept], depth[kept]

    def read(self, time, depth, force, tool):
        """Columns as they are written, of a press of a tool."""
        random, n = self.random, len(time)
        noise = random.standard_normal(n)
        if self.memory:
            for k in range(1, n):
                keep = np.exp(-(time[k] - time[k - 1]) / self.memory)
                noise[k] = keep * noise[k - 1] + np.sqrt(1.0 - keep**2) * noise[k]
        read = force * (1.0 + self.gain * random.standard_normal()) + self.even.get(self.family, 0.003) * noise
        read += self.share * force * random.standard_normal(n)
        if self.zero_n:
            read += self.zero_n * random.standard_normal()
        if self.family == "wander":
            steps = np.sqrt(np.diff(time, prepend=time[0]) / 10.0)
            read += 0.008 * np.cumsum(steps * random.standard_normal(n))
        if self.hum:
            read += self.hum[0] * np.sin(2.0 * np.pi * (self.hum[1] * time + random.random()))
        if self.mean:
            after = int(self.mean[0] * self.mean[1])
            padded = np.pad(read, (self.mean[0] - 1 - after, after), mode="edge")
            read = sliding_window_view(padded, self.mean[0]).mean(axis=1)
        if self.family == "stray":
            read[random.integers(n // 4, n)] += random.choice([-0.2, 0.2]) * force.max()
        stated = depth + self.touch * random.standard_normal() + self.jitter * random.standard_normal(n)
        stated -= self.off_mm.get(tool, 0.0) + triggered(depth, force, self.trigger_n)
        if self.family == "stray_depth":
            stated[random.choice(n, 3, replace=False)] += random.choice([-0.1, 0.1], 3)
        stated = stepped(stated, self.step)
        if self.family == "clock":
            least = 0.1 * np.diff(time).min()
            time = np.sort(time + min(0.004, least) * random.standard_normal(n)) + 0.1 * least * np.arange(n)
        return np.column_stack([time - time[0], stated, stepped(np.minimum(read, self.ceiling_n), self.step_n)])


def stepped(values, step):
    """Values rounded to a step; as they are where there is none."""
    return step * np.round(values / step) if step else values


def triggered(depth, force, least_n):
    """Depth (mm) at which the force of a press first passes `least_n`; 0 where that is 0."""
    if least_n <= 0.0:
        return 0.0
    passed = int(np.argmax(force > least_n))
    return float(np.interp(least_n, force[passed - 1 : passed + 1], depth[passed - 1 : passed + 1]))


def _patch(deepest):
    """A flat patch as a PLY file, finer in its middle; +z is out."""
    random = np.random.default_rng(11)
    points, r, step = [np.zeros((1, 2))], 0.0, 0.35 * max(deepest, 0.8)
    while r < PATCH_MM:
        grown = step * (1.0 + 0.12 * max(0.0, r - 4.0))
        r += grown
        count = max(6, round(2.0 * np.pi * r / (1.1 * grown)))
        angle = 2.0 * np.pi * (np.arange(count) + random.random()) / count
        points.append(
            r * np.stack([np.cos(angle), np.sin(angle)], axis=1) + 0.1 * grown * random.standard_normal((count, 2))
        )
    points = np.concatenate(points)
    faces = Delaunay(points).simplices
    a, b, c = (points[faces[:, k]] for k in range(3))
    turned = (b - a)[:, 0] * (c - a)[:, 1] < (b - a)[:, 1] * (c - a)[:, 0]
    faces[turned] = faces[turned][:, ::-1]
    lines = ["ply", "format ascii 1.0", f"element vertex {len(points)}"]
    lines += [f"property double {axis}" for axis in "xyz"]
    lines += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    lines += [f"{x:.5f} {y:.5f} 0.0" for x, y in points] + [f"3 {i} {j} {k}" for i, j, k in faces]
    return "\n".join(lines) + "\n"
