"""Rules of the add-on: which room imports which, one native import, and nothing that installs or phones."""

import ast
import re
import sys
import tomllib

import sources

BLENDER = {"bpy", "bmesh", "mathutils", "gpu", "gpu_extras", "blf", "imbuf", "bpy_extras", "bl_math", "addon_utils"}
THIRD_PARTY = BLENDER | {"numpy", "thenar"}
# What the user brings to run batches on a cluster; imported where it is asked for, and nowhere else.
CLUSTER = {"distributed", "cloudpickle"}
# No network, no code in data, no installing at run time.
NEVER = {"urllib", "http", "socket", "ftplib", "smtplib", "pickle", "shelve", "pip", "ensurepip"}
# Room -> what it knows nothing of.
KNOWS_NOTHING_OF = {
    "scene": {"native", "workflow", "operators", "panels", "views"},
    "skin_display": {"native", "workflow", "operators", "panels", "views"},
    "product_objects": {"native", "workflow", "operators", "panels", "views"},
    "ownership": {"native", "workflow", "operators", "panels", "views"},
    "workflow": {"operators", "panels", "views"},
    "operators": {"numpy"},
    "panels": {"workflow", "native", "numpy"},
    "views": {"workflow", "native", "operators", "panels"},
    "native": BLENDER,
    "names": BLENDER,
    "cache": BLENDER,
    "properties": {"workflow", "operators", "panels", "views"},
}


def native_import(root):
    """The native module is imported in one place, so that a broken one is told in one place."""
    return [
        f"{path} imports the native module; only native.py may"
        for path, _, name in _imports(root)
        if name == "thenar" and path.as_posix() != "addon/native.py"
    ]


def rooms(root):
    wrong = []
    for path, level, name in _imports(root):
        room = _room(path)
        target = _room(_target(path, level, name)) if level else name
        if target != room and target in KNOWS_NOTHING_OF.get(room, ()):
            wrong.append(f"{path} must know nothing of {target}")
    return wrong


def relative_imports(root):
    """Blender loads the package as bl_ext.REPOSITORY.thenar, so no other name for itself can work."""
    own = {path.stem for path in (root / "addon").glob("*") if path.suffix in ("", ".py")} | {
        "thenar_blender",
        "bl_ext",
    }
    return [
        f"{path} imports {name} by an absolute name"
        for path, level, name in _imports(root)
        if not level and name in own
    ]


def nothing_else(root):
    allowed = set(sys.stdlib_module_names) | THIRD_PARTY
    return [
        f"{path} imports {name}"
        for path, level, name in _imports(root)
        if not level and (name not in allowed or name in NEVER)
        if not (name in CLUSTER and path.parts[:2] == ("addon", "batch"))
    ]


def settings_hold_no_numbers(root):
    """Defaults and ranges of materials come from the one table, in Rust."""
    return [
        f"{path.relative_to(root)}:{node.value.lineno}: {node.arg} = {node.value.value}"
        for path in sorted((root / "addon/properties").glob("*.py"))
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.keyword) and node.arg in ("default", "min", "max") and _is_fraction(node.value)
    ]


def versions_agree(root):
    """The version stands in the workspace's Cargo.toml; what the add-on repeats of it must be the same."""
    package = tomllib.loads((root / "Cargo.toml").read_text())["workspace"]["package"]
    told = {"blender_manifest.toml": r'^version = "(.*)"', "names.py": r'^VERSION = "(.*)"'}
    wrong = []
    for name, pattern in told.items():
        path = root / "addon" / name
        match = re.search(pattern, path.read_text(), re.MULTILINE) if path.exists() else None
        if match and match[1] != package["version"]:
            wrong.append(f"addon/{name} says {match[1]}, Cargo.toml {package['version']}")
    return wrong


def _is_fraction(node):
    return isinstance(node, ast.Constant) and isinstance(node.value, float) and node.value not in (0.0, 1.0)


def _imports(root):
    """Path, level and name: the first part of an absolute import, the whole of a relative one."""
    for path in sources.with_suffix(root, ".py"):
        if path.parts[0] == "addon":
            for level, name in sources.imports(root / path):
                yield path, level, name if level else name.split(".")[0]


def _target(path, level, name):
    """Where a relative import leads, as a path below `addon`."""
    return path.parents[level - 1] / name.replace(".", "/")


def _room(path):
    """`scene` for addon/scene/units.py, `native` for addon/native.py."""
    return path.parts[1].removesuffix(".py") if len(path.parts) > 1 else ""


ALL = [native_import, rooms, relative_imports, nothing_else, settings_hold_no_numbers, versions_agree]
