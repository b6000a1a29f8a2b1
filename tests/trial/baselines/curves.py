"""The force curves of a study folder, as the baselines read them: one table for all recordings, with the base's force.

The base is the layer model of `thenar` without effects, pressed once for every tool of the study: its force at a unit
modulus over depth. What the baselines do with it is their own.
"""

import functools
import tomllib
from dataclasses import dataclass

import numpy as np
import thenar
from proof import meshes
from scipy.interpolate import PchipInterpolator

NODES = 16  # depths at which a tool is pressed
UNIT_MPA = 0.01


@dataclass(frozen=True)
class Curves:
    """Recordings side by side, (recordings, samples), NaN where one has fewer; depths mm, forces N, radii mm."""

    protocols: list
    orders: np.ndarray
    radii: np.ndarray
    time: np.ndarray
    depth: np.ndarray
    force: np.ndarray
    thickness: float
    limit: float
    base: list  # force at UNIT_MPA over depth, one for each recording

    def scale(self):
        """Largest force of every recording, (recordings, 1)."""
        return np.nanmax(self.force, axis=1, keepdims=True)

    def only(self, kept):
        """Some of the recordings, by a mask."""
        rows = np.flatnonzero(kept)
        chosen = [getattr(self, name)[rows] for name in ("orders", "radii", "time", "depth", "force")]
        return Curves(
            [self.protocols[k] for k in rows], *chosen, self.thickness, self.limit, [self.base[k] for k in rows]
        )


def read(study):
    """The indentations of a study folder; None where fewer than one press of a sphere is in it."""
    about = tomllib.loads((study / "study.toml").read_text())
    material = about["skin"]["materials"]["default"]
    found = []
    for one in about["recordings"]:
        tool = about["indenters"][one["indenter"]]
        if one["kind"] == "indentation" and tool["shape"] == "sphere":
            found.append((one, tool["radius_mm"], np.loadtxt(study / one["file"], delimiter=",", skiprows=1)))
    if not found:
        return None
    longest = max(len(rows) for *_, rows in found)
    padded = np.full((len(found), longest, 3), np.nan)
    for number, (*_, rows) in enumerate(found):
        padded[number, : len(rows)] = rows
    thickness = float(material["thickness_mm"])
    deepest = 1.3 * float(np.nanmax(padded[..., 1]))
    skin = (study / "skin.ply").read_text()
    return Curves(
        [one["protocol"] for one, *_ in found],
        np.array([one["order"] for one, *_ in found]),
        np.array([radius for _, radius, _ in found]),
        *np.moveaxis(padded, 2, 0),
        thickness,
        float(material["d_lim_mm"]),
        [pressed(skin, thickness, radius, round(deepest, 1)) for _, radius, _ in found],
    )


@functools.lru_cache(64)
def pressed(skin, thickness, radius, deepest):
    """Force over depth of a sphere on a layer of UNIT_MPA, N; zero above the skin."""
    vertices, triangles = surface(skin)
    soft = thenar.Material(g0_mpa=UNIT_MPA, g_lim_mpa=UNIT_MPA, d_lim_mm=1.0, thickness_mm=thickness)
    skin = thenar.Skin(vertices, triangles, materials=[soft])
    reach = min(2.2 * np.sqrt(2.0 * radius * deepest), 1.4 * radius)
    ball = thenar.Product(*meshes.sphere(radius, (0.0, 0.0, radius), reach, 0.25))
    depths = deepest * np.linspace(0.0, 1.0, NODES) ** 1.5
    course = skin.run({"time_s": np.arange(NODES), "offset_mm": depths}, ball, direction=(0.0, 0.0, -1.0))
    return PchipInterpolator(np.concatenate([[-10.0 * deepest], depths]), np.concatenate([[0.0], course.force_n]))


def surface(text):
    """Vertices and triangles of an ASCII PLY file."""
    head, body = text.split("end_header\n")
    count = int(head.split("element vertex ")[1].split()[0])
    lines = body.splitlines()
    vertices = np.array([line.split()[:3] for line in lines[:count]], dtype=float)
    return vertices, np.array([line.split()[1:4] for line in lines[count:]], dtype=int)
