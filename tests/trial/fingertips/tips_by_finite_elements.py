"""Makes tips.npz: fingertips over bone under a plate and a cylinder, at finite strain, in FElupe.

Knows nothing of Thenar. Run it by hand (half an hour): `pip install felupe pypardiso tensortrax`, then this file with
Python; what the file holds already is not computed again. A tip is half an ellipsoid of soft tissue, bonded to a rigid
ellipsoidal bone inside and held in the plane of the nail; tools are rigid and smooth. Tissue stiffens exponentially,
`W = mu / (2 b) (exp(b (I1 - 3)) - 1)` at constant volume, or is neo-Hookean (b = 0). Hexahedra of mean dilatation.
Variants: `plain`; `skin`, an outer layer of 1 mm ten times as stiff as plain tissue over pulp of half its modulus;
`spot_a`, `spot_b`, a stiff ellipsoid at a place of `SPOTS_MM` in a plane of symmetry, so that half the pad is computed
(of the others a quarter).

Kept by `PAD/VARIANT/TOOL/B`: rows of depth (mm), force (N) and contact area (mm2); and the pressure on the tool's face
at these depths in cells of `CELL_MM` (MPa; along the finger, unrolled on the cylinder, by across it).
"""

import sys
import time
from pathlib import Path

import felupe as fem
import numpy as np
import tensortrax.math as tm
from felupe.tools._newton import NewtonConvergenceError
from pypardiso import spsolve

PADS_MM = {  # semi-axes of skin and bone: along the finger, across it, down to the apex
    "slim": ((11.5, 8.0, 10.0), (8.0, 3.5, 3.2)),
    "wide": ((13.5, 9.5, 10.5), (9.5, 5.0, 4.3)),
}
SPOTS_MM = {  # middle (along, across, below the apex's plane), semi-axes
    "spot_a": ((2.6, 0.0, 2.2), (2.0, 2.0, 1.4)),
    "spot_b": ((0.0, 2.2, 2.0), (1.8, 1.8, 1.3)),
}
SPOT_TIMES = 12.0
FLIPS = {"spot_a": (1, 0), "spot_b": (0, 1)}  # whether both halves along and across are computed
SKIN_MM, SKIN_TIMES, PULP_TIMES = 1.0, 10.0, 0.5
RADIUS_MM = 24.0  # of the cylinder, whose axis lies across the finger
STIFFENINGS = (0.0, 1.0)
SPOT_STIFFENING = {"spot_a": (0.0,), "spot_b": (1.0,)}
SPOT_PADS = ("slim",)
SHEAR_MPA = 0.01
BULK_MPA = 2.0
DEPTHS_MM = np.arange(1, 14) * 0.25
STEPS = 2
PENALTY_MPA_PER_MM = 4.0
DENSITY, LAYERS = 12, 8
CELL_MM = 0.5
HALF_CELLS = (28, 20)
FINE = 8  # samples along an edge of a face


def octant():
    """Unit vectors over a quarter of the lower half of a sphere, and quads of them that face outward."""
    s = np.tan(np.linspace(0.0, np.pi / 4.0, DENSITY + 1))
    u, v = np.meshgrid(s, s, indexing="ij")
    one = np.ones_like(u)
    index = np.arange(u.size).reshape(u.shape)
    corners = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    patches = [np.stack(p, axis=-1).reshape(-1, 3) for p in ((u, v, one), (one, u, v), (v, one, u))]
    points = np.concatenate(patches) * [1.0, 1.0, -1.0]
    quads = np.concatenate([corners[:, ::-1] + k * u.size for k in range(3)])
    return points / np.linalg.norm(points, axis=1)[:, None], quads


def merged(points, quads):
    """Without points that are there twice."""
    _, first, inverse = np.unique(np.round(points, 9) + 0.0, axis=0, return_index=True, return_inverse=True)
    return points[first], inverse.ravel()[quads]


def directions(both):
    """Of a quarter (x, y >= 0), and of its mirror image where both halves along x or y are asked for."""
    points, quads = octant()
    for axis, is_asked in enumerate(both):
        if is_asked:
            mirror = np.where(np.arange(3) == axis, -1.0, 1.0)
            quads = np.concatenate([quads, quads[:, ::-1] + len(points)])
            points = np.concatenate([points, points * mirror])
    return merged(points, quads)


