"""Rules of documents: links lead somewhere, commands name what exists, pictures are small."""

import re

import sources

LARGEST_PICTURE = 200_000
"""Bytes of a picture in addon/docs; the README's own are larger."""
_LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
_ANCHOR = re.compile(r"[^\w\- ]")
_XTASK = re.compile(r"cargo xtask (\w+)")
_CARGO = re.compile(r"cargo test ([^`\n]*)")
_FILE = re.compile(r"(?<![\w./-])((?:tests|rust|addon|blend-samples)/[\w./-]*\w)")
_MODULE = re.compile(r"-m ((?:trial|bench|proof)(?:\.\w+)+)")
_PLACEHOLDER = re.compile(r"\b(NAME|PART|CRATE)\b")
_PENDING = ("rust/ARCHITECTURE.md",)
"""Documents that describe folders in words rather than as commands."""


def documents(root):
    """The documents of the repository with their text."""
    return {path: (root / path).read_text() for path in sources.with_suffix(root, ".md")}


def anchors(text):
    """The anchors that a page's headings make."""
    return {_ANCHOR.sub("", title.lower()).replace(" ", "-") for title in re.findall(r"^#+ (.+)$", text, re.M)}


def links(root):
    """Every relative link leads to a file of the repository, and its anchor to a heading."""
    wrong, texts, ours = [], documents(root), set(sources.files(root))
    for path, text in texts.items():
        for target in _LINK.findall(text):
            if re.match(r"[a-z]+:", target):
                continue
            name, _, anchor = target.partition("#")
            found = _within(root, path, name) if name else path
            if found not in ours:
                wrong.append(f"{path}: the link {target} leads nowhere")
            elif anchor and anchor not in anchors(texts.get(found, "")):
                wrong.append(f"{path}: the link {target} names no heading")
    return wrong


def _within(root, path, name):
    """The file that a link in `path` names, relative to the root; None outside of it."""
    place = (root / path.parent / name).resolve()
    return place.relative_to(root.resolve()) if place.is_relative_to(root.resolve()) else None


def commands(root):
    """Every command in a document names a word of xtask, a crate and its test, or a file that exists."""
    wrong, main = [], root / "rust/xtask/src/main.rs"
    known = set(re.findall(r'^ {8}"(\w+)"', main.read_text(), re.M)) if main.exists() else set()
    for path, text in documents(root).items():
        if str(path) in _PENDING:
            continue
        wrong += [f"{path}: there is no command `cargo xtask {word}`" for word in set(_XTASK.findall(text)) - known]
        for line in _CARGO.findall(text):
            wrong += [f"{path}: {fault}" for fault in _cargo_faults(root, line)]
        missing = {name for name in _FILE.findall(text) if not (root / name).exists()}
        wrong += [f"{path}: there is no {name}" for name in sorted(missing) if not _PLACEHOLDER.search(name)]
        for module in set(_MODULE.findall(text)):
            if not (root / "tests" / module.replace(".", "/")).with_suffix(".py").exists():
                wrong.append(f"{path}: there is no module {module}")
    return wrong


def _cargo_faults(root, line):
    crate = re.search(r"-p thenar-(\w+)", line)
    if crate is None:
        return []
    folder = root / "rust" / crate[1]
    if not folder.exists():
        return [f"there is no crate thenar-{crate[1]}"]
    tests = [(folder / "tests" / name, name) for name in re.findall(r"--test (\w+)", line)]
    faults = [name for path, name in tests if not path.with_suffix(".rs").exists() and not (path / "main.rs").exists()]
    modules = {path.stem for path in folder.glob("tests/*/**/*.rs")}
    faults += [f"{name}::" for name in re.findall(r"(\w+)::", line) if name not in modules]
    return [f"thenar-{crate[1]} has no test {name}" for name in faults]


def pictures(root):
    """Pictures of the documents are small."""
    found = [path for path in sources.with_suffix(root, ".png", ".jpg") if path.parts[:2] == ("addon", "docs")]
    sizes = {path: (root / path).stat().st_size for path in found}
    return [
        f"{path}: {size} bytes, {LARGEST_PICTURE} allowed" for path, size in sizes.items() if size > LARGEST_PICTURE
    ]


ALL = [links, commands, pictures]
