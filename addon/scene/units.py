"""The one place of unit conversions between Blender's world and the library's mm, N, MPa."""

from functools import lru_cache
from typing import Any, TypeAlias

import numpy as np
from bpy.types import Object, Scene
from numpy.typing import ArrayLike, NDArray

Floats: TypeAlias = NDArray[np.floating[Any]]
Ints: TypeAlias = NDArray[np.integer[Any]]
Bools: TypeAlias = NDArray[np.bool_]

MM_PER_M = 1000.0
KPA_PER_MPA = 1000.0
MM2_PER_CM2 = 100.0


def mm_per_unit(scene: Scene) -> float:
    """Millimetres in one Blender unit of `scene`; 1000 times its unit scale, or 1000 where units are off."""
    settings = scene.unit_settings
    scale = 1.0 if settings.system == "NONE" else settings.scale_length
    return MM_PER_M * scale


def world_from_local(obj: Object) -> Floats:
    """The object's world matrix as (4, 4) float64, Blender units."""
    return np.array(obj.matrix_world, dtype=np.float64)


def to_world_mm(positions: Floats, matrix: Floats, scale: float, origin_mm: Floats) -> Floats:
    """Local positions (n, 3) to world mm about `origin_mm` (3), in float64: far objects keep their digits."""
    offset = matrix[:3, 3] * scale - origin_mm
    world = _turned(positions.astype(np.float64), matrix[:3, :3] * scale)
    for axis in range(3):  # a whole column at a time: numpy adds rows of three at half the speed
        world[:, axis] += offset[axis]
    return world


def to_local(positions_mm: Floats, matrix: Floats, scale: float) -> Floats:
    """World positions (n, 3), mm about the world's origin, to the object's local space, Blender units."""
    inverse: Floats = np.linalg.inv(matrix[:3, :3])
    return (positions_mm / scale - matrix[:3, 3]) @ inverse.T


def vectors_to_local(vectors_mm: Floats, matrix: Floats, scale: float) -> Floats:
    """World vectors (n, 3), mm, to the object's local space, Blender units."""
    return _turned(vectors_mm, _inverse((matrix[:3, :3] * scale).tobytes()))


def is_mirrored(matrix: Floats) -> bool:
    """Whether the matrix turns the object inside out, so that triangles need the other winding."""
    return bool(np.linalg.det(matrix[:3, :3]) < 0.0)


def rest_stretch(matrix: Floats, scale: float) -> Floats:
    """The stretch (3, 3), mm per unit, of `matrix` without its rotation; mirrored in x where the matrix mirrors.

    Rest positions under it do not change when the object moves or turns, so that a prepared skin stays valid.
    Five digits are kept: matrices are float32, and turning the object must not change the result.
    """
    linear = matrix[:3, :3] * scale
    values, axes = np.linalg.eigh(linear.T @ linear)
    stretch = (axes * np.sqrt(np.maximum(values, 0.0))) @ axes.T
    size = np.abs(stretch).max() or 1.0
    step = 10.0 ** (np.floor(np.log10(size)) - 5)
    stretch = np.round(stretch / step) * step
    mirrored: Floats = np.diag([-1.0, 1.0, 1.0]) @ stretch if is_mirrored(matrix) else stretch
    return mirrored


def kpa(pressure_mpa: ArrayLike) -> Floats:
    """MPa to kPa."""
    return np.asarray(pressure_mpa) * KPA_PER_MPA


def cm2(area_mm2: float) -> float:
    """mm² to cm²."""
    return area_mm2 / MM2_PER_CM2


@lru_cache(maxsize=8)
def _inverse(linear: bytes) -> Floats:
    """Of a matrix (3, 3) float64, given as its bytes: Live asks every frame, and most often the hand's own stays."""
    return np.linalg.inv(np.frombuffer(linear).reshape(3, 3))


def _turned(vectors: Floats, linear: Floats) -> Floats:
    """`linear` (3, 3) times each of `vectors` (n, 3), as exact as those; twice as fast as with the transposed view."""
    turned: Floats = np.dot(vectors, np.ascontiguousarray(linear.T, vectors.dtype))
    return turned
