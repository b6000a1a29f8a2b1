"""What the scene shows now, in short: the shapes that a result depends on."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from bpy.types import Context, Object

from . import checks, mesh


def shapes(context: Context, objects: Iterable[Object]) -> list[Any]:
    """Hashable parts (matrix, positions, vertex groups) of each object as evaluated, Thenar's own output included."""
    depsgraph = context.evaluated_depsgraph_get()
    parts = []
    for obj in objects:
        parts.append(obj.name)
        parts.append(np.array(obj.matrix_world, dtype=np.float64))
        if obj.type in checks.PRODUCT_TYPES:
            with mesh.evaluated_mesh(obj, depsgraph) as surface:
                if surface is not None:
                    parts.append(mesh.positions(surface))
        parts.append(tuple(group.name for group in obj.vertex_groups))
    return parts


def is_same(parts: Sequence[Any], others: Sequence[Any] | None) -> bool:
    """Whether two such lists, or lists of arrays, say the same; `others` may be None, which nothing is."""
    if others is None or len(parts) != len(others):
        return False
    return all(
        np.array_equal(part, other) if isinstance(part, np.ndarray) else part == other
        for part, other in zip(parts, others, strict=True)
    )
