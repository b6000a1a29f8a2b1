"""Makes deep_pads.json: pads of a hand over bone, pressed to half their thickness, in FElupe.

Knows nothing of Thenar. Run it by hand (an hour): `pip install felupe pypardiso tensortrax`, then this file with
Python. A pad is half an ellipsoid of soft tissue, bonded to a rigid ellipsoidal bone inside and held in the plane
above; tools are rigid and smooth. A press ends where Newton's method does not converge any more. Tissue is neo-Hookean
or stiffens exponentially, `W = mu / (2 b) (exp(b (I1 - 3)) - 1)` at constant volume. A quarter is meshed with hexahedra
of mean dilatation (Q1/P0). Units: mm, N, MPa.
"""

import json
import sys
from pathlib import Path

import felupe as fem
import numpy as np
import tensortrax.math as tm
from felupe.tools._newton import NewtonConvergenceError
from fingertip import boundaries, nodal_areas, octant
from pypardiso import spsolve

PADS_MM = {  # semi-axes of skin and bone: along the finger, across it, down to the apex
    "index": ((11.0, 7.5, 9.0), (7.5, 3.0, 3.0)),  # 6 mm of tissue
    "thumb": ((14.0, 10.0, 11.5), (10.0, 5.5, 5.0)),  # 6.5 mm
    "phalanx": ((30.0, 8.5, 9.5), (27.0, 4.0, 3.5)),  # 6 mm over a long bone
    "palm": ((48.0, 42.0, 24.0), (40.0, 34.0, 11.0)),  # 13 mm
}
TOOLS_MM = {"plate": None, "cylinder": 24.0, "sphere": 12.0}  # radius; the cylinder's axis lies across the finger
STIFFENINGS = (0.0, 1.0)
SHEAR_MPA = 0.01
BULK_MPA = 100.0 * SHEAR_MPA
SHARES = np.linspace(0.05, 0.5, 10)  # depth over thickness
STEPS = 2  # of the tool between two rows
PENALTY_MPA_PER_MM = 4.0
DENSITY = {"index": 12, "thumb": 12, "phalanx": 16, "palm": 16}
PATCH_MM2 = 24.0


def mesh_of(name):
    """The quarter pad: FElupe mesh with the tool's point appended, points of bone and skin, and faces of the skin."""
    directions, quads = octant(DENSITY[name])
    layers = 2 * DENSITY[name] // 3
    skin, bone = (directions * np.array(axes) for axes in PADS_MM[name])
    n = len(directions)
    points = np.concatenate([bone + (skin - bone) * share for share in np.linspace(0.0, 1.0, layers + 1)])
    cells = np.concatenate([np.hstack([quads + k * n, quads + (k + 1) * n]) for k in range(layers)])
    tool = np.array([[0.0, 0.0, -PADS_MM[name][0][2]]])
    mesh = fem.Mesh(np.vstack([points, tool]), cells, "hexahedron")
    mesh.points_without_cells = mesh.points_without_cells[:-1]
    return mesh, np.arange(n), np.arange(layers * n, (layers + 1) * n), quads + layers * n


def tissue(stiffening):
    """The law of the shear part."""
    if stiffening == 0.0:
        return fem.NeoHooke(mu=SHEAR_MPA)

    def energy(c, mu, b):
        first = tm.linalg.det(c) ** (-1 / 3) * tm.trace(c)
        return mu / (2.0 * b) * (tm.exp(b * (first - 3.0)) - 1.0)

    return fem.Hyperelastic(energy, mu=SHEAR_MPA, b=stiffening)


def press(name, tool, stiffening):
    """Rows of the table at growing depth, for the whole pad."""
    mesh, on_bone, on_skin, faces = mesh_of(name)
    region = fem.RegionHexahedron(mesh)
    field = fem.FieldContainer([fem.Field(region, dim=3)])
    solid = fem.SolidBodyNearlyIncompressible(tissue(stiffening), field, bulk=BULK_MPA)
    center = mesh.npoints - 1
    stiffness = PENALTY_MPA_PER_MM * nodal_areas(mesh.points, faces)[on_skin].mean()
    law = {"field": field, "points": on_skin, "centerpoint": center, "multiplier": stiffness}
    radius = TOOLS_MM[tool]
    if radius is None:
        contact = fem.ContactRigidPlane(normal=[0.0, 0.0, 1.0], **law)
    else:
        mesh.points[center, 2] -= radius
        contact = fem.ContactRigidCylinder(radius=radius, axis=[0.0, 1.0, 0.0], **law)
        if tool == "sphere":
            contact.projection_axial = np.eye(3)
    skin, bone = PADS_MM[name]
    depths = SHARES * (skin[2] - bone[2])
    fine = depths[0] * np.arange(1, STEPS * len(depths) + 1) / STEPS
    bounds = boundaries(mesh, field[0], on_bone)
    step = fem.Step(items=[solid, contact], boundaries=bounds, ramp={bounds["move"]: fine})
    rows = []
    states = step.generate(x0=field, tol=1e-7, solver=spsolve, verbose=0)
    for depth in fine:
        try:
            next(states)
        except NewtonConvergenceError:
            print(name, tool, stiffening, f"ends before {depth:.2f} mm", flush=True)
            break
        if not np.isclose(depths, depth).any():
            continue
        deformed = mesh.points + field[0].values
        forces = np.asarray(contact.assemble.vector().todense()).reshape(-1, 3)
        area, patch = area_and_patch(deformed, faces, np.linalg.norm(forces, axis=1), on_skin)
        row = (depth, 4.0 * abs(forces[center, 2]), 4.0 * area, patch)
        rows.append([round(float(value), 5) for value in row])
        print(name, tool, stiffening, rows[-1], flush=True)
    return rows


def area_and_patch(points, faces, forces, on_skin):
    """Area of the touching nodes of the quarter, mm2, and mean pressure over 24 mm2 about the whole's apex, MPa."""
    areas = nodal_areas(points, faces)[on_skin]
    force = forces[on_skin]
    order = np.argsort(np.linalg.norm(points[on_skin][:, :2], axis=1))
    enclosed, load = np.cumsum(areas[order]), np.cumsum(force[order])
    # A node's area reaches as far inward as outward: half of the last one counts.
    enclosed, load = enclosed - 0.5 * areas[order], load - 0.5 * force[order]
    patch = np.interp(PATCH_MM2 / 4.0, enclosed, load) / (PATCH_MM2 / 4.0)
    return areas[force > 0.0].sum(), patch


def main():
    """Runs the pads named on the command line, or all, and keeps their rows in the table next to this file."""
    path = Path(__file__).with_suffix(".json")
    pads = json.loads(path.read_text())["pads"] if path.exists() else {}
    for name in sys.argv[1:] or PADS_MM:
        found = {}
        for tool in TOOLS_MM:
            for stiffening in STIFFENINGS:
                found.setdefault(tool, {})[str(stiffening)] = press(name, tool, stiffening)
        skin, bone = PADS_MM[name]
        pads[name] = {"skin_semi_axes_mm": skin, "bone_semi_axes_mm": bone, "density": DENSITY[name], "tools": found}
        table = {
            "made_with": f"FElupe {fem.__version__}",
            "columns": ["depth_mm", "force_n", "area_mm2", "patch_pressure_mpa"],
            "shear_modulus_mpa": SHEAR_MPA,
            "bulk_modulus_mpa": BULK_MPA,
            "tools_radius_mm": TOOLS_MM,
            "pads": pads,
        }
        path.write_text(json.dumps(table).replace("], [", "],\n[") + "\n")


if __name__ == "__main__":
    main()
