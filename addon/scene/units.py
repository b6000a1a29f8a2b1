"""The one place of unit conversions between Blender's world and the library's mm, N, MPa."""

from functools import lru_cache

import numpy as np

MM_PER_M = 1000.0
KPA_PER_MPA = 1000.0
MM2_PER_CM2 = 100.0


def mm_per_unit(scene):
    """Millimetres in one Blender unit of `scene`; 1000 times its unit scale, or 1000 where units are off."""
    settings = scene.unit_settings
    scale = 1.0 if settings.system == "NONE" else settings.scale_length
    return MM_PER_M * scale


def world_from_local(obj):
    """The object's world matrix as (4, 4) float64, Blender units."""
    return np.array(obj.matrix_world, dtype=np.float64)


def to_world_mm(positions, matrix, scale, origin_mm):
    """Local positions (n, 3) to world mm about `origin_mm` (3), in float64: far objects keep their digits."""
    offset = matrix[:3, 3] * scale - origin_mm
    world = _turned(positions.astype(np.float64), matrix[:3, :3] * scale)
    for axis in range(3):  # a whole column at a time: numpy adds rows of three at half the speed
        world[:, axis] += offset[axis]
    return world


def to_local(positions_mm, matrix, scale):
    """World positions (n, 3), mm about the world's origin, to the object's local space, Blender units."""
    return (positions_mm / scale - matrix[:3, 3]) @ np.linalg.inv(matrix[:3, :3]).T


def vectors_to_local(vectors_mm, matrix, scale):
    """World vectors (n, 3), mm, to the object's local space, Blender units."""
    return _turned(vectors_mm, _inverse((matrix[:3, :3] * scale).tobytes()))


def is_mirrored(matrix):
    """Whether the matrix turns the object inside out, so that triangles need the other winding."""
    return np.linalg.det(matrix[:3, :3]) < 0.0


def rest_stretch(matrix, scale):
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
    return np.diag([-1.0, 1.0, 1.0]) @ stretch if is_mirrored(matrix) else stretch


def kpa(pressure_mpa):
    """MPa to kPa."""
    return np.asarray(pressure_mpa) * KPA_PER_MPA


def cm2(area_mm2):
    """mm² to cm²."""
    return area_mm2 / MM2_PER_CM2


@lru_cache(maxsize=8)
def _inverse(linear):
    """Of a matrix (3, 3) float64, given as its bytes: Live asks every frame, and most often the hand's own stays."""
    return np.linalg.inv(np.frombuffer(linear).reshape(3, 3))


def _turned(vectors, linear):
    """`linear` (3, 3) times each of `vectors` (n, 3), as exact as those; twice as fast as with the transposed view."""
    return np.dot(vectors, np.ascontiguousarray(linear.T, vectors.dtype))
