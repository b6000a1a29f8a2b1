"""Everything that a file holds, as plain values, to compare before and after; made without the code under test."""

import bpy

_SKIPPED = {"rna_type", "session_uid", "is_evaluated", "tag", "users", "original"}
_DEEP = 3


def of_file():
    """Collection and name of every datablock -> its properties; and what the context has chosen."""
    found = {"context": _context()}
    for kind in dir(bpy.data):
        blocks = getattr(bpy.data, kind)
        if isinstance(blocks, bpy.types.bpy_prop_collection):
            for block in blocks:
                found[kind, block.name] = _values(block, _DEEP) | {"users": getattr(block, "users", 0)}
    return found


def differences(before, after):
    """What differs, in words."""
    lost, gained = before.keys() - after.keys(), after.keys() - before.keys()
    changed = [
        f"{key}.{name}: {before[key].get(name)!r} -> {after[key].get(name)!r}"
        for key in before.keys() & after.keys()
        for name in before[key].keys() | after[key].keys()
        if before[key].get(name) != after[key].get(name)
    ]
    return [f"lost {key}" for key in lost] + [f"gained {key}" for key in gained] + changed


def _context():
    return {
        "scene": bpy.context.scene.name,
        "active": bpy.context.view_layer.objects.active and bpy.context.view_layer.objects.active.name,
        "selected": sorted(obj.name for obj in bpy.context.selected_objects),
        "hidden": sorted(obj.name for obj in bpy.context.scene.objects if obj.hide_get()),
        "handlers": [len(getattr(bpy.app.handlers, name)) for name in ("render_stats", "render_pre", "load_post")],
        "filepath": bpy.data.filepath,
    }


def _values(block, depth):
    out = {}
    for prop in block.bl_rna.properties:
        if prop.identifier in _SKIPPED:
            continue
        try:
            value = getattr(block, prop.identifier)
        except (AttributeError, RuntimeError):
            continue
        out[prop.identifier] = _plain(prop, value, depth)
    return out


def _plain(prop, value, depth):
    if prop.type == "POINTER":
        if value is None or isinstance(value, bpy.types.ID):
            return value and value.name
        return repr(_values(value, depth - 1)) if depth > 0 else ""
    if prop.type == "COLLECTION":
        named = [getattr(row, "name", "") for row in value] if depth > 0 else []
        return len(value), named
    if prop.type == "ENUM" and isinstance(value, set):
        return sorted(value)
    return tuple(map(str, value)) if getattr(prop, "is_array", False) else value
