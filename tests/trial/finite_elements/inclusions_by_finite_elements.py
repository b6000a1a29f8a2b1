"""Makes inclusions_by_finite_elements.npz: pads over bone with a stiff or soft spot under a plate and a rod, in FElupe.

Knows nothing of Thenar. Run it by hand (an hour on one core): `pip install felupe pypardiso`, then in `tests`
`python -m trial.finite_elements.inclusions_by_finite_elements`; what the table already holds is not computed again. A
pad is a layer of even thickness over a rigid, curved bone: its skin is the paraboloid z = -(x^2/Rx + y^2/Ry)/2, its
bone that surface moved inward along the normals. Tissue is hyperelastic, W = G/(2b) (exp(b (I1 - 3)) - 1), neo-Hookean
for b = 0; its bulk modulus is that of nu = 0.495. The spot is a ball in which G is `contrast` times as large. The tool
is rigid, smooth, and moves along -z. Hexahedra of mean dilatation (Q1/P0). Units: mm, N, MPa. Moduli and lengths
scale: pressures by the modulus, everything else by the length.

Halving: cells of 0.125 against 0.08 thicknesses change the force by 1 % and the mean pressure over 2 mm squares by 3 %
of the largest (6 % in one square at the contact's edge); pads without a spot are computed with 0.1, and what a spot
changes, which is larger than all that, with 0.14.
"""

import os
import sys
from pathlib import Path

import felupe as fem
import numpy as np
from felupe.math import dya
from pypardiso import PyPardisoSolver
from scipy.sparse import triu
from trial import pads

POISSON = 0.495
BULK_MPA = 2.0 * pads.SHEAR_MPA * (1.0 + POISSON) / (3.0 * (1.0 - 2.0 * POISSON))
PENALTY_MPA_PER_MM = 6.0
# Side of the skin's cells under the tool, over the thickness; levels where cells begin and end, from bone to skin.
FINE = (0.1, (0.0, 0.16, 0.32, 0.47, 0.6, 0.72, 0.82, 0.91, 1.0))
COARSE = (0.14, (0.0, 0.2, 0.4, 0.58, 0.73, 0.87, 1.0))
SOLVER = PyPardisoSolver(mtype=-2)  # symmetric, which needs the upper triangle alone


class Exponential(fem.NeoHooke):
    """Neo-Hookean tissue whose stiffness grows as exp(b (I1 - 3)), isochoric part only; `mu` may vary by point."""

    def __init__(self, mu, rate):
        super().__init__(mu=mu)
        self.rate = rate

    def _growth(self, x):
        f = x[0]
        j = np.linalg.det(np.moveaxis(f, (0, 1), (-2, -1)))
        return np.exp(self.rate * (j ** (-2.0 / 3.0) * (f * f).sum(axis=(0, 1)) - 3.0))

    def gradient(self, x, *args, **kwargs):
        stress, state = self._gradient(x)
        return [stress * self._growth(x), state]

    def hessian(self, x, *args, **kwargs):
        stress = self._gradient(x)[0]
        return [(self._hessian(x)[0] + 2.0 * self.rate / self.mu * dya(stress, stress)) * self._growth(x)]


def spaced(inner, outer, step):
    """Coordinates from 0: even to `inner`, then growing to `outer`."""
    points = list(np.linspace(0.0, inner, round(inner / step) + 1))
    while points[-1] < outer - 0.4 * step:
        step *= 1.22
        points.append(points[-1] + step)
    return np.array(points)


