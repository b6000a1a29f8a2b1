"""A world of pads over bone: finite elements at finite strain, read with the noise and the habits of a laboratory.

    draw(seed, truth, noise) -> Case; Case.write(folder); judged(truth, stiffening, verdict, names) -> word

Force and contact area by depth come from `tests/proof/by_finite_elements/deep_pads.json` (FElupe; pads of two
fingertips, a phalanx and a palm; neo-Hookean, b = 0, or exponential, b = 1), scaled by a drawn size (lengths by s,
force by s^2) and a drawn modulus. Nothing here is computed by Thenar. Thenar's own model is a layer over bone whose
width a study does not state: against these pads its form is wrong by 5 to 10 %, other than by a modulus. So this world
asks what error of form alone makes a diagnosis say.

The tables are rough: as node after node comes to bear, a row lies off the cubic through its four neighbors by up to
0.7 % on fingers, 1.3 % on the palm under a cylinder and 4.7 % under the ball, which is left out. Smooth tools on smooth
skin have no such steps, so that a polynomial of fourth degree in depth is fitted to the logarithm of force over
depth^1.5 (Hertz's power). It departs from the first two rows, where few nodes bear, by up to 2.3 %,
from others by 0.5 %.

Truths, and the right answers, written down before anything was run (`judged`):

- `nothing` (b = 0). Right: nothing missing, or parameters. Too little data is a miss, every other verdict is wrong.
- `exponential` (b = 1). Right: the same, a stiffening law alone, or *cannot tell* between stiffening laws.
- `relaxation`: two terms of a Prony series convolved with the elastic force (quasi-linear; Fung 1993).
- `cycle_softening`: damage by work, with four cycles first and no rest between recordings.
- `saturation`: a load cell that clips.
- `bone`: nothing else, but the study states a tissue 0.55 or 1.8 times as thick as it is (written down 2026-11-29).
- `relaxation_and_saturation`: both (written down 2026-11-29, as the next).
- `stranger`: what is on no list of effects, of closed forms (`Stranger`). Right: *unlisted*, without a name; every
  *cannot tell* is a miss.

Of all but the first two, drawn with b = 0 and b = 1, right is that name, with b = 1 also next to a stiffening law.
No name, *unlisted*, too little data and *cannot tell* that holds the truth are misses; every other name is wrong.

A convolution of the force is exact only while contact does not shrink and shape and time separate (Lee and Radok 1960),
so recordings of `relaxation` end with the hold. Damage that multiplies the whole force is softening alike everywhere in
the tissue, a simplification: in a real pad it is largest where strain is.

Noise families (`NOISES`), with what every study has: first touch judged with 5 um of scatter between recordings, area
read with 3 % + 0.2 mm2 where it is read.

- `laboratory`: force 1 % + 5 mN, depth 10 um, all white (as `../shared/studies`).
- `slow`: force 0.5 % white, and 4 mN that forgets itself in 0.25 s; zero of the cell off by 5 mN in each recording.
- `remounted`: each recording with its own gain (3 %) and first touch (20 um); 3 mN white.
- `stepper`: depth in steps of 10 um, force in steps of 2 mN; 3 mN white.
- `judged_late`: first touch judged 50 to 150 um late by eye, alike with each tool, with 10 um of scatter; 1 % and 4 mN.
- `precise`: 50 uN white; first touch and gain of each recording off by 0.5 um and 0.05 % only.

Habits, drawn too: depths of 15 to 40 % of the tissue; one tool or two of plate, 24 mm cylinder and 12 mm sphere (times
s); one speed or two; a hold or none; 2 to 4 repeats; area read or not. Except in `bone` the thickness is stated as it
is; the width of the bone is not stated; moduli are stated as `../shared/studies` do.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.polynomial import Polynomial
from scipy.interpolate import PchipInterpolator
from scipy.spatial import ConvexHull
from trial.worlds.closed_forms import Stranger

NOISES = ("laboratory", "slow", "remounted", "stepper", "judged_late", "precise")
LATE_MM = (0.05, 0.15)
TRUTHS = (
    *("nothing", "exponential", "relaxation", "cycle_softening", "saturation", "bone"),
    *("relaxation_and_saturation", "stranger"),
)
TABLE = json.loads((Path(__file__).parents[2] / "proof/by_finite_elements/deep_pads.json").read_text())
SIZE = (0.85, 1.15)
MODULUS_MPA = (0.006, 0.02)
SHARE = (0.15, 0.4)  # largest depth over thickness
MISSTATED = (0.55, 1.8)  # thickness stated over the true one, of `bone`
LIFT_MM = 0.1
SMOOTH = 4  # degree
STIFFENING = "stiffening_law"


@dataclass(frozen=True)
class Pad:
    """A pad of the tables, larger by `size`, of tissue with that modulus (MPa) and stiffening b."""

    name: str
    size: float
    modulus_mpa: float
    stiffening: float

    @property
    def semi_axes_mm(self):
        """Of the skin: along the finger, across it, down to the apex."""
        return self.size * np.array(TABLE["pads"][self.name]["skin_semi_axes_mm"])

    @property
    def thickness_mm(self):
        """Of the tissue under the apex."""
        return self.semi_axes_mm[2] - self.size * TABLE["pads"][self.name]["bone_semi_axes_mm"][2]

    def _rows(self, tool):
        return np.array(TABLE["pads"][self.name]["tools"][tool][f"{self.stiffening:.1f}"])

    def force_n(self, tool, depth_mm):
        """At depths; 0 above the skin; from touch to the first row the logarithm goes on straight."""
        depth, force = self._rows(tool)[:, :2].T
        # The first nodes in contact make the largest steps.
        curve = Polynomial.fit(depth, np.log(force / depth**1.5), SMOOTH, w=depth)
        x = np.maximum(np.asarray(depth_mm, dtype=float) / self.size, 0.0)
        if x.max() > depth[-1]:
            raise ValueError(f"{self.name} under {tool}: {x.max():.2f} mm is deeper than the table's {depth[-1]:.2f}")
        inside = np.maximum(x, depth[0])
        found = curve(inside) + (x - inside) * curve.deriv()(depth[0])
        return self.size**2 * self.modulus_mpa / TABLE["shear_modulus_mpa"] * x**1.5 * np.exp(found)

    def area_mm2(self, tool, depth_mm):
        """Contact area at depths; 0 above the skin."""
        rows = self._rows(tool)
        curve = PchipInterpolator(np.append(0.0, rows[:, 0]), np.append(0.0, rows[:, 2]))
        return self.size**2 * curve(np.clip(np.asarray(depth_mm) / self.size, 0.0, rows[-1, 0]))


@dataclass(frozen=True)
class Recording:
    """One file: protocol, tool, and columns time (s), read depth (mm), read force (N), read area (mm2) or none."""

    protocol: str
    tool: str
    table: np.ndarray


@dataclass(frozen=True)
class Case:
    """A study: the pad, what was recorded, in order, the rest between recordings (s; None: not stated), and the
    thickness that it states over the true one.
    """

    pad: Pad
    recordings: list
    rest_s: float | None
    stated: float = 1.0

    def write(self, folder):
        """Writes `study.toml`, `skin.ply` and the recordings."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "skin.ply").write_text(ply(*half_ellipsoid(self.pad.semi_axes_mm, 0.17 * self.pad.thickness_mm)))
        text = f'[study]\ntitle = "Pad of {self.pad.name}"\n[skin]\nmesh = "skin.ply"\n[skin.materials.default]\n'
        thickness_mm = self.stated * self.pad.thickness_mm
        text += f"g0_mpa = 0.006\ng_lim_mpa = 0.05\nd_lim_mm = 4.0\nthickness_mm = {thickness_mm:.2f}\n"
        for tool in sorted({one.tool for one in self.recordings}):
            text += f"[indenters.{tool}]\n" + _shape(tool, self.pad.size)
        text += f"[sites.apex]\npoint_mm = [0.0, 0.0, {self.pad.semi_axes_mm[2]:.5f}]\ndirection = [0.0, 0.0, -1.0]\n"
        for number, one in enumerate(self.recordings):
            head = ["time_s", "depth_mm", "force_n", "area_mm2"][: one.table.shape[1]]
            np.savetxt(
                folder / f"r{number:02d}.csv", one.table, "%.5f", delimiter=",", header=",".join(head), comments=""
            )
            text += f'[[recordings]]\nname = "{one.protocol}, {one.tool}, number {number}"\nkind = "indentation"\n'
            text += f'file = "r{number:02d}.csv"\nindenter = "{one.tool}"\nsite = "apex"\n'
            text += f'protocol = "{one.protocol} {one.tool}"\norder = {number}\n'
            text += "" if self.rest_s is None else f"rest_s = {self.rest_s}\n"
        (folder / "study.toml").write_text(text)


