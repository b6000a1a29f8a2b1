"""Point attributes on meshes: get or create, typed writes, and copies to restore them from."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from bpy.types import Mesh
from numpy.typing import ArrayLike, NDArray

from ..ownership import owned

_FIELD = {"FLOAT": "value", "INT": "value", "FLOAT_VECTOR": "vector", "FLOAT_COLOR": "color"}
_WIDTH = {"FLOAT": 1, "INT": 1, "FLOAT_VECTOR": 3, "FLOAT_COLOR": 4}


def write(mesh: Mesh, name: str, kind: str, values: ArrayLike) -> None:
    """Write point attribute `name` of `kind`; where there is one, it is Thenar's, see `owned`."""
    attribute = mesh.attributes.get(name)
    if attribute is not None and attribute.data_type != kind and owned.is_marked(mesh, name):
        mesh.attributes.remove(attribute)
        attribute = None
    if attribute is None:
        mesh.attributes.new(name, kind, "POINT")
        attribute = mesh.attributes[name]
        owned.mark(mesh, name)
    dtype = np.int32 if kind == "INT" else np.float32
    attribute.data.foreach_set(_FIELD[kind], np.ascontiguousarray(values, dtype).ravel())


def settle(mesh: Mesh, name: str, kind: str, values: ArrayLike) -> bool:
    """Write as `write` does, but only where the mesh holds something else: writing makes Blender evaluate it again.

    Returns whether it wrote.
    """
    attribute = mesh.attributes.get(name)
    held = read(mesh, name) if attribute is not None and attribute.data_type == kind else None
    if held is not None and np.array_equal(held, values):
        return False
    write(mesh, name, kind, values)
    return True


def read(mesh: Mesh, name: str) -> NDArray[Any] | None:
    """Values (n,) or (n, k) of a point attribute, or None where the mesh has none of that name."""
    attribute = mesh.attributes.get(name)
    if attribute is None or attribute.data_type not in _FIELD or attribute.domain != "POINT":
        return None
    width = _WIDTH[attribute.data_type]
    dtype = np.int32 if attribute.data_type == "INT" else np.float32
    out = np.empty(len(attribute.data) * width, dtype)
    attribute.data.foreach_get(_FIELD[attribute.data_type], out)
    return out if width == 1 else out.reshape(-1, width)


def remove(mesh: Mesh, attribute_names: Iterable[str]) -> None:
    """Remove the attributes of these names where they exist and are Thenar's."""
    for name in [name for name in attribute_names if owned.is_own(mesh, name)]:
        mesh.attributes.remove(mesh.attributes[name])
        owned.unmark(mesh, name)


def snapshot(mesh: Mesh, attribute_names: Iterable[str]) -> Callable[[], None]:
    """A function that puts these attributes back as they are now."""
    kept = {
        name: (mesh.attributes[name].data_type, values)
        for name in attribute_names
        if (values := read(mesh, name)) is not None
    }

    def restore() -> None:
        remove(mesh, [name for name in attribute_names if name not in kept])
        for name, (kind, values) in kept.items():
            write(mesh, name, kind, values)

    return restore