def layer(pad, density, is_quarter):
    """FElupe mesh with the tool's point appended, the points of bone, of skin, and the skin's quads."""
    rx, ry, h, _ = pads.PADS[pad]
    step = density[0] * h
    half = spaced(1.15 * h, pads.RIM * h + 3.0, step)
    line = half if is_quarter else np.concatenate([-half[:0:-1], half])
    x, y = (c.ravel() for c in np.meshgrid(line, line, indexing="ij"))
    skin = np.stack([x, y, -(x**2 / rx + y**2 / ry) / 2.0], axis=1)
    normal = np.stack([x / rx, y / ry, np.ones_like(x)], axis=1)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    share = np.array(density[1])
    points = np.concatenate([skin - normal * h * (1.0 - t) for t in share])
    n, m = len(x), len(line)
    index = np.arange(n).reshape(m, m)
    corners = (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:])
    quads = np.stack([c.ravel() for c in corners], axis=1)
    cells = np.concatenate([np.hstack([quads + k * n, quads + (k + 1) * n]) for k in range(len(share) - 1)])
    mesh = fem.Mesh(np.vstack([points, [[0.0, 0.0, 0.0]]]), cells, "hexahedron")
    mesh.points_without_cells = mesh.points_without_cells[:-1]
    return mesh, np.arange(n), np.arange(n) + n * (len(share) - 1), quads + n * (len(share) - 1)


def moduli(mesh, region, pad, spot):
    """G at every quadrature point, with the spot's edge softened over 0.4 mm; shape (points, cells)."""
    where = np.einsum("cai,aqc->iqc", mesh.points[mesh.cells], np.broadcast_to(region.h, (8, 8, mesh.ncells)))
    if spot is None:
        return np.full(where.shape[1:], pads.SHEAR_MPA)
    x, y, depth, radius, contrast = spot
    rx, ry, _, _ = pads.PADS[pad]
    center = np.array([x, y, -(x**2 / rx + y**2 / ry) / 2.0 - depth])
    distance = np.linalg.norm(where - center[:, None, None], axis=0)
    inside = 0.5 * (1.0 - np.tanh((distance - radius) / 0.2))
    return pads.SHEAR_MPA * np.exp(np.log(contrast) * inside)


def boundaries(mesh, displacement, on_bone, is_quarter):
    """Bone held, planes of symmetry kept, the tool (the last point) moved along z."""
    tool = np.arange(mesh.npoints) == mesh.npoints - 1
    held = np.zeros(mesh.npoints, dtype=bool)
    held[on_bone] = True
    of = {
        "held": fem.Boundary(displacement, mask=held),
        "guide": fem.Boundary(displacement, mask=tool, skip=(0, 0, 1)),
        "move": fem.Boundary(displacement, mask=tool, skip=(1, 1, 0)),
    }
    if is_quarter:
        x, y, _ = np.abs(mesh.points.T) < 1e-9
        of["x"] = fem.Boundary(displacement, mask=x & ~tool, skip=(0, 1, 1))
        of["y"] = fem.Boundary(displacement, mask=y & ~tool, skip=(1, 0, 1))
    return of


def press(pad, spot, tool, density):
    """Forces (N) at all pads.STRAINS, and rasters of pressure (MPa) at those pads.MAPPED."""
    is_quarter = spot is None
    mesh, on_bone, on_skin, quads = layer(pad, density, is_quarter)
    region = fem.RegionHexahedron(mesh)
    field = fem.FieldContainer([fem.Field(region, dim=3)])
    tissue = Exponential(moduli(mesh, region, pad, spot), pads.PADS[pad][3])
    solid = fem.SolidBodyNearlyIncompressible(tissue, field, bulk=BULK_MPA)
    area = nodal_areas(mesh.points, quads)
    centre = mesh.npoints - 1
    law = {"field": field, "points": on_skin, "centerpoint": centre}
    law["multiplier"] = PENALTY_MPA_PER_MM * area[on_skin].mean()
    if tool == "plate":
        contact = fem.ContactRigidPlane(normal=[0.0, 0.0, -1.0], **law)
    else:
        mesh.points[centre, 2] += pads.ROD_RADIUS_MM
        contact = fem.ContactRigidCylinder(radius=pads.ROD_RADIUS_MM, axis=[0.0, 1.0, 0.0], **law)
    bounds = boundaries(mesh, field[0], on_bone, is_quarter)
    travel = -np.array(pads.STRAINS) * pads.PADS[pad][2]
    step = fem.Step(items=[solid, contact], boundaries=bounds, ramp={bounds["move"]: travel})
    forces, rasters = [], []
    copies = 4.0 if is_quarter else 1.0
    for k, _ in enumerate(step.generate(x0=field, tol=1e-6, solver=solved, verbose=0)):
        pushes = np.asarray(contact.assemble.vector().todense()).reshape(-1, 3)
        forces.append(copies * abs(pushes[centre, 2]))
        if k in pads.MAPPED:
            deformed = mesh.points + field[0].values
            load = np.linalg.norm(pushes, axis=1)
            load[centre] = 0.0
            rasters.append(raster(deformed, quads, load, (tool, is_quarter)))
    return np.array(forces), np.array(rasters)