def judged(truth, stiffening, verdict, names):
    """`right`, `missed` or `wrong`, as the table above has it; `names` of the findings, or of what is not separable."""
    allowed = {STIFFENING} if stiffening else set()
    planted = truth not in ("nothing", "exponential")
    if verdict == "fault":
        return "wrong"
    if verdict == "insufficient_data":
        return "missed"
    if not planted:
        is_silent = verdict in ("nothing_missing", "parameters")
        is_law = verdict in ("missing_physics", "cannot_tell") and bool(names) and set(names) <= allowed
        return "right" if is_silent or is_law else "wrong"
    wanted = set() if truth == "stranger" else set(truth.split("_and_"))
    if verdict == "cannot_tell":
        return "missed" if truth == "stranger" or wanted & set(names) else "wrong"
    if set(names) - allowed - wanted:
        return "wrong"
    if truth == "stranger":
        return "right" if verdict == "unlisted" and not names else "missed"
    return "right" if wanted <= set(names) else "missed"


def draw(seed, truth, noise):
    """A case; the same arguments give the same case. ValueError for an unknown truth or noise."""
    if truth not in TRUTHS or noise not in NOISES:
        raise ValueError(f"no world of {truth} with {noise}")
    random = np.random.default_rng([seed, 1, *truth.encode(), 0, *noise.encode()])
    stiffening = {"nothing": 0.0, "exponential": 1.0}.get(truth, float(random.integers(2)))
    name = random.choice(list(TABLE["pads"]))
    pad = Pad(str(name), random.uniform(*SIZE), np.exp(random.uniform(*np.log(MODULUS_MPA))), stiffening)
    tools = ["plate", "cylinder"] if name == "palm" else ["plate", "cylinder", "sphere"]
    tools = [str(tool) for tool in random.permutation(tools)[: random.integers(1, 3)]]
    deepest = random.uniform(*SHARE) * pad.thickness_mm
    protocols = _protocols(truth, random)
    repeats = int(random.integers(2, 5))
    reader = _Reader(noise, random.random() < 0.5, random)
    mechanism = _Mechanism(truth, (pad, deepest), random)
    if truth == "saturation":
        reader.ceiling_n = random.uniform(0.75, 0.92) * min(pad.force_n(tool, deepest).max() for tool in tools)
    elif truth.endswith("saturation"):
        motions = [_motion(deepest, *protocol[1:], truth) for protocol in protocols]
        most = [max(mechanism.force_n(tool, *motion).max() for motion in motions) for tool in tools]
        reader.ceiling_n = random.uniform(0.75, 0.92) * min(most)
    recordings = []
    for tool in tools:
        for protocol, speed, hold_s, cycles in protocols:
            time, depth = _motion(deepest, speed, hold_s, cycles, truth)
            for _ in range(repeats):
                force = mechanism.force_n(tool, time, depth)
                table = reader.read(time, depth, force, pad.area_mm2(tool, depth))
                recordings.append(Recording(protocol, tool, table))
    stated = float(random.choice(MISSTATED)) if truth == "bone" else 1.0
    return Case(pad, recordings, None if truth == "cycle_softening" else 120.0, stated)


