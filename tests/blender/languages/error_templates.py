"""Templates of what a failed button reports: of the errors that Python raises, and of those of the Rust library."""

import ast
import re
from functools import cache
from pathlib import Path

import sentence_templates as kept

ROOT = Path(__file__).resolve().parents[3]
UNSEEN = ("addon/batch/", "addon/terminal/", "addon/languages/", "addon/__main__.py", "addon/picture_sets/__init__.py")
"""Files of the command line, whose errors are written to a terminal."""
ERRORS = re.compile(r"(?!AssertionError)(?:\w+Error|Refusal)$")
RUST = {
    "surface": ("mesh/triangles.rs",),
    "hand": ("error.rs", "size.rs"),
    "contact": (
        *("error.rs", "api.rs", "effects/definition/active.rs", "skin/tissue.rs", "skin/materials.rs"),
        *("history/protocol.rs", "history/row_stepper.rs", "interface/friction.rs", "soft_grip/elastomer.rs"),
        *("instrument/mat/mod.rs", "instrument/observe.rs", "instrument/signals.rs"),
    ),
    "reference": ("",),
    "inference": ("errors.rs", "forward/", "grasp/"),
    "recordings": ("",),
    "python": ("conversion/errors.rs", "conversion/running.rs"),
}
"""Crate -> files, or folders, whose strings with words are parts of errors; "" is all of them."""
PLACES = {"'{hand}' on '{product}'": "addon/results/sentences.py"}
"""What stands before the library's own sentence."""
KEYS = "rust/recordings/src/study/toml_tree.rs"
"""Where `is no number` follows the key that a file gives."""
_COLUMN = '{column} = "{first}" under [recordings.columns] in study.toml, or --column "{column}={first}"'
APART = {
    "{key} is {number}": KEYS,
    "{key} is NaN": KEYS,
    **dict.fromkeys(
        ("which of {names} is it", f"name it: {_COLUMN}", "a minus before the name turns the sign"),
        "rust/recordings/src/study/indentation.rs",
    ),
}
"""What is too short for a sentence, and a question of `tables/run.rs` that is a problem with its remedy here."""
JOINTS = re.compile(r"(?:(?<=[^:;]):|;) ")
"""Where a sentence is put together of parts that have templates of their own."""
_BARE = re.compile(r"\{\w+\}")


@cache
def everything():
    """template -> where it stands."""
    return {**PLACES, **APART, **of_python(), **of_rust()}


@cache
def of_python():
    """Those of all Python files that a button can reach."""
    trees = {
        name: ast.parse(path.read_text("utf-8"))
        for path in sorted((ROOT / "addon").rglob("*.py"))
        if not (name := path.relative_to(ROOT).as_posix()).startswith(UNSEEN)
    }
    sources = Sources(trees.values())
    out = {}
    for name, tree in trees.items():
        for found in raised(tree, sources):
            out.setdefault(found, name)
    return out


class Sources:
    """Functions and calls of all files, by the name of the function."""

    def __init__(self, trees):
        self.functions, self.calls = {}, {}
        for tree in trees:
            for node in ast.walk(tree):
                if isinstance(node, ast.FunctionDef):
                    self.functions.setdefault(node.name, []).append((node, tree))
                elif isinstance(node, ast.Call):
                    name = getattr(node.func, "attr", getattr(node.func, "id", ""))
                    self.calls.setdefault(name, []).append(node)


def raised(tree, sources):
    """Templates of all errors that the tree raises."""
    for function in [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]:
        place = _Place(function, tree, sources)
        for node in ast.walk(function):
            if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call) and node.exc.args:
                called = node.exc.func
                title = getattr(called, "attr", getattr(called, "id", "type"))
                if ERRORS.match(title) or title == "type":
                    for argument in node.exc.args:
                        yield from place.sentences(argument)


