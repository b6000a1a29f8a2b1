"""Fits what the layer lacks (rust/contact/src/press/deep_tissue.rs: narrow bones, deep tissue) to solids of pads.

    python tests/proof/deep_pads/deep_tissue.py      # ten minutes; prints the tables

Each pad is half an ellipsoid of tissue over half an ellipsoid of bone, pressed by plate, cylinder and sphere to 10 to
50 % of its thickness, by the reference solve and by the layer over bone without end. The pads of
`by_finite_elements/deep_pads.json` are not among these: they are what the result is held against.
"""

import sys
from pathlib import Path

import numpy as np
import thenar

sys.path.insert(0, str(Path(__file__).parents[2]))
from proof.deep_pads import bone_pads as pads

PADS = {  # half-length, half-width, height of the bone; thickness of the tissue, mm
    "tip a": ((6.0, 2.6, 2.6), 7.1),
    "tip b": ((6.0, 3.5, 3.0), 6.0),
    "tip c": ((8.0, 5.5, 4.0), 6.0),
    "tip d": ((9.0, 3.0, 3.0), 4.5),
    "tip e": ((8.0, 4.5, 4.0), 8.0),
    "tip f": ((10.0, 7.0, 5.0), 6.0),
    "tip g": ((12.0, 9.0, 6.0), 6.5),
    "phalanx a": ((22.0, 4.0, 3.5), 7.1),
    "phalanx b": ((20.0, 6.0, 4.5), 6.0),
    "phalanx c": ((18.0, 3.0, 3.0), 7.0),
    "phalanx d": ((24.0, 5.0, 4.0), 4.5),
    "wide a": ((24.0, 8.0, 5.0), 6.0),
    "wide b": ((26.0, 14.0, 7.0), 9.0),
    "palm a": ((30.0, 26.0, 9.0), 13.4),
    "palm b": ((36.0, 30.0, 10.0), 10.0),
    "palm c": ((40.0, 18.0, 8.0), 12.0),
    "palm d": ((45.0, 40.0, 14.0), 9.0),
}
STRAINS = (0.1, 0.2, 0.3, 0.4, 0.5)
TOOLS = ("plate", "cylinder", "sphere")


def overlap_radius(surface, product, depth):
    """Radius of the paraboloid whose overlap has that depth and the volume of this one, mm."""
    vertices, triangles = surface
    gap = np.asarray(thenar.Product(*product).gap_mm(vertices)["gap_mm"])
    edges = vertices[triangles]
    areas = 0.5 * np.linalg.norm(np.cross(edges[:, 1] - edges[:, 0], edges[:, 2] - edges[:, 0]), axis=1)
    volume = (np.maximum(-gap, 0.0)[triangles].mean(axis=1) * areas).sum()
    return np.sqrt(2.0 * volume / (np.pi * depth))


def rows(bone, thickness, stiffening):
    """(tool, strain, overlap radius over thickness, layer over solid) of a pad."""
    sides = (0.7 if bone[0] < 15.0 else 0.5, 0.85, 1.0)
    axes = tuple(np.array(bone) + thickness * np.array(sides))
    endless = pads.material((np.inf, np.inf), thickness, stiffening)
    surface = pads.skin(axes, 0.2 * thickness)
    for name in TOOLS:
        for strain in STRAINS:
            depth = strain * thickness
            [layer] = pads.layer(axes, [endless], [(name, depth)], 0.2 * thickness)
            try:
                [solid] = pads.solid(axes, bone, [(name, depth)], stiffening, 0.35 * thickness)
            except thenar.SolveError as error:
                print(f"no solid: {name} at {strain}: {error}")
                break
            radius = overlap_radius(surface, pads.tool(name, axes[2] - depth), depth) / thickness
            yield name, strain, radius, np.linalg.norm(layer.total_force_n) / solid.normal_force_n


def best(candidates, misfit):
    """The candidate of the least misfit."""
    return min(candidates, key=misfit)


def main():
    """Prints the give of every pad, the radius it is felt from, and what the layer still lacks in stiffening."""
    neo = {name: list(rows(*pad, 0.0)) for name, pad in PADS.items()}
    felt_over = np.arange(0.2, 0.8, 0.02)

    def give(name, felt):
        table = np.array([row[2:] for row in neo[name]])
        felt_share = 1.0 - np.exp(-((table[:, 0] / felt) ** 2))
        off = {
            c: np.sqrt(np.mean((table[:, 1] / (1.0 + c * felt_share) - 1.0) ** 2)) for c in np.arange(0.0, 0.6, 0.002)
        }
        found = min(off, key=off.get)
        return found, off[found]

    felt = best(felt_over, lambda radius: sum(give(name, radius)[1] ** 2 for name in PADS))
    print(f"the bone is felt from a contact radius of {felt:.2f} thicknesses")
    print("pad         half-width  half-length   give   rms")
    for name, (bone, thickness) in PADS.items():
        found, rms = give(name, felt)
        print(f"{name:11} {bone[1] / thickness:10.2f} {bone[0] / thickness:12.2f} {found:6.3f} {rms:6.1%}")
    wanted = []
    for name, pad in PADS.items():
        flat = {row[:2]: row[3] for row in neo[name]}
        for tool, strain, radius, ratio in rows(*pad, 1.0):
            if strain > 0.15 and (tool, strain) in flat:
                stretch = 1.0 - strain
                growth = stretch**2 + 2.0 / stretch - 3.0
                wanted.append((radius, -np.log(ratio / flat[tool, strain]) / growth))
    radii, more = np.array(wanted).T
    print("contact radius over thickness: exponent that the layer still lacks, over b")
    for low in np.arange(0.4, 3.0, 0.2):
        among = (radii >= low) & (radii < low + 0.2)
        if among.any():
            print(f"{low:.1f} to {low + 0.2:.1f}: {more[among].mean():+.3f}, spread {more[among].std():.3f}")


if __name__ == "__main__":
    main()