def _protocols(truth, random):
    """(name, speed mm/s, hold s, cycles) of each."""
    fades = truth.startswith("relaxation")
    speeds = [0.5, 4.0] if fades or random.random() < 0.6 else [1.0]
    hold_s = random.uniform(2.0, 4.0) if fades or random.random() < 0.6 else 0.0
    protocols = [(f"press {speed:g} mm per s", speed, hold_s, 1) for speed in speeds]
    if truth == "cycle_softening":
        protocols.insert(0, ("four cycles", 1.0, 0.0, 4))
    return protocols


def _motion(deepest, speed, hold_s, cycles, truth):
    """Times (s) and true depths (mm): from above the skin, down, a hold, up, apart; relaxation ends with the hold."""
    knots = [(0.0, -LIFT_MM)]
    ramp = (deepest + LIFT_MM) / speed
    for _ in range(cycles):
        knots.append((knots[-1][0] + ramp, deepest))
        if hold_s:
            knots.append((knots[-1][0] + hold_s, deepest))
        if not truth.startswith("relaxation"):
            knots += [(knots[-1][0] + ramp, -LIFT_MM), (knots[-1][0] + ramp + 0.4, -LIFT_MM)]
    knots = np.array(knots)
    rate = min(200.0, 40.0 / ramp)
    time = np.arange(0.0, knots[-1, 0], 1.0 / rate)
    return time, np.interp(time, knots[:, 0], knots[:, 1])


