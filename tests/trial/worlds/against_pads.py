"""How far Thenar's layer is from finite elements of round fingertips over bone, by the ways in which a form may be off.

    PYTHONPATH=tests target/venv/bin/python tests/trial/worlds/against_pads.py

Pads of `tests/proof/by_finite_elements/fingertip.json` under plate and rod, as a study states them: the thickness, and
no width of the bone. Of the finite elements' force over the layer's, as a logarithm over depth, prints the ways of
`stiffness_factor::modes` in Rust: Legendre's polynomials of order 0 to 5, and first touch. A study's two moduli take up
most of the first two.
"""

import json
from pathlib import Path

import numpy as np
import thenar
from numpy.polynomial import legendre
from proof import pressing
from proof.deep_pads import bone_pads

TABLE = json.loads((Path(__file__).parents[2] / "proof/by_finite_elements/fingertip.json").read_text())
FIRST = 0.05  # part of the depth over which an error at first touch dies away, as `stiffness_factor` has it
ORDERS = 6
SPACING_MM = 1.0


def pressed(thickness, tool, depths):
    """Forces of the layer, N."""
    height = TABLE["skin_semi_axes_mm"][2]
    shear = TABLE["shear_modulus_mpa"]
    material = thenar.Material(g0_mpa=shear, g_lim_mpa=shear, thickness_mm=thickness)
    skin = thenar.Skin(*bone_pads.skin(TABLE["skin_semi_axes_mm"], SPACING_MM), materials=[material])
    forces = []
    for depth in depths:
        if tool == "plate":
            product = pressing.plate_over(height - depth, half=60.0)
        else:
            product = pressing.cylinder_over(height - depth, TABLE["rod_radius_mm"], length=120.0, segments=512)
        forces.append(np.linalg.norm(skin.press(*product).total_force_n))
    return np.array(forces)


def departure(depths, theirs, ours):
    """Legendre's orders and first touch, as logarithms; and the rms of what they leave."""
    u = depths / depths[-1]
    ways = np.column_stack([legendre.legvander(2.0 * u - 1.0, ORDERS - 1), np.exp(-u / FIRST)])
    weight = u**1.5  # as readings of even noise weigh the logarithm of such a force
    log = np.log(theirs / ours)
    # First touch is hardly separable from the others at these depths: ridges of a percent of each keep the sizes small.
    ridge = 0.01 * np.eye(ways.shape[1])
    found = np.linalg.lstsq(
        np.vstack([weight[:, None] * ways, ridge]), np.append(weight * log, np.zeros(len(ridge))), rcond=None
    )[0]
    return found, np.sqrt(np.mean((weight * (log - ways @ found)) ** 2))


def main():
    """Prints the table."""
    for name, pad in TABLE["pads"].items():
        thickness = TABLE["skin_semi_axes_mm"][2] - pad["bone_semi_axes_mm"][2]
        for tool, by_density in pad["tools"].items():
            rows = np.array(by_density[max(by_density, key=int)])
            ways, left = departure(rows[:, 0], rows[:, 1], pressed(thickness, tool, rows[:, 0]))
            listed = ", ".join(f"{100.0 * way:+.1f}" for way in ways)
            print(f"{name:8s} {tool:5s} to {rows[-1, 0]:.1f} mm: {listed} %; left {100.0 * left:.2f} %", flush=True)


if __name__ == "__main__":
    main()
