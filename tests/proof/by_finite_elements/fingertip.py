"""Makes fingertip.json: a pad over bone, pressed at finite strain by a plate and a rod, in FElupe.

Knows nothing of Thenar. Run it by hand (half an hour): `pip install felupe pypardiso`, then this file with Python.
The pad is half an ellipsoid of neo-Hookean tissue (nu = 0.49), fixed to a rigid ellipsoidal bone inside and to the
plane of the nail above; the tool is rigid and smooth. A quarter of it is meshed with hexahedra of mean dilatation
(Q1/P0). Units: mm, N, MPa.
"""

import json
import sys
from pathlib import Path

import felupe as fem
import numpy as np
from pypardiso import spsolve

SKIN_MM = np.array([12.0, 8.0, 10.0])  # semi-axes along the finger, across it, and down to the pad's apex
BONES_MM = {  # semi-axes of the bone: what lies over it at the apex is the difference in depth
    "slender": (8.0, 3.5, 3.0),  # 7 mm under the apex
    "small": (6.0, 3.0, 2.0),  # 8 mm
    "broad": (9.0, 5.5, 5.0),  # 5 mm
    "full": (10.0, 6.4, 7.0),  # 3 mm
}
SHEAR_MPA = 0.01
POISSON = 0.49
BULK_MPA = 2.0 * SHEAR_MPA * (1.0 + POISSON) / (3.0 * (1.0 - 2.0 * POISSON))
ROD_RADIUS_MM = 12.0  # the 24 mm cylinder, across the finger
STEP_MM = 0.1
MOST_SHARE = 0.4  # of the tissue under the apex; distorted cells end the computation not far beyond
PENALTY_MPA_PER_MM = 4.0
DENSITIES = {"slender": (9, 18), "small": (12,), "broad": (18,), "full": (12,)}


def octant(density):
    """Directions over an eighth of a sphere (z <= 0): (points, quads), three patches of a cube blown up."""
    s = np.tan(np.linspace(0.0, np.pi / 4.0, density + 1))
    u, v = np.meshgrid(s, s, indexing="ij")
    one = np.ones_like(u)
    patches = [np.stack(p, axis=-1) for p in ((u, v, one), (one, u, v), (v, one, u))]
    points, quads = [], []
    index = np.arange((density + 1) ** 2).reshape(density + 1, density + 1)
    for number, patch in enumerate(patches):
        points.append(patch.reshape(-1, 3))
        corners = (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:])
        quads.append(np.stack([c.ravel() for c in corners], axis=1) + number * index.size)
    points = np.concatenate(points)
    points /= np.linalg.norm(points, axis=1)[:, None]
    _, first, inverse = np.unique(np.round(points, 9), axis=0, return_index=True, return_inverse=True)
    quads = np.concatenate(quads)[:, ::-1]  # turned: the mirroring below would leave the cells inside out
    return points[first] * [1.0, 1.0, -1.0], inverse.ravel()[quads]


def pad(bone, density):
    """The quarter pad: FElupe mesh with the tool's point appended, and the point numbers of bone, nail plane, skin."""
    directions, quads = octant(density)
    layers = 2 * density // 3
    inner = directions * np.array(BONES_MM[bone])
    outer = directions * SKIN_MM
    share = np.linspace(0.0, 1.0, layers + 1)
    points = np.concatenate([inner + (outer - inner) * t for t in share])
    n = len(directions)
    cells = np.concatenate([np.hstack([quads + k * n, quads + (k + 1) * n]) for k in range(layers)])
    tool = np.array([[0.0, 0.0, -SKIN_MM[2]]])
    mesh = fem.Mesh(np.vstack([points, tool]), cells, "hexahedron")
    mesh.points_without_cells = mesh.points_without_cells[:-1]
    on_skin = np.arange(layers * n, (layers + 1) * n)
    return mesh, np.arange(n), on_skin, quads + layers * n