class _Mechanism:
    """The truth's force of each recording, in the order of the session."""

    def __init__(self, truth, skin, random):
        self.truth, (self.pad, deepest) = truth, skin
        self.terms = [
            (random.uniform(0.12, 0.25), random.uniform(0.2, 0.6)),
            (random.uniform(0.1, 0.2), random.uniform(2.0, 5.0)),
        ]
        self.share, self.presses = random.uniform(0.15, 0.4), random.uniform(1.0, 5.0)
        self.damage = 0.0
        self.stranger = Stranger(deepest, random) if truth == "stranger" else None

    def force_n(self, tool, time, depth):
        elastic = self.pad.force_n(tool, depth)
        if self.stranger is not None:
            return elastic * self.stranger.factor(time, depth)
        if self.truth.startswith("relaxation"):
            return faded(time, elastic, self.terms)
        if self.truth == "cycle_softening":
            return elastic * (1.0 - self.share * self._damaged(depth, elastic))
        return elastic

    def _damaged(self, depth, elastic):
        """Damage at each moment: of what is whole, work in loading spoils a part; one press does 1 of `presses`."""
        loading = np.maximum(np.diff(np.maximum(depth, 0.0), prepend=max(depth[0], 0.0)), 0.0)
        work = np.cumsum(0.5 * (elastic + np.append(0.0, elastic[:-1])) * loading)
        one = work[: int(np.argmax(depth)) + 1][-1]
        course = 1.0 - (1.0 - self.damage) * np.exp(-work / (self.presses * one))
        self.damage = course[-1]
        return course


def faded(time, elastic, terms):
    """Force whose elastic part fades by terms (share, time constant s), elastic force straight between the times."""
    left = (1.0 - sum(share for share, _ in terms)) * elastic
    for share, tau in terms:
        held = share * elastic[0]
        branch = [held]
        for step, rise in zip(np.diff(time), np.diff(elastic), strict=True):
            held = held * np.exp(-step / tau) + share * rise * tau / step * -np.expm1(-step / tau)
            branch.append(held)
        left = left + np.array(branch)
    return left


