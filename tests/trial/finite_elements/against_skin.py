"""How far Thenar's stiff skins are from that of finite elements: the contact model's plate, the diagnosis' ball.

    python -m trial.finite_elements.against_skin        (in `tests`)

The calibration's pad under a skin of 0.4 mm and twenty times the modulus, pressed by three spheres to 14 % of its
thickness. Prints by how much the skin raises the force: on a mesh, where it is a plate at small strains; under a ball
(`thenar.press_ball`), where it gives way through its thickness and stretches; and theirs, at finite strain.
"""

import numpy as np
import thenar
from proof import pressing
from trial import protocols
from trial.drawing import truths

PAD, SHEAR_MPA = "forefinger", 0.01
SKIN_MM, SKIN_RATIO = 0.4, 20.0  # as truth_runs.changed has them, which needs numba
SPACING_MM = 0.3  # below the skin's bending length of 0.6 mm
ROWS = (2, 4, 7, 12)  # of the loading's, at which the table is printed
TOOLS = {"small": "slow, small sphere", "large": "large sphere", "wide": "wide sphere"}


def theirs(name, effect, variant, amplitude):
    """Forces of a protocol's loading, N."""
    first = protocols.STEPS[0]
    return truths.runs()[f"{PAD}/{effect}/{variant}/{amplitude}/{name}"].astype(float)[first : 2 * first + 1]


def ours(radius, depths, effects):
    """Forces of a sphere on the layer, N."""
    material = pressing.material(SHEAR_MPA, protocols.PADS[PAD][1])
    found = []
    for depth in depths:
        skin, product = pressing.sphere_on_flat(radius, depth, SPACING_MM)
        prepared = thenar.Skin(*skin, materials=[material], effects=effects)
        found.append(prepared.press(*product).total_force_n[2])
    return np.array(found)


def main():
    """Prints the table."""
    modulus = 3.0 * SHEAR_MPA * SKIN_RATIO
    effect = thenar.Effect("stiff_skin", 1.0, modulus_mpa=modulus, thickness_mm=SKIN_MM)
    for tool, name in TOOLS.items():
        first, radius = protocols.STEPS[0], protocols.radius(PAD, tool)
        depths = protocols.course(PAD, name, protocols.STEPS)[first : 2 * first + 1, 1][list(ROWS)]
        raised = (theirs(name, "stiff_skin", 0, 1.0) / theirs(name, "none", 0, 0))[list(ROWS)] - 1.0
        plate = ours(radius, depths, [effect]) / ours(radius, depths, []) - 1.0
        thickness = protocols.PADS[PAD][1]
        ball = thenar.press_ball(radius, depths, thickness, skin_mm=SKIN_MM, skin_ratio=SKIN_RATIO)
        ball = ball / thenar.press_ball(radius, depths, thickness) - 1.0
        rows = zip(depths, 100 * plate, 100 * ball, 100 * raised, strict=True)
        print(f"{tool:6s}" + ", ".join(f" {d:.2f} mm: +{a:.0f}, {b:.0f} (theirs {c:.0f}) %" for d, a, b, c in rows))


if __name__ == "__main__":
    main()
