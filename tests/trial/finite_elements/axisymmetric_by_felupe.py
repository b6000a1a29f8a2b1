"""Makes axisymmetric_by_felupe.json: the trial's pads in FElupe, a check of the trial's own elements.

Run by hand in `tests`: `pip install felupe numba`, then `python -m trial.finite_elements.axisymmetric_by_felupe`.
Under spheres and plates, without effects.
"""

import json
from pathlib import Path

import felupe as fem
import numpy as np
from trial.finite_elements import axisymmetric
from trial.protocols import PADS, depth

SHEAR_MPA = 0.01


def by_felupe(pad, radius, depths, density):
    """Forces, N."""
    mesh = axisymmetric.mesh_of(pad, density)
    columns, levels, _ = mesh.nodes.shape
    index = np.arange(columns * levels).reshape(columns, levels)
    corners = (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1])  # z comes first in FElupe
    cells = np.stack([corner.ravel() for corner in corners], axis=1)
    points = np.vstack([mesh.nodes.reshape(-1, 2)[:, ::-1], [[radius if np.isfinite(radius) else 0.0, 0.0]]])
    grid = fem.Mesh(points, cells, "quad")
    grid.points_without_cells = grid.points_without_cells[:-1]
    field = fem.FieldContainer([fem.FieldAxisymmetric(fem.RegionQuad(grid), dim=2)])
    solid = fem.SolidBodyNearlyIncompressible(fem.NeoHooke(mu=SHEAR_MPA), field, bulk=1000.0 * SHEAR_MPA)
    tool, skin = len(points) - 1, index[:, -1]
    law = {"field": field, "points": skin, "centerpoint": tool, "multiplier": 60.0}
    if np.isfinite(radius):
        contact = fem.ContactRigidCylinder(radius=radius, **law)
    else:
        contact = fem.ContactRigidPlane(normal=[-1.0, 0.0], **law)
    at_tool = np.arange(len(points)) == tool
    bone = np.isin(np.arange(len(points)), index[:, 0])
    axis = np.isin(np.arange(len(points)), index[0])
    bounds = {
        "bone": fem.Boundary(field[0], mask=bone),
        "axis": fem.Boundary(field[0], mask=axis, skip=(1, 0)),
        "guide": fem.Boundary(field[0], mask=at_tool, skip=(1, 0)),
        "move": fem.Boundary(field[0], mask=at_tool, skip=(0, 1)),
    }
    step = fem.Step(items=[solid, contact], boundaries=bounds, ramp={bounds["move"]: -depths})
    forces = []
    for _ in step.generate(x0=field, tol=1e-7, verbose=0):
        forces.append(abs(float(np.asarray(contact.assemble.vector().todense()).reshape(-1, 2)[tool, 0])))
    return np.array(forces)


def main():
    """Writes forces by FElupe and by the trial's elements, on one mesh."""
    rows = []
    for name, (_, thickness, small, _, wide) in PADS.items():
        depths = np.linspace(0.0, depth(name), 11)[1:]
        for skin, radius in ((np.inf, small), (np.inf, wide), (4.0 * thickness, np.inf)):
            widest = np.sqrt(depths[-1] / (1.0 / skin + 1.0 / radius))
            pad = axisymmetric.Pad(skin, thickness, 1.3 * widest)
            motion = np.stack([depths, depths], axis=1)
            own = axisymmetric.press(pad, axisymmetric.Tissue(), axisymmetric.Tool(radius), motion)
            theirs = by_felupe(pad, radius, depths, 1.0)
            row = {
                "pad": name,
                "skin_mm": None if np.isinf(skin) else skin,
                "radius_mm": None if np.isinf(radius) else radius,
                "depth_mm": depths.round(5).tolist(),
            }
            rows.append(row | {"felupe_n": theirs.round(6).tolist(), "own_n": own.round(6).tolist()})
            print(name, radius, (own / theirs - 1.0).round(4), flush=True)
    Path(__file__).with_suffix(".json").write_text(json.dumps(rows).replace("}, {", "},\n{") + "\n")


if __name__ == "__main__":
    main()
