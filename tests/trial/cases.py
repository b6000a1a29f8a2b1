"""The trial's cases as study folders: reads the public indices and what was recorded, never the labels.

    for case in names("trial"): write(case, folder)         # or "second", "calibration"

A case's folder is a study (recordings' format in README): curves of force over depth on a flat pad, each
protocol twice. `held_back(case)` names the protocols that it does not publish; `follow_up(case, wanted, folder)` adds
what was recorded next, any protocol up to twelve times (make_follow_ups.py). Cases `local_...` hold the maps of a mat,
on the pads of studies.py.

What is in: nine tissue effects, six pairs, seven instrument errors, four mixtures, three causes on no list, spots under
a mat, nulls of five kinds of scatter, studies that are ambiguous or too poor by design. What is not: friction, coupling
across creases, crosstalk and misregistration as causes, fibres, sliding, scans, the 2 mm punch; nothing is proved of
these. How to read severities and the sets of ambiguous cases is told in page.py.
"""

import functools
import json
import os
import zlib
from pathlib import Path

import numpy as np
from scipy.spatial import Delaunay
from trial import protocols, studies

HERE = Path(__file__).parent
KINDS = ("", "local_", "second_")  # of files
LARGER = "THENAR_TRIAL_LARGER"  # names the folder of the files `larger_...`, if there are any (make_larger.py)


def folders():
    """Where the files of every kind lie."""
    found = dict.fromkeys(KINDS, HERE)
    return found | {"larger_": Path(os.environ[LARGER])} if LARGER in os.environ else found


@functools.cache
def index():
    """The public indices: by case the split, the pad, what is published of it, and where its recordings are kept."""
    found = {}
    for kind, folder in folders().items():
        listed = json.loads((folder / f"{kind}cases.json").read_text())["cases"]
        found |= {name: about | {"kind": kind} for name, about in listed.items()}
    return found


@functools.cache
def _numbers():
    found = {}
    for kind, folder in folders().items():
        with np.load(folder / f"{kind}cases.npz") as table:
            found |= {name: table[name] for name in table.files}
    return found


def names(split):
    """Cases of `trial`, `calibration`, `second` or `larger`."""
    return [name for name, case in index().items() if case["split"] == split]


def recordings(case):
    """Recordings of a case in their order: protocol, repeat, order, first sample, newtons a step, held back or not."""
    about, found, first = index()[case], [], index()[case].get("first")
    for order, step in enumerate(about.get("steps_n", [])):
        repeat, number = divmod(order, len(protocols.PROTOCOLS))
        protocol = list(protocols.PROTOCOLS)[number]
        held = protocol not in about["published"] or repeat >= about["repeats"]
        one = {"protocol": protocol, "repeat": repeat, "order": order, "first": first, "step_n": step}
        found.append(one | {"held_back": held})
        first += len(protocols.sampled(about["pad"], protocol)[0])
    return found


def held_back(case):
    """Protocols that were recorded and are not in the study."""
    return sorted({one["protocol"] for one in recordings(case) if one["held_back"]})


def goes_on(case):
    """Whether something was recorded after the study."""
    return f"{case}/force" in _follow_ups()


def curve(case, number):
    """(times s, stated depths mm, forces N) of a case's recording."""
    one = recordings(case)[number]
    time, _ = protocols.sampled(index()[case]["pad"], one["protocol"])
    rows = slice(one["first"], one["first"] + len(time))
    table, kind = _numbers(), index()[case]["kind"]
    return time, table[f"{kind}depth"][rows] * protocols.STEP_MM, table[f"{kind}force"][rows] * one["step_n"]


def recorded_next(case, wanted):
    """What is recorded after a study, `wanted` times by protocol, in turn.

    Each is (protocol, times s, stated depths mm, forces N).
    """
    if not goes_on(case):
        raise ValueError(f"case {case} publishes every protocol, or too little: nothing was recorded after it")
    unknown = sorted(set(wanted) - set(protocols.PROTOCOLS))
    if unknown:
        raise ValueError(f"there is no protocol {', '.join(unknown)}; there are {', '.join(protocols.PROTOCOLS)}")
    pad, known = index()[case]["pad"], list(protocols.PROTOCOLS)
    motions = {name: protocols.sampled(pad, name) for name in known}
    table = _follow_ups()
    step, zero, force = (table[f"{case}/{what}"] for what in ("step_n", "zero_mm", "force"))
    times = len(step) // len(known)
    if max(wanted.values()) > times:
        raise ValueError(f"case {case} was recorded {times} times more, not {max(wanted.values())}")
    before = np.cumsum([0] + [len(motions[name][0]) for name in known for _ in range(times)])
    for repeat in range(max(wanted.values())):
        for protocol in (name for name, often in wanted.items() if repeat < often):
            number = known.index(protocol) * times + repeat
            time, depth = motions[protocol]
            rows = slice(before[number], before[number + 1])
            yield protocol, time, depth + float(zero[number]), force[rows] * step[number]


