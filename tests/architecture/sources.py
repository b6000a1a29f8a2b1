"""Reads the repository for the rules: which files belong to it, and their code without comments and tests."""

import ast
import re
import subprocess
import tomllib

NOT_OURS = {".git", "target", "__pycache__", ".hypothesis", ".ruff_cache", ".pytest_cache"}


def files(root):
    """Every file of the repository, as sorted paths relative to `root`."""
    if (root / ".git").exists():
        command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
        listing = subprocess.run(command, cwd=root, capture_output=True, check=True, text=True).stdout
        found = [root / name for name in listing.split("\0") if name]
    else:
        found = [path for path in root.rglob("*") if not NOT_OURS & set(path.relative_to(root).parts)]
    return sorted({path.relative_to(root) for path in found if path.is_file()})


def with_suffix(root, *suffixes):
    """The files of the repository that end with one of `suffixes`."""
    return [path for path in files(root) if path.suffix in suffixes]


def crates(root):
    """Folder name and parsed Cargo.toml of every crate."""
    return {path.parent.name: tomllib.loads(path.read_text()) for path in sorted(root.glob("rust/*/Cargo.toml"))}


def rust_code(path):
    """Code of a Rust file: without line comments, and without what follows `#[cfg(test)]`."""
    text = path.read_text().split("#[cfg(test)]")[0]
    return "\n".join(re.sub(r"(^|\s)//.*", "", line) for line in text.splitlines())


def library_sources(root, crate):
    """The Rust files of one crate, without its integration tests."""
    return sorted((root / "rust" / crate / "src").rglob("*.rs"))


def imports(path):
    """What a Python file imports: (level, dotted name) with level 0 for absolute imports."""
    found = []
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found += [(0, alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            found += [(node.level, f"{node.module or ''}.{alias.name}".lstrip(".")) for alias in node.names]
    return found