def press(bone, tool, density):
    """Rows of the table at growing depth, for the whole pad."""
    mesh, on_bone, on_skin, faces = pad(bone, density)
    region = fem.RegionHexahedron(mesh)
    field = fem.FieldContainer([fem.Field(region, dim=3)])
    solid = fem.SolidBodyNearlyIncompressible(fem.NeoHooke(mu=SHEAR_MPA), field, bulk=BULK_MPA)
    centre = mesh.npoints - 1
    stiffness = PENALTY_MPA_PER_MM * nodal_areas(mesh.points, faces)[on_skin].mean()
    law = {"field": field, "points": on_skin, "centerpoint": centre, "multiplier": stiffness}
    if tool == "plate":
        contact = fem.ContactRigidPlane(normal=[0.0, 0.0, 1.0], **law)
    else:
        mesh.points[centre, 2] -= ROD_RADIUS_MM
        contact = fem.ContactRigidCylinder(radius=ROD_RADIUS_MM, axis=[0.0, 1.0, 0.0], **law)
    bounds = boundaries(mesh, field[0], on_bone)
    depths = np.arange(1, round(MOST_SHARE * (SKIN_MM[2] - BONES_MM[bone][2]) / STEP_MM) + 1) * STEP_MM
    step = fem.Step(items=[solid, contact], boundaries=bounds, ramp={bounds["move"]: depths})
    rows = []
    for depth, _ in zip(depths, step.generate(x0=field, tol=1e-8, solver=spsolve, verbose=0), strict=True):
        deformed = mesh.points + field[0].values
        gap = gaps(deformed, tool, deformed[centre])
        force = abs(np.asarray(contact.assemble.vector().todense()).reshape(-1, 3)[centre, 2])
        true, projected = touching(deformed, faces, gap < 0.0)
        overlap = max(0.0, -gap[on_skin].min())
        row = (depth, 4.0 * force, 4.0 * true, 4.0 * projected, overlap)
        rows.append([round(float(value), 5) for value in row])
        print(f"{bone} {tool} {density}: {depth:4.2f} mm  {rows[-1][1]:8.4f} N  {rows[-1][2]:8.3f} mm2", flush=True)
    return rows


def boundaries(mesh, displacement, on_bone):
    """Bone and nail held, the planes of symmetry kept, the tool (the last point) moved along z."""
    tool = np.arange(mesh.npoints) == mesh.npoints - 1
    x, y, z = np.abs(mesh.points.T) < 1e-9
    held = z & ~tool
    held[on_bone] = True
    return {
        "held": fem.Boundary(displacement, mask=held),
        "x": fem.Boundary(displacement, mask=x & ~tool, skip=(0, 1, 1)),
        "y": fem.Boundary(displacement, mask=y & ~tool, skip=(1, 0, 1)),
        "guide": fem.Boundary(displacement, mask=tool, skip=(0, 0, 1)),
        "move": fem.Boundary(displacement, mask=tool, skip=(1, 1, 0)),
    }


def gaps(points, tool, centre):
    """Distance of points to the tool, mm; below zero inside it."""
    if tool == "plate":
        return points[:, 2] - centre[2]
    across = points[:, [0, 2]] - centre[[0, 2]]
    return np.linalg.norm(across, axis=1) - ROD_RADIUS_MM


def nodal_areas(points, faces):
    """A quarter of every adjoining face, mm2; zero for points that are on none."""
    areas = np.zeros(len(points))
    corners = points[faces]
    for b, c in ((1, 2), (2, 3)):
        doubled = np.cross(corners[:, b] - corners[:, 0], corners[:, c] - corners[:, 0])
        np.add.at(areas, faces.ravel(), np.repeat(np.linalg.norm(doubled, axis=1) / 8.0, 4))
    return areas


def touching(points, faces, is_inside):
    """Area of the touching nodes: (true, projected on the plate), mm2; within half a row of cells."""
    true = nodal_areas(points, faces)[is_inside].sum()
    projected = nodal_areas(points * [1.0, 1.0, 0.0], faces)[is_inside].sum()
    return float(true), float(projected)


def main():
    """Runs the bones named on the command line, or all, and keeps their rows in the table next to this file."""
    path = Path(__file__).with_suffix(".json")
    pads = json.loads(path.read_text())["pads"] if path.exists() else {}
    for bone in sys.argv[1:] or BONES_MM:
        of_tool = {tool: {str(n): press(bone, tool, n) for n in DENSITIES[bone]} for tool in ("plate", "rod")}
        pads[bone] = {"bone_semi_axes_mm": BONES_MM[bone], "tools": of_tool}
        table = {
            "made_with": f"FElupe {fem.__version__}",
            "columns": ["depth_mm", "force_n", "area_mm2", "projected_area_mm2", "deepest_overlap_mm"],
            "skin_semi_axes_mm": SKIN_MM.tolist(),
            "shear_modulus_mpa": SHEAR_MPA,
            "poisson_ratio": POISSON,
            "rod_radius_mm": ROD_RADIUS_MM,
            "pads": pads,
        }
        path.write_text(json.dumps(table).replace("], [", "],\n[") + "\n")


if __name__ == "__main__":
    main()