def solved(matrix, vector):
    """The step's linear solver."""
    return SOLVER.solve(triu(matrix, format="csr"), vector)


def raster(points, quads, load, layout):
    """Mean pressure (MPa) on the squares of the tool's surface, rows along y; nodal loads spread over their quads."""
    tool, is_quarter = layout
    area = nodal_areas(points, quads)
    pressure = np.divide(load, area, out=np.zeros_like(load), where=area > 0.0)
    s = (np.arange(8) + 0.5) / 8.0
    u, v = (c.ravel() for c in np.meshgrid(s, s))
    share = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v])
    place = np.einsum("qai,as->qsi", points[quads], share).reshape(-1, 3)
    diagonals = np.cross(points[quads[:, 2]] - points[quads[:, 0]], points[quads[:, 3]] - points[quads[:, 1]])
    patch = np.repeat(np.linalg.norm(diagonals, axis=1) / 2.0 / 64.0, 64)
    push = (pressure[quads] @ share).ravel() * patch
    push *= load.sum() / push.sum()
    if tool == "rod":
        axis = points[-1, 2]
        place[:, 0] = pads.ROD_RADIUS_MM * np.arctan2(place[:, 0], axis - place[:, 2])
    edges = (np.arange(pads.RASTER_CELLS + 1) - pads.RASTER_CELLS / 2) * pads.RASTER_MM
    total = np.histogram2d(place[:, 1], place[:, 0], bins=(edges, edges), weights=push)[0]
    if is_quarter:
        total = total + total[:, ::-1]
        total = total + total[::-1]
    return total / pads.RASTER_MM**2


def nodal_areas(points, quads):
    """A quarter of every adjoining quad, mm2; zero for points that are on none."""
    areas = np.zeros(len(points))
    corners = points[quads]
    for b, c in ((1, 2), (2, 3)):
        doubled = np.cross(corners[:, b] - corners[:, 0], corners[:, c] - corners[:, 0])
        np.add.at(areas, quads.ravel(), np.repeat(np.linalg.norm(doubled, axis=1) / 8.0, 4))
    return areas


def with_spot(name, tool, kept):
    """A spot's forces and rasters: what it changes on the coarse mesh, put on the fine pad without it."""
    forces, rasters = press("finger", pads.SPOTS[name], tool, COARSE)
    base_forces, base_rasters = press("finger", None, tool, COARSE)
    forces = kept[f"finger/{tool}/force_n"] * forces / base_forces
    base = kept[f"finger/{tool}/pressure_mpa"]
    found = np.maximum(base + rasters - base_rasters, 0.0)
    carried = (forces / kept[f"finger/{tool}/force_n"])[list(pads.MAPPED)] * base.sum(axis=(1, 2))
    return forces, found * (carried / found.sum(axis=(1, 2)))[:, None, None]


def main():
    """Computes what the table beside this file lacks, a case and tool at a time."""
    path = Path(__file__).with_suffix(".npz")
    for name in sys.argv[1:] or [*pads.PADS, *pads.SPOTS]:
        for tool in ("plate", "rod"):
            kept = dict(np.load(path)) if path.exists() else {}
            if f"{name}/{tool}/force_n" in kept:
                continue
            forces, rasters = press(name, None, tool, FINE) if name in pads.PADS else with_spot(name, tool, kept)
            kept[f"{name}/{tool}/force_n"] = forces
            kept[f"{name}/{tool}/pressure_mpa"] = rasters.astype(np.float32)
            np.savez_compressed(path.with_suffix(".part.npz"), **kept)
            os.replace(path.with_suffix(".part.npz"), path)
            print(name, tool, np.round(forces, 4), np.round(rasters.max(axis=(1, 2)), 5), flush=True)


if __name__ == "__main__":
    main()