def meshed(pad, both):
    """FElupe mesh with the tool's point appended; points of bone and of skin; faces of the skin."""
    unit, quads = directions(both)
    skin, bone = (unit * np.array(axes) for axes in PADS_MM[pad])
    depth = np.linalg.norm(skin - bone, axis=1)[:, None]
    inner = 1.0 - SKIN_MM / depth
    sheets = [bone + (skin - bone) * inner * share for share in np.linspace(0.0, 1.0, LAYERS)] + [skin]
    n = len(unit)
    cells = np.concatenate([np.hstack([quads + k * n, quads + (k + 1) * n]) for k in range(LAYERS)])
    tool = [[0.0, 0.0, -PADS_MM[pad][0][2]]]
    mesh = fem.Mesh(np.vstack([*sheets, tool]), cells, "hexahedron")
    mesh.points_without_cells = mesh.points_without_cells[:-1]
    return mesh, np.arange(n), np.arange(LAYERS * n, (LAYERS + 1) * n), quads + LAYERS * n


def moduli(mesh, pad, variant):
    """Shear modulus of each cell at its eight quadrature points, MPa, (8, cells)."""
    region = fem.RegionHexahedron(mesh)
    at = fem.Field(region, dim=3, values=mesh.points).interpolate()  # (3, 8, cells)
    times = np.ones(at.shape[1:])
    if variant == "skin":
        times[:] = PULP_TIMES
        times[:, -(times.shape[1] // LAYERS) :] = SKIN_TIMES
    elif variant != "plain":
        middle, axes = SPOTS_MM[variant]
        middle = np.array([middle[0], middle[1], middle[2] - PADS_MM[pad][0][2]])
        away = ((at - middle[:, None, None]) / np.array(axes)[:, None, None]) ** 2
        times[away.sum(axis=0) < 1.0] = SPOT_TIMES
    return SHEAR_MPA * times


class Tissue:
    """The law of the shear part, of a modulus (MPa) at each quadrature point of each cell."""

    def __init__(self, shear, stiffening):
        def energy(c, b):
            first = tm.linalg.det(c) ** (-1 / 3) * tm.trace(c)
            return (tm.exp(b * (first - 3.0)) - 1.0) / (2.0 * b)

        self.shear = shear
        self.of_unit = fem.Hyperelastic(energy, b=stiffening) if stiffening else fem.NeoHooke(mu=1.0)
        self.x = self.of_unit.x

    def gradient(self, x):
        """Stress."""
        stress, state = self.of_unit.gradient(x)
        return [self.shear * stress, state]

    def hessian(self, x):
        """Its slope."""
        return [self.shear * self.of_unit.hessian(x)[0]]


def bounds_of(mesh, field, on_bone, both):
    """Bone and nail held, planes of symmetry kept, the tool (the last point) moved along z."""
    tool = np.arange(mesh.npoints) == mesh.npoints - 1
    x, y, z = np.abs(mesh.points.T) < 1e-9
    held = z & ~tool
    held[on_bone] = True
    bounds = {
        "held": fem.Boundary(field, mask=held),
        "guide": fem.Boundary(field, mask=tool, skip=(0, 0, 1)),
        "move": fem.Boundary(field, mask=tool, skip=(1, 1, 0)),
    }
    if not both[0]:
        bounds["x"] = fem.Boundary(field, mask=x & ~tool, skip=(0, 1, 1))
    if not both[1]:
        bounds["y"] = fem.Boundary(field, mask=y & ~tool, skip=(1, 0, 1))
    return bounds


def press(pad, variant, tool, stiffening):
    """(rows, pressures) of the whole pad, as the first line says."""
    both = FLIPS.get(variant, (0, 0))
    mesh, on_bone, on_skin, faces = meshed(pad, both)
    field = fem.FieldContainer([fem.Field(fem.RegionHexahedron(mesh), dim=3)])
    law = Tissue(moduli(mesh, pad, variant), stiffening)
    solid = fem.SolidBodyNearlyIncompressible(law, field, bulk=BULK_MPA)
    center = mesh.npoints - 1
    # The tangent plane's share of a skin node at the apex.
    stiffness = PENALTY_MPA_PER_MM * node_areas(mesh.points, faces)[on_skin].mean()
    at = {"field": field, "points": on_skin, "centerpoint": center, "multiplier": stiffness}
    if tool == "plate":
        contact = fem.ContactRigidPlane(normal=[0.0, 0.0, 1.0], **at)
    else:
        mesh.points[center, 2] -= RADIUS_MM
        contact = fem.ContactRigidCylinder(radius=RADIUS_MM, axis=[0.0, 1.0, 0.0], **at)
    fine = DEPTHS_MM[0] * np.arange(1, STEPS * len(DEPTHS_MM) + 1) / STEPS
    bounds = bounds_of(mesh, field[0], on_bone, both)
    step = fem.Step(items=[solid, contact], boundaries=bounds, ramp={bounds["move"]: fine})
    states = step.generate(x0=field, tol=1e-6, solver=spsolve, verbose=0)
    rows, maps = [], []
    for depth in fine:
        try:
            next(states)
        except NewtonConvergenceError:
            print(pad, variant, tool, stiffening, f"ends before {depth:.3f} mm", flush=True)
            break
        if not np.isclose(DEPTHS_MM, depth).any():
            continue
        deformed = mesh.points + field[0].values
        force = np.asarray(contact.assemble.vector().todense()).reshape(-1, 3)
        whole = 4.0 / 2.0 ** sum(both)
        area, image = face_of_tool(deformed, faces, np.linalg.norm(force, axis=1), tool)
        image = image if both[0] else image + image[::-1]
        image = image if both[1] else image + image[:, ::-1]
        rows.append((depth, whole * abs(force[center, 2]), whole * area))
        maps.append(image)
    return np.array(rows), np.array(maps)


def face_of_tool(points, faces, force, tool):
    """Contact area (mm2), and mean pressure in cells of the tool's face (MPa), from forces at nodes."""
    center = points[-1]
    areas = node_areas(points, faces)
    pressure = np.divide(force, areas, out=np.zeros(len(points)), where=areas > 0.0)
    height = points[:, 2] - center[2]
    gap = height if tool == "plate" else np.hypot(points[:, 0], height) - RADIUS_MM
    s = (np.arange(FINE) + 0.5) / FINE
    u, v = (each.ravel() for each in np.meshgrid(s, s, indexing="ij"))
    shape = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v])  # (4, samples)
    near = faces[(gap[faces] < 0.0).any(axis=1)]
    at = np.einsum("ks,fkd->fsd", shape, points[near])
    share = quad_areas(points[near])[:, None] / FINE**2
    inside = gap[near] @ shape < 0.0
    local = pressure[near] @ shape
    along = at[..., 0] if tool == "plate" else RADIUS_MM * np.arctan2(at[..., 0], at[..., 2] - center[2])
    edges = [np.arange(-half, half + 1) * CELL_MM for half in HALF_CELLS]
    load = (local * share).ravel()
    image, _, _ = np.histogram2d(along.ravel(), at[..., 1].ravel(), edges, weights=load)
    image *= force[:-1].sum() / image.sum() / CELL_MM**2
    return float((inside * share).sum()), image


