"""How far the layer's form is from solids of pads over bone, with the bone stated to it and without.

    python tests/proof/deep_pads/form_error.py [PAD ...]      # half an hour; the rows of FORM_ERROR in priors.rs

The solids are those of `deep_tissue.py` by the reference solve, pressed to 5 to 40 % of their thickness: none of the
pads that a trial of the diagnosis draws from. Of solid over layer, as a logarithm over depth, prints in percent the
ways of `stiffness_factor::modes`: Legendre's polynomials of order 0 to 5, and first touch. The first two hold what a
study's own moduli take up.
"""

import sys
from pathlib import Path

import numpy as np
import thenar

sys.path.insert(0, str(Path(__file__).parents[2]))
from numpy.polynomial import legendre
from proof.deep_pads import bone_pads as pads
from proof.deep_pads.deep_tissue import PADS

STRAINS = (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4)
TOOLS = ("plate", "cylinder", "sphere")
ORDERS = 6
FIRST = 0.05  # part of the depth over which an error at first touch dies away, as `stiffness_factor` has it


def curves(bone, thickness, tool):
    """Depths (mm), forces (N) of the solid, of the layer over bone without end, and of the layer over that bone."""
    sides = (0.7 if bone[0] < 15.0 else 0.5, 0.85, 1.0)
    axes = tuple(np.array(bone) + thickness * np.array(sides))
    rows = []
    for strain in STRAINS:
        press = [(tool, strain * thickness)]
        try:
            [solid] = pads.solid(axes, bone, press, spacing=0.3 * thickness)
        except thenar.SolveError as error:
            print(f"no solid at {strain}: {error}")
            break
        layers = [
            pads.layer(axes, [pads.material(stated, thickness)], press, 0.17 * thickness)[0]
            for stated in ((np.inf, np.inf), bone)
        ]
        forces = [np.linalg.norm(layer.total_force_n) for layer in layers]
        rows.append((strain * thickness, solid.normal_force_n, *forces))
    return np.array(rows).T


def ways(depths, ratio):
    """Sizes of the ways, as logarithms."""
    u = depths / depths[-1]
    columns = np.column_stack([legendre.legvander(2.0 * u - 1.0, ORDERS - 1), np.exp(-u / FIRST)])
    weight = u**1.5  # as readings of even noise weigh the logarithm of such a force
    # First touch is hardly separable from the others at these depths: ridges of a percent of each keep the sizes small.
    ridge = 0.01 * np.eye(columns.shape[1])
    sides = np.append(weight * np.log(ratio), np.zeros(len(ridge)))
    return np.linalg.lstsq(np.vstack([weight[:, None] * columns, ridge]), sides, rcond=None)[0]


def main():
    """Prints every pad under every tool, and the rms of all."""
    found = {"bone not stated": [], "bone stated": []}
    for name in sys.argv[1:] or PADS:
        for tool in TOOLS:
            depths, solid, *layers = curves(*PADS[name], tool)
            for how, layer in zip(found, layers, strict=True):
                found[how].append(ways(depths, solid / layer))
                listed = " ".join(f"{100.0 * way:+6.1f}" for way in found[how][-1])
                print(f"{name:10s} {tool:9s} {how:16s} {listed}", flush=True)
    for how, rows in found.items():
        print(f"rms, {how}: " + " ".join(f"{100.0 * way:.1f}" for way in np.sqrt(np.mean(np.square(rows), axis=0))))


if __name__ == "__main__":
    main()