class _Reader:
    """What a laboratory's instruments write of a recording."""

    def __init__(self, family, reads_area, random):
        self.family, self.reads_area, self.random = family, reads_area, random
        self.ceiling_n = np.inf
        self.late_mm = random.uniform(*LATE_MM) if family == "judged_late" else 0.0

    def read(self, time, depth, force, area):
        """Columns as they are written."""
        random, n = self.random, len(time)
        stated = depth + (0.0005 if self.family == "precise" else 0.005) * random.standard_normal()
        white = random.standard_normal(n)
        if self.family == "laboratory":
            stated = stated + 0.01 * random.standard_normal(n)
            read = force * (1.0 + 0.01 * random.standard_normal(n)) + 0.005 * white
        elif self.family == "slow":
            keep = np.exp(-(time[1] - time[0]) / 0.25)
            slow = [random.standard_normal()]
            for shock in white[1:]:
                slow.append(keep * slow[-1] + np.sqrt(1.0 - keep**2) * shock)
            read = force * (1.0 + 0.005 * random.standard_normal(n)) + 0.004 * np.array(slow)
            read += 0.005 * random.standard_normal()
        elif self.family == "judged_late":
            stated = stated - self.late_mm + 0.01 * random.standard_normal()
            read = force * (1.0 + 0.01 * random.standard_normal(n)) + 0.004 * white
        elif self.family == "precise":
            read = force * (1.0 + 0.0005 * random.standard_normal()) + 5e-5 * white
        elif self.family == "remounted":
            stated = stated + 0.02 * random.standard_normal()
            read = force * (1.0 + 0.03 * random.standard_normal()) + 0.003 * white
        else:
            stated = 0.01 * np.round(stated / 0.01)
            read = 0.002 * np.round((force + 0.003 * white) / 0.002)
        columns = [time, stated, np.minimum(read, self.ceiling_n)]
        if self.reads_area:
            noisy = area * (1.0 + 0.03 * random.standard_normal(n)) + 0.2 * random.standard_normal(n)
            columns.append(np.where(area > 0.0, np.maximum(noisy, 0.0), 0.0))
        return np.column_stack(columns)


def _shape(tool, size):
    if tool == "plate":
        return 'shape = "plane"\n'
    axis = "axis = [0.0, 1.0, 0.0]\n" if tool == "cylinder" else ""
    return f'shape = "{tool}"\nradius_mm = {size * TABLE["tools_radius_mm"][tool]:.4f}\n{axis}'


def half_ellipsoid(semi_axes, spacing):
    """(vertices, triangles) of the half above z = 0, about `spacing` mm apart, with a vertex at the apex."""
    a, b, c = semi_axes
    fine = np.linspace(0.0, np.pi, 4001)

    def evenly(x, y, about):
        """Angles at equal arcs of an ellipse, about so many mm apart, both ends and the middle among them."""
        arc = np.append(0.0, np.cumsum(np.hypot(np.diff(x), np.diff(y))))
        count = 2 * max(1, round(0.5 * arc[-1] / about))
        return np.interp(np.linspace(0.0, arc[-1], count + 1), arc, fine)

    points = []
    for along in evenly(a * np.cos(fine), c * np.sin(fine), spacing):
        ring = np.sin(along)
        if ring < 1e-6:
            points.append([(a * np.cos(along), 0.0, 0.0)])
            continue
        across = evenly(b * ring * np.cos(fine), c * ring * np.sin(fine), spacing)
        x = np.full(len(across), a * np.cos(along))
        points.append(np.column_stack([x, b * ring * np.cos(across), c * ring * np.sin(across)]))
    vertices = np.concatenate(points)
    vertices[np.abs(vertices) < 1e-9] = 0.0
    faces = ConvexHull(vertices / semi_axes, qhull_options="Qt").simplices
    faces = faces[(vertices[faces][:, :, 2] > 1e-6).any(axis=1)]
    corners = vertices[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = (normal * corners.mean(axis=1)).sum(axis=1) < 0.0
    faces[inward] = faces[inward][:, ::-1]
    return vertices, faces


def ply(vertices, faces):
    """The text of a PLY file."""
    lines = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}"]
    lines += [f"property double {axis}" for axis in "xyz"]
    lines += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    lines += [f"{x:.5f} {y:.5f} {z:.5f}" for x, y, z in vertices] + [f"3 {i} {j} {k}" for i, j, k in faces]
    return "\n".join(lines) + "\n"
