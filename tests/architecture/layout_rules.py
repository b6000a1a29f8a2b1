"""Rules of size and shape: top level, first lines, lengths, depth and names of files."""

import sources

TOP = {"Cargo.toml", "Cargo.lock", "LICENSE", "README.md", "rust", "addon", "tests", "blend-samples"}
FORBIDDEN = {"util", "utils", "helper", "helpers", "common", "misc", "manager", "core"}
FIRST = {".rs": ("//!",), ".py": ('"""',)}
LONGEST = 400
# Parts of the longest path allowed below a top folder: rust/crate/src/room/file.rs, addon/room/file.py.
DEEPEST = {"rust": 6, "addon": 3, "tests": 4}


def top_level(root):
    names = {path.parts[0] for path in sources.files(root)}
    return [f"{name} does not belong at the top" for name in sorted(names - TOP) if not name.startswith(".")]


def first_lines(root):
    wrong = []
    for path in sources.with_suffix(root, *FIRST):
        text = (root / path).read_text()
        if text.strip() and not text.startswith(FIRST[path.suffix]):
            wrong.append(f"{path}: the first line does not say what the file owns")
    return wrong


def lengths(root):
    counts = {path: len((root / path).read_text().splitlines()) for path in sources.with_suffix(root, *FIRST)}
    return [f"{path}: {count} lines, {LONGEST} allowed" for path, count in counts.items() if count > LONGEST]


def depth(root):
    code = sources.with_suffix(root, *FIRST)
    return [f"{path}: too deep" for path in code if len(path.parts) > DEEPEST.get(path.parts[0], 99)]


def names(root):
    wrong = []
    for path in sources.with_suffix(root, *FIRST):
        words = {part.removesuffix(path.suffix) for part in path.parts}
        wrong += [f"{path}: '{word}' says nothing about what it owns" for word in sorted(words & FORBIDDEN)]
    return wrong


def test_file_names(root):
    """One pytest process over all of `tests` needs file names of their own."""
    places = {}
    for path in sources.with_suffix(root, ".py"):
        if path.parts[0] == "tests" and path.name != "conftest.py":
            places.setdefault(path.name, []).append(str(path))
    return [f"same name: {', '.join(paths)}" for paths in places.values() if len(paths) > 1]


test_file_names.__test__ = False
ALL = [top_level, first_lines, lengths, depth, names, test_file_names]