class _Place:
    """Where an expression stands, so that the names in it can be followed."""

    def __init__(self, function, tree, sources):
        self._function, self._tree, self._sources = function, tree, sources
        self._seen = set()

    def sentences(self, node):
        """Templates of all texts with words that an expression may be, and of the texts that fill them."""
        for text in self._texts(node):
            yield from split(text)

    def _texts(self, node):
        if isinstance(node, ast.Constant | ast.JoinedStr):
            yield from kept._strings(node)
        if isinstance(node, ast.Name):
            yield from self._assigned(node.id)
            yield from self._given(node.id)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name | ast.Attribute):
            name = getattr(node.func, "attr", getattr(node.func, "id", ""))
            if name != "get":  # of a dictionary of texts
                yield from self._returned(name)
        for part in _branches(node):
            yield from self._texts(part)

    def _assigned(self, name):
        if name in self._seen:
            return
        self._seen.add(name)
        for scope in (ast.walk(self._function), self._tree.body):
            for line in scope:
                if isinstance(line, ast.Assign):
                    for target in line.targets:
                        yield from self._value(target, line.value, name)

    def _value(self, target, value, name):
        if getattr(target, "id", "") == name:
            yield from self._texts(value)
        elif isinstance(target, ast.Tuple) and name in (names := [getattr(each, "id", "") for each in target.elts]):
            for row in [value, getattr(value, "body", None), getattr(value, "orelse", None)]:
                if isinstance(row, ast.Tuple) and len(row.elts) == len(names):
                    yield from self._texts(row.elts[names.index(name)])

    def _given(self, name):
        """Literals that callers give for a parameter."""
        names = [each.arg for each in self._function.args.args]
        for call in self._sources.calls.get(self._function.name, ()) if name in names else ():
            given = [word.value for word in call.keywords if word.arg == name]
            given += call.args[names.index(name) :][:1] if names[:1] != ["self"] else []
            for value in given:
                if isinstance(value, ast.Constant | ast.JoinedStr):
                    yield from self._texts(value)

    def _returned(self, name):
        if (name, "()") in self._seen:
            return
        self._seen.add((name, "()"))
        for function, tree in self._sources.functions.get(name, ()):
            place = _Place(function, tree, self._sources)
            place._seen |= self._seen
            for line in ast.walk(function):
                if isinstance(line, ast.Return | ast.Yield) and line.value is not None:
                    yield from place._texts(line.value)


def _branches(node):
    """Expressions of which one is the value, or of which it is made."""
    if isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "get":
        return node.func.value, *node.args[1:]
    if isinstance(node, ast.BinOp):
        return node.left, node.right
    if isinstance(node, ast.IfExp):
        return node.body, node.orelse
    if isinstance(node, ast.JoinedStr):
        return [part.value for part in node.values if isinstance(part, ast.FormattedValue)]
    return node.values if isinstance(node, ast.BoolOp | ast.Dict) else ()


@cache
def of_rust():
    """Those of the Rust library's errors."""
    out = {}
    for crate, files in RUST.items():
        for name, text in sources(crate, files):
            for found in of_text(text):
                of_key = name == KEYS and found.startswith("is ")
                out.setdefault(f"{{key}} {found}" if of_key else found, name)
    return out


def sources(crate, files):
    """(name, text without tests and comments) of the crate's files."""
    folder = ROOT / "rust" / crate / "src"
    for path in sorted(folder.rglob("*.rs")):
        name = path.relative_to(folder).as_posix()
        if name.startswith(tuple(files)) and "tests" not in path.parts and path.stem != "tests":
            text = path.read_text("utf-8").partition("#[cfg(test)]")[0]
            yield f"rust/{crate}/src/{name}", re.sub(r"(?m)^\s*//.*$", "", text).replace("'\"'", "")


def of_text(text):
    """Templates of all literals with words in Rust's text; a capital or a colon at the end marks a word of a format."""
    for found in kept._LITERAL.finditer(text):
        if not (re.match(r"\W*[A-Z]", found[1].replace("{", "a{", 1)) or found[1].endswith((":", "(", "\\n"))):
            text = kept._named(kept._plain(found[1]))
            yield from split(re.sub(r"\{(\d)\}", lambda place: f"{{value{int(place[1]) + 1}}}", text))


def split(template):
    """The templates of a sentence that is put together: what stands between its parts that are fields alone."""
    parts, run = JOINTS.split(template), []
    seams = [found[0] for found in JOINTS.finditer(template)]
    for part, seam in zip(parts, [*seams, ""], strict=True):
        if _BARE.fullmatch(part):
            yield from _whole(run)
            run = []
        else:
            run += [part, seam]
    yield from _whole(run)


def _whole(run):
    text = "".join(run[:-1]).strip()
    if kept._is_sentence(text):
        yield text


if __name__ == "__main__":
    for template, where in everything().items():
        print(f"{where}: {template}")
