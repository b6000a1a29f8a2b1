"""How the skin rises around a flat indenter of 2 mm at 1 N, drawn.

PYTHONPATH=tests target/venv/bin/python tests/proof/charts/indenter_bulge.py [FILE.svg]

The height is the mean over rings about the tool's axis; Table 2 of Xie, Kanai and Date puts the greatest rise 8 mm
(fingertip) and 15 mm (palm) from it.
"""

import sys
from pathlib import Path

import numpy as np
import thenar
from proof.charts import line_chart
from proof.thin_tools import test_indenter_tables as tables

PICTURE = Path(__file__).parents[3] / "addon/docs/pictures/indenter_bulge.svg"
RINGS = np.arange(3.0, 30.5, 0.5)
"""Distances from the axis, mm."""
HALF_RING = 0.75


def main(path):
    """Press both, draw, and print where each rises most."""
    curves = {}
    for site, material in (("fingertip", thenar.Material.finger_layer()), ("palm", thenar.Material.palm_layer())):
        vertices, contact = tables.pressed(material, "layer")
        r, z = np.hypot(vertices[:, 0], vertices[:, 1]), contact.displacement_mm[:, 2]
        height = np.array([1e3 * z[np.abs(r - at) < HALF_RING].mean() for at in RINGS])
        top = int(np.argmax(height))
        print(f"{site}: {contact.total_force_n[2]:.3f} N, rises {height[top]:.0f} um at {RINGS[top]:.1f} mm")
        shown = height > -height[top]
        curves[site] = (RINGS[shown], height[shown])
    words = (
        "Skin around a flat indenter of 2 mm at 1 N",
        "distance from the indenter's axis, mm",
        "rise of the skin, µm",
    )
    line_chart.write(path, words, curves)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else PICTURE)
