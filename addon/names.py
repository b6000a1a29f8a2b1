"""Every name that Thenar writes into a file: keys, attributes, columns. Knows nothing of Blender."""

VERSION = "0.1.0"
SCHEMA = 1
_LONGEST = 63
"""Bytes of a name in a file of Blender 4."""

SHAPE_KEY = "Thenar Contact"
"""Shape key on the hand that holds the contact's displacement."""

PRESSURE_KPA = "pressure_kpa"
GRIP_MM = "grip_displacement_mm"
DEPTH_MM = "contact_depth_mm"
REGION = "contact_region"
FORCE_N = "contact_force_n"
DISPLACEMENT_MM = "contact_displacement_mm"
EDGE_MM = "contact_edge_mm"
"""Signed distance to the edge of the contact, > 0 inside; the map ends where it is 0, between vertices."""
OVERLAP_MM = "contact_overlap_mm"
"""Overlap of product and skin before the skin deforms, < 0 where they are apart."""
SHEAR_KPA = "shear_kpa"
SLIP_MARGIN = "slip_margin"
THICKNESS_MM = "tissue_thickness_mm"
THRESHOLD_SHARE = "threshold_share"
"""Pressure over the threshold of its region."""
RESIDUAL_KPA = "residual_kpa"
"""Measured minus simulated pressure; 0 away from the mat."""
PRINT_RESIDUAL = "print_residual"
"""1 where a compared handprint is inked alone, -1 where the simulation alone touches, 0 where both or neither do."""
REFERENCE_KPA = "reference_kpa"
"""Pressure of the reference solve."""
REFERENCE_EDGE_MM = "reference_edge_mm"
"""As `EDGE_MM`, of the reference solve."""
REFERENCE_DIFFERENCE_KPA = "reference_difference_kpa"
"""Pressure of the reference solve minus that of the fast result."""
ON_MAT = "on_mat"
"""1 where a compared mat or print lies, 0 elsewhere."""
COLOR = "Thenar Pressure"
MAP_COLOR = "Thenar Map"
"""Colours of any other map than the pressure's."""
GLTF_PRESSURE = "_PRESSURE_KPA"
"""glTF keeps only attributes whose names begin with an underscore."""

HAND_ATTRIBUTES = (
    PRESSURE_KPA,
    DEPTH_MM,
    REGION,
    FORCE_N,
    DISPLACEMENT_MM,
    SHEAR_KPA,
    SLIP_MARGIN,
    THICKNESS_MM,
    THRESHOLD_SHARE,
    RESIDUAL_KPA,
    PRINT_RESIDUAL,
    REFERENCE_KPA,
    REFERENCE_DIFFERENCE_KPA,
    REFERENCE_EDGE_MM,
    EDGE_MM,
    OVERLAP_MM,
    ON_MAT,
    COLOR,
    MAP_COLOR,
)
RESIDUAL_ATTRIBUTES = (RESIDUAL_KPA, PRINT_RESIDUAL, ON_MAT)
REFERENCE_ATTRIBUTES = (REFERENCE_KPA, REFERENCE_DIFFERENCE_KPA, REFERENCE_EDGE_MM)
PRODUCT_ATTRIBUTES = (PRESSURE_KPA, EDGE_MM, *RESIDUAL_ATTRIBUTES, COLOR, MAP_COLOR)

OVERLAY_GROUP = "Thenar Pressure Overlay"
MATERIAL_SUFFIX = " · pressure"
RESULTS_COLLECTION = "Thenar Results"
COPY_SUFFIX = " · pressure"
LIVE_MODIFIER = "Thenar Live"
LIVE_OFFSET = "thenar_live_offset"
"""How far the live contact moves each vertex, local."""
LIVE_BASE = "thenar_live_base"
"""Where each vertex stands before that, local; on the evaluated mesh only."""
SHOWN_MODIFIER = "Thenar Shown"
"""What the contact's key could not bring to the shown surface, last in the stack."""
APPLIED_MODIFIER = "Contact (applied)"
SHOWN_OFFSET = "thenar_shown_offset"
"""How far that modifier moves each vertex of the hand, local."""
SHOWN_SKIN = ".thenar_shown_skin"
"""1 where a vertex is skin, while a contact is written: Blender carries it to the vertices that modifiers add."""
BAKE_MODIFIER = "Thenar Bake"
BAKE_FOLDER = "thenar_cache"
LEGEND_IMAGE = "Thenar Legend"
LEGEND_NODES = ("Thenar Legend Image", "Thenar Legend Over")
LEGEND_TREE = "thenar_legend"
"""Custom property that marks the node tree of the legend's own compositor effect (Blender 5.3 and later)."""

FRICTION = "friction"
"""The effect that answers to a slide."""

WHOLE_SKIN = "Whole skin"
"""Name of the one region of a hand on which no region was assigned."""


def suffixed(name: str, suffix: str) -> str:
    """The name with the suffix, cut in front of it where both would be too long for Blender."""
    room = _LONGEST - len(suffix.encode())
    return name.encode()[:room].decode(errors="ignore") + suffix