@functools.cache
def _follow_ups():
    with np.load(HERE / "follow_ups.npz") as table:
        return {name: table[name] for name in table.files}


def write(case, folder, more=()):
    """Writes the study, with recordings `more` after it, as of `recorded_next`."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    about = index()[case]
    if "mat" in about:
        _unpack(about, folder)
        return
    text = _head(about)
    published = [(number, one) for number, one in enumerate(recordings(case)) if not one["held_back"]]
    presses = [(number, one["protocol"], *curve(case, number)) for number, one in published]
    presses += [(2 * len(protocols.PROTOCOLS) + k, *one) for k, one in enumerate(more)]
    often = {}
    for order, protocol, *rows in presses:
        often[protocol] = often.get(protocol, 0) + 1
        file = f"press_{order}.csv"
        lines = [f"{t:.4f},{d:.4f},{f:.7f}" for t, d, f in zip(*rows, strict=True)]
        (folder / file).write_text("time_s,depth_mm,force_n\n" + "\n".join(lines) + "\n")
        text += (
            f'[[recordings]]\nname = "{protocol}, repeat {often[protocol]}"\nkind = "indentation"\nfile = "{file}"\n'
        )
        text += f'indenter = "{protocols.PROTOCOLS[protocol].tool}"\nsite = "pad"\n'
        text += f'protocol = "{protocol}"\norder = {order}\nrest_s = 300.0\n'
    (folder / "study.toml").write_text(text)
    (folder / "skin.ply").write_text(skin(about["pad"]))


def _unpack(about, folder):
    """Writes a case with maps: its files as they were packed, and its skin."""
    first, last = about["bytes"]
    for name, text in json.loads(zlib.decompress(_numbers()["files"][first:last].tobytes())).items():
        (folder / name).write_text(text)
    (folder / "skin.ply").write_text(studies.Pad(about["pad"], studies.MATS[about["mat"]][1]).skin())


def follow_up(case, wanted, folder):
    """The study again, with what was recorded next: times by protocol."""
    write(case, folder, tuple(recorded_next(case, wanted)))


def _head(about):
    """study.toml without its recordings."""
    thickness = protocols.PADS[about["pad"]][1]
    text = f"""[study]
title = "A pad over bone, pressed by three spheres"
[skin]
mesh = "skin.ply"
[skin.materials.default]
g0_mpa = 0.008
g_lim_mpa = 0.015
d_lim_mm = {0.3 * thickness:.3f}
thickness_mm = {thickness:.3f}
"""
    for tool in protocols.TOOLS:
        radius = protocols.radius(about["pad"], tool)
        text += f'[indenters.{tool}]\nshape = "sphere"\nradius_mm = {radius:.3f}\n'
    return text + "[sites.pad]\npoint_mm = [0.0, 0.0, 0.0]\ndirection = [0.0, 0.0, -1.0]\n"


@functools.cache
def skin(pad):
    """The pad at rest as a PLY file, facing +z: rings around first touch, closer there, points moved at random."""
    thickness = protocols.PADS[pad][1]
    random = np.random.default_rng(3)
    fine = 0.09 * thickness
    points, r = [np.zeros((1, 2))], 0.0
    while r < 3.2 * thickness:
        step = fine * (1.0 + 0.45 * max(0.0, r / thickness - 0.7))
        r += step
        count = max(6, round(2.0 * np.pi * r / (1.1 * step)))
        angle = 2.0 * np.pi * (np.arange(count) + random.random()) / count
        wobble = 0.12 * step * random.standard_normal((count, 2))
        points.append(np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1) + wobble)
    points = np.concatenate(points)
    triangles = Delaunay(points).simplices
    edges = points[triangles][:, 1:] - points[triangles][:, :1]
    turned = edges[:, 0, 0] * edges[:, 1, 1] < edges[:, 0, 1] * edges[:, 1, 0]
    triangles[turned] = triangles[turned][:, ::-1]
    head = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n"
    head += "property double x\nproperty double y\nproperty double z\n"
    head += f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    body = [f"{x:.5f} {y:.5f} 0.0" for x, y in points]
    return head + "\n".join(body + [f"3 {a} {b} {c}" for a, b, c in triangles]) + "\n"