def quad_areas(corners):
    """Of (faces, 4, 3)."""
    halves = [np.cross(corners[:, b] - corners[:, 0], corners[:, c] - corners[:, 0]) for b, c in ((1, 2), (2, 3))]
    return 0.5 * sum(np.linalg.norm(each, axis=1) for each in halves)


def node_areas(points, faces):
    """A quarter of every adjoining face, mm2; zero for points that are on none."""
    areas = np.zeros(len(points))
    np.add.at(areas, faces.ravel(), np.repeat(quad_areas(points[faces]) / 4.0, 4))
    return areas


def wanted():
    """Keys of all runs."""
    for pad in PADS_MM:
        for variant in ("plain", "skin", *(SPOTS_MM if pad in SPOT_PADS else ())):
            for stiffening in SPOT_STIFFENING.get(variant, STIFFENINGS):
                for tool in ("plate", "cylinder"):
                    yield pad, variant, tool, stiffening


def main():
    """Runs what is lacking, of the pads and variants named on the command line or of all."""
    path = Path(__file__).with_suffix("").with_name("tips.npz")
    kept = dict(np.load(path)) if path.exists() else {}
    for pad, variant, tool, stiffening in wanted():
        key = f"{pad}/{variant}/{tool}/{stiffening:g}"
        if key in kept or (sys.argv[1:] and not {pad, variant} & set(sys.argv[1:])):
            continue
        started = time.time()
        rows, maps = press(pad, variant, tool, stiffening)
        kept[key] = rows.astype(np.float32)
        kept[f"{key}/map"] = maps.astype(np.float16)
        np.savez_compressed(path, **kept)
        last = ", ".join(f"{each:.3f}" for each in rows[-1])
        print(f"{key}: {len(rows)} rows, last {last}; {time.time() - started:.0f} s", flush=True)


if __name__ == "__main__":
    main()
