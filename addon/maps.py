"""The maps that can be laid over the skin: what each shows, unit, colours and range. Knows nothing of Blender."""

from dataclasses import dataclass
from typing import Any, TypeVar

from . import names
from .scene.units import Floats

PRESSURE = "PRESSURE"
REFERENCE = "REFERENCE"
"""Shares the range of the pressure, so that the two can be compared."""
THICKNESS = "THICKNESS"
_BARELY = 0.01
"""Value from which a map covers all skin that carries one, in its unit."""
_SHARP_MM = 0.05
"""Half of the width over which a map ends at the edge of the contact in a shader, which sees it inside triangles."""
LINE_MM = 0.35
"""Width of the line along the edge of the contact."""


@dataclass(frozen=True)
class _Cover:
    """What decides where a map covers the surface: the attribute (empty: the map's own), from and to which value."""

    attribute: str
    edge: tuple[float, float] = (-_SHARP_MM, _SHARP_MM)
    is_distance: bool = True


_COVERS = {
    "contact": _Cover(names.EDGE_MM),
    "overlap": _Cover(names.OVERLAP_MM),
    "reference": _Cover(names.REFERENCE_EDGE_MM),
    "skin": _Cover("", (0.0, _BARELY), is_distance=False),
    "mat": _Cover(names.ON_MAT, (0.0, 1.0), is_distance=False),
}


Value = TypeVar("Value", float, Floats)


@dataclass(frozen=True)
class Map:
    """One map: the point attribute it shows, what the legend says of it, and how it is coloured."""

    kind: str
    attribute: str
    title: str
    unit: str
    meaning: str
    missing: str
    """Why the map may not be there, with the remedy."""
    palette: str = ""
    """Name of its colours; empty: the ones that the user chose."""
    limit: str = ""
    """Setting that holds the top of its range; empty: 0 to `fixed`."""
    fixed: float = 1.0
    covers: str = "contact"
    """What decides where the map covers the surface: a key of `_COVERS`."""
    is_signed: bool = False
    """Whether the colours run from minus to plus the top of the range."""


@dataclass(frozen=True)
class Scale:
    """How values become colours: the range from `low`, the palette, and from and to where covering rises in a shader.

    `is_distance`: whether what covers is a distance to the map's edge, mm.
    """

    high: float
    palette: str
    edge: tuple[float, float]
    is_distance: bool = True
    low: float = 0.0

    def share(self, value: Value) -> Value:
        """Where values stand in the range, 0 to 1."""
        return (value - self.low) / (self.high - self.low)

    def value(self, share: Value) -> Value:
        """The value at a share of the range."""
        return self.low + share * (self.high - self.low)


_NO_CONTACT = "there is no pressure yet; press Solve first"
_NO_REFERENCE = "there is no reference; solve, then press Certify under Reference"
_NO_SHEAR = "nothing shears the skin; add the effect friction, set a slide under Effects, and solve"

MAPS = {
    row.kind: row
    for row in (
        Map(PRESSURE, names.PRESSURE_KPA, "Pressure", "kPa", "Normal force over area", _NO_CONTACT, limit="range_kpa"),
        Map(
            "SHEAR",
            names.SHEAR_KPA,
            "Shear",
            "kPa",
            "Tangential traction: shear force over area that friction passes to the skin",
            _NO_SHEAR,
            palette="PLASMA",
            limit="shear_kpa",
        ),
        Map(
            "SLIP",
            names.SLIP_MARGIN,
            "Slip margin",
            "0 slip, 1 stick",
            "Unused share of the friction limit: 0 where skin slips over the product, 1 where it carries no shear",
            _NO_SHEAR,
            palette="WARMCOOL",
        ),
        Map(
            "DEPTH",
            names.DEPTH_MM,
            "Depth",
            "mm",
            "Overlap of product and skin before the skin deforms",
            _NO_CONTACT,
            limit="depth_mm",
            covers="overlap",
        ),
        Map(
            THICKNESS,
            names.THICKNESS_MM,
            "Thickness",
            "mm over bone",
            "Soft tissue over bone, by material, effects and painted groups",
            "the hand has no skin with a thickness; press Solve or Show again",
            palette="CIVIDIS",
            limit="thickness_mm",
            covers="skin",
        ),
        Map(
            "COMFORT",
            names.THRESHOLD_SHARE,
            "Comfort",
            "of threshold",
            "Pressure divided by the threshold of its region: red exceeds it",
            "pressure is not assessed; choose a threshold under Comfort, and solve",
            palette="COOLWARM",
            fixed=2.0,
        ),
        Map(
            REFERENCE,
            names.REFERENCE_KPA,
            "Reference",
            "kPa",
            "Pressure of the reference solve, in which the tissue is a solid between skin and bone",
            _NO_REFERENCE,
            limit="range_kpa",
            covers="reference",
        ),
        Map(
            "REFERENCE_DIFFERENCE",
            names.REFERENCE_DIFFERENCE_KPA,
            "Reference - fast",
            "kPa",
            "Reference minus fast pressure: red where the fast result is too low, blue where it is too high",
            _NO_REFERENCE,
            palette="COOLWARM",
            limit="reference_difference_kpa",
            is_signed=True,
        ),
        Map(
            "RESIDUAL",
            names.RESIDUAL_KPA,
            "Residual",
            "kPa",
            "Measured minus simulated pressure under the compared mat: red where measured is larger",
            "no mat was compared; load a recording under Recordings, place it, and compare",
            palette="COOLWARM",
            limit="residual_kpa",
            covers="mat",
            is_signed=True,
        ),
        Map(
            "PRINT",
            names.PRINT_RESIDUAL,
            "Handprint",
            "ink - simulation",
            "Contact compared with a handprint: red is ink only, blue is simulated contact only",
            "no handprint was compared; load its image under Recordings, place it, and compare",
            palette="COOLWARM",
            covers="mat",
            is_signed=True,
        ),
    )
}


def shown(look: Any) -> Map:
    """The map that is chosen in `scene.thenar`."""
    return MAPS[str(look.maps.shown)]


def setting(view: Map, look: Any) -> tuple[Any, str] | None:
    """The property group and the name of the property that holds the top of the map's range; None where it is fixed."""
    if not view.limit:
        return None
    return (look if view.kind in (PRESSURE, REFERENCE) else look.maps), view.limit


def scale(view: Map, look: Any) -> Scale:
    """The map's `Scale` under the present settings."""
    place = setting(view, look)
    high = max(view.fixed if place is None else getattr(*place), 1e-6)
    low, cover = -high if view.is_signed else 0.0, _COVERS[view.covers]
    return Scale(high, view.palette or look.palette, cover.edge, cover.is_distance, low)


def covering(view: Map) -> str:
    """The attribute that decides where the map covers the surface."""
    return _COVERS[view.covers].attribute or view.attribute


def has_line(view: Map, look: Any) -> bool:
    """Whether a line is drawn where the map ends."""
    return bool(_COVERS[view.covers].is_distance and look.maps.contour)


def peak(view: Map, result: Any) -> float:
    """The largest value that the scene's result holds of the map; 0 where it holds none."""
    held = {PRESSURE: "peak_kpa", "SHEAR": "shear_peak_kpa", "DEPTH": "depth_mm"}.get(view.kind)
    return getattr(result, held) if held and result.is_valid else 0.0
