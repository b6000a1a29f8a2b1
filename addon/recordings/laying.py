"""Lays a mat on the scene's product: from the product's own axes and bounds to the place of every sensel, mm."""

from dataclasses import dataclass

import numpy as np

from .. import native
from ..scene.checks import Refusal
from . import settings

_LONG = 1.2
"""How much longer than wide a product is whose long axis is taken for a cylinder's."""


@dataclass(frozen=True)
class Seat:
    """The product's axes (3, 3) as columns, and its vertices, mm, in the frame that the mat is laid in."""

    axes: np.ndarray
    vertices_mm: np.ndarray


@dataclass(frozen=True)
class Lie:
    """How the user wants the mat to lie; plain numbers, so that any thread may lay it."""

    path: str
    mat: str
    on: str
    axis: str
    diameter_mm: float
    turn_deg: float
    shift_mm: tuple
    is_mirrored: bool
    print: "PrintLook | None" = None

    def source(self):
        """What `place_mat` lays: the file of a mat, or the print. Raises `RecordingError`."""
        return self.path if self.print is None else self.print.read(self.path)


@dataclass(frozen=True)
class PrintLook:
    """How the image of a handprint is read; plain numbers."""

    dpi: float
    cell_mm: float
    ink: str
    ink_kpa: float
    is_mirrored: bool

    def read(self, path):
        """The library's print. Raises `RecordingError`."""
        ink = None if self.ink == "AUTO" else self.ink.lower()
        return native.module.Print.read(path, dpi=self.dpi, cell_mm=self.cell_mm, ink=ink, mirrored=self.is_mirrored)


def look_of(item):
    """How the properties of a recording say that its print is read; None for another kind."""
    if item.kind != settings.PRINT:
        return None
    look = item.print
    return PrintLook(look.dpi, look.cell_mm, look.ink, look.ink_kpa, look.is_mirrored)


def lie_of(item):
    """What the properties of a recording say."""
    placing = item.placing
    return Lie(
        path=item.path,
        mat=item.mat,
        on=placing.on,
        axis=placing.axis,
        diameter_mm=placing.diameter_mm,
        turn_deg=placing.turn_deg,
        shift_mm=tuple(placing.shift_mm),
        is_mirrored=placing.is_mirrored,
        print=look_of(item),
    )


def axes_of(matrix):
    """Unit axes (3, 3), as columns, of an object's world matrix; a mirrored one keeps a right-handed set."""
    axes = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    axes[:, 2] /= np.linalg.norm(axes[:, 2])
    axes[:, 1] = np.cross(axes[:, 2], axes[:, 0])
    return axes


def long_axis(seat, axis):
    """Name of the product's own axis that it is longest along, by a fifth at least; else `axis`."""
    extent = np.ptp(seat.vertices_mm @ seat.axes, axis=0)
    order = np.argsort(extent)
    return f"+{'XYZ'[order[2]]}" if extent[order[2]] > _LONG * extent[order[1]] else axis


def diameter_mm(seat, axis):
    """Mean width of the product across an axis, mm."""
    number, _ = axis_of(axis)
    extent = np.ptp(seat.vertices_mm @ seat.axes, axis=0)
    return float(np.delete(extent, number).mean())


def lay(lie, seat, source=None):
    """The mat as a record: center_mm, normal, area_mm2, row, column. Raises `Refusal`, `RecordingError`.

    `source`: what `lie.source()` gave, if it was read already.
    """
    source = lie.source() if source is None else source
    number, sign = axis_of(lie.axis)
    along = sign * seat.axes[:, number]
    first = seat.axes[:, (number + 1) % 3]
    angle = np.radians(lie.turn_deg)
    turned = np.cos(angle) * first + np.sin(angle) * np.cross(along, first)
    local = seat.vertices_mm @ seat.axes
    middle = seat.axes @ (0.5 * (local.min(axis=0) + local.max(axis=0)))
    place = _cylinder if lie.on == "CYLINDER" else _plane
    mat = place((lie, source), (along, turned), (middle, (seat.vertices_mm @ along).max()))
    if not np.isfinite(mat.center_mm).all(axis=1).any():
        raise Refusal("no sensel of the mat reads anything, so none can be placed; load another recording")
    return mat


def _cylinder(flat, directions, where):
    lie, source = flat
    along, seam = directions
    mat = native.module.place_mat(
        source,
        "cylinder",
        origin_mm=where[0],
        rows=along,
        columns=seam,
        diameter_mm=lie.diameter_mm,
        turn="left" if lie.is_mirrored else "right",
        mat=lie.mat or None,
    )
    center = np.asarray(mat.center_mm)
    mat["center_mm"] = center + along * (lie.shift_mm[0] - _middle(center, along) + where[0] @ along)
    return mat


def _plane(flat, directions, where):
    lie, source = flat
    normal, columns = directions
    rows, sense = np.cross(normal, columns), -1.0 if lie.is_mirrored else 1.0
    mat = native.module.place_mat(
        source, "plane", origin_mm=np.zeros(3), rows=rows, columns=sense * columns, mat=lie.mat or None
    )
    center, (middle, top) = np.asarray(mat.center_mm), where
    for direction, shift in ((rows, lie.shift_mm[0]), (columns, lie.shift_mm[1])):
        center = center + direction * (shift - _middle(center, direction) + middle @ direction)
    mat["center_mm"] = center + normal * top
    mat["normal"] = np.where(np.isfinite(center), normal, np.nan)
    return mat


def _middle(points, direction):
    along = points @ direction
    return 0.5 * (np.nanmin(along) + np.nanmax(along))


def axis_of(name):
    """Number of an axis, and its sign, by its name."""
    return "XYZ".index(name[1]), -1.0 if name[0] == "-" else 1.0
