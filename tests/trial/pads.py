"""Pads with and without a stiff or soft spot, as finite elements press them: shapes, tissues, tools. mm, MPa."""

SHEAR_MPA = 0.01
ROD_RADIUS_MM = 24.0  # axis along y
STRAINS = (0.025, 0.05, 0.075, 0.10, 0.125, 0.15)  # depth over thickness
MAPPED = (1, 3, 5)  # of STRAINS: where pressures are kept
RASTER_MM = 0.4  # pressures are kept as means over squares of the tool's own surface, unrolled
RASTER_CELLS = 50  # a side, centered on first touch
RIM = 2.2  # the layer goes on this many thicknesses and 3 mm beyond the first touch

PADS = {  # radii of the skin along x and y, thickness, all mm; b of the tissue
    "finger": (30.0, 20.0, 6.0, 0.0),
    "thumb": (34.0, 26.0, 7.0, 1.0),
    "index": (24.0, 18.0, 5.0, 0.5),
    "little": (26.0, 15.0, 5.5, 0.0),
    "pulp": (40.0, 22.0, 6.5, 2.0),
    "heel": (44.0, 30.0, 7.5, 0.5),
}
SPOTS = {  # of the pad "finger": x, y of the center, its depth under the skin, radius, all mm; contrast
    "hard_center": (0.0, 0.0, 2.5, 2.5, 2.5),
    "soft_left": (-3.2, 0.5, 2.2, 2.2, 0.3),
    "hard_right": (3.0, 1.0, 2.2, 2.2, 4.0),
    "soft_corner": (2.5, -2.2, 2.6, 2.6, 0.3),
    "hard_corner": (-2.6, 2.8, 2.0, 2.0, 4.0),
    "hard_wide": (-2.0, -1.5, 3.0, 3.0, 2.0),
    "hard_faint": (1.5, -2.5, 2.5, 2.5, 1.6),
    "hard_shallow": (2.0, 2.5, 1.5, 1.5, 4.0),
    "soft_wide": (-1.0, 2.0, 3.0, 3.0, 0.4),
    "hard_deep": (-1.0, -2.0, 3.6, 2.4, 4.0),
    "soft_center": (0.5, 0.5, 2.5, 2.5, 0.3),
    "hard_edge": (4.5, -1.0, 2.4, 2.4, 4.0),
}
