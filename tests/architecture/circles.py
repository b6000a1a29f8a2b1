"""Which files of a crate, or of the add-on, use each other in a circle. `python tests/architecture/circles.py [CRATE]`.

A path counts for the file that holds the item, not for the `mod.rs` that passes it on. Tests do not count.
"""

import ast
import sys
from pathlib import Path

import rust_tokens

ROOT = Path(__file__).resolve().parents[2]


def of_crate(root, crate):
    """The circles of one crate: lists of files, relative to its `src`, longest first."""
    return _components(crate_uses(root, crate))


def of_addon(root):
    """The circles of the add-on, relative to `addon`."""
    return _components(addon_uses(root))


def crate_uses(root, crate):
    """File -> file it uses -> names it uses of it."""
    folder = root / "rust" / crate / "src"
    files = {path.relative_to(folder).as_posix(): path.read_text() for path in sorted(folder.rglob("*.rs"))}
    return _Crate(files).uses()


def addon_uses(root):
    """The same for the Python files of the add-on. Imports inside functions count: they hide a circle, not open it."""
    folder = root / "addon"
    files = {path.relative_to(folder).as_posix(): path for path in sorted(folder.rglob("*.py"))}
    uses = {}
    for name, path in files.items():
        targets = uses.setdefault(name, {})
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and node.level:
                base = Path(name).parents[node.level - 1] / (node.module or "").replace(".", "/")
                for alias in node.names:
                    target = _python_file(files, base / alias.name) or _python_file(files, base)
                    if target and target != name:
                        targets.setdefault(target, set()).add(alias.name)
    return uses


class _Module:
    """One file: its place, its tokens, what it binds by `use`, what it defines."""

    def __init__(self, name, text):
        self.name = name
        parts = name.removesuffix(".rs").split("/")
        self.place = tuple(parts[:-1] if parts[-1] in ("mod", "lib", "main") else parts)
        code, self.left_out = rust_tokens.without_tests(rust_tokens.tokens(text))
        self.children = {code[i + 1] for i in range(len(code) - 2) if code[i] == "mod" and code[i + 2] == ";"}
        self.bound, self.globs, self.code = {}, [], []
        self.passed_on = set()
        at = 0
        while at < len(code):
            if code[at] == "use":
                end = code.index(";", at)
                public = self.code[-1:] == ["pub"] or (self.code[-1:] == [")"] and "pub" in self.code[-4:])
                for path, alias in _use_tree(code[at + 1 : end]):
                    self._bind(path, alias, public)
                at = end
            else:
                self.code.append(code[at])
            at += 1
        kinds = {"fn", "struct", "enum", "trait", "type", "const", "static", "union", "mod"}
        self.defined = {self.code[i + 1] for i in range(len(self.code) - 1) if self.code[i] in kinds}

    def _bind(self, path, alias, public):
        if alias == "*":
            self.globs.append((path, public))
        else:
            key = alias if alias != "_" else f"_{len(self.bound)}"
            self.bound[key] = path
            if public:
                self.passed_on.add(key)


class _Crate:
    def __init__(self, files):
        modules = [_Module(name, text) for name, text in files.items()]
        hidden = {(*module.place, child) for module in modules for child in module.left_out}
        self.modules = {
            module.place: module
            for module in modules
            if not any(module.place[: depth + 1] in hidden for depth in range(len(module.place)))
        }

    def uses(self):
        return {module.name: self._uses_of(module) for module in self.modules.values()}

    def _uses_of(self, module):
        found = {}

        def note(path):
            target = self._owner(module, path)
            if target and target[0] is not module:
                found.setdefault(target[0].name, set()).add(target[1])

        words = set(module.code)
        for alias, path in module.bound.items():
            # What is only passed on is no use of it.
            if alias not in module.passed_on or alias in words:
                note(path)
        for path, public in module.globs:
            if not public:
                note((*path, "*"))
        for path in _paths(module.code):
            note(path)
        return found

    def _owner(self, module, path, seen=()):
        """The module that holds what `path`, written in `module`, names, and the name; None for what is not ours."""
        if (module.name, path) in seen:
            return None
        seen = (*seen, (module.name, path))
        place, rest = self._start(module, path)
        if place is None:
            # `use csv::csv`-like bindings lead out of the crate.
            if len(path) > 1 and module.bound.get(path[0], path)[0] != path[0]:
                return self._owner(module, module.bound[path[0]] + path[1:], seen)
            return None
        while rest and (*place, rest[0]) in self.modules:
            place, rest = (*place, rest[0]), rest[1:]
        holder = self.modules.get(place)
        if holder is None or not rest:
            # A bare module: what is used of it shows where it is used.
            return None
        if rest[0] in holder.bound:
            return self._owner(holder, holder.bound[rest[0]] + rest[1:], seen)
        if rest[0] not in holder.defined:
            for glob, _ in holder.globs:
                target = self._owner(holder, glob + rest, seen)
                if target and rest[0] in target[0].defined:
                    return target
        return holder, rest[0]

    def _start(self, module, path):
        if path[0] == "crate":
            return (), path[1:]
        if path[0] == "self":
            return module.place, path[1:]
        if path[0] == "super":
            place, rest = module.place[:-1], path[1:]
            while rest and rest[0] == "super":
                place, rest = place[:-1], rest[1:]
            return place, rest
        if path[0] in module.children:
            return module.place, path
        return None, path


def _use_tree(found):
    """The paths of one `use`: (segments, name it is bound to)."""
    prefix, at = [], 0
    while at < len(found):
        token = found[at]
        if token == "{":
            inside, branch, depth = found[at + 1 : rust_tokens.closing(found, at)], [], 0
            result = []
            for one in [*inside, ","]:
                if one == "," and depth == 0:
                    if branch:
                        result += [((*prefix, *path), alias) for path, alias in _use_tree(branch)]
                    branch = []
                else:
                    depth += (one == "{") - (one == "}")
                    branch.append(one)
            return [(path[:-1] if path[-1] == "self" else path, _last(path, alias)) for path, alias in result]
        if token == "*":
            return [(tuple(prefix), "*")]
        if token == "as":
            return [(tuple(prefix), found[at + 1])]
        if token != "::":
            prefix.append(token)
        at += 1
    return [(tuple(prefix), prefix[-1])]


def _last(path, alias):
    return path[-2] if alias == "self" else alias


def _paths(code):
    """Every path of at least two segments that stands in the code."""
    at = 0
    while at < len(code):
        if (code[at][0].isalpha() or code[at][0] == "_") and (at == 0 or code[at - 1] not in ("::", ".")):
            path = [code[at]]
            while at + 2 < len(code) and code[at + 1] == "::" and (code[at + 2][0].isalpha() or code[at + 2][0] == "_"):
                path.append(code[at + 2])
                at += 2
            if len(path) > 1:
                yield tuple(path)
        at += 1


def _python_file(files, path):
    for name in (f"{path.as_posix()}.py", f"{path.as_posix()}/__init__.py"):
        if name in files:
            return name
    return None


def _components(uses):
    """Strongly connected components of more than one file (Tarjan), longest first."""
    index, low, stack, on_stack, found = {}, {}, [], set(), []

    def visit(name):
        index[name] = low[name] = len(index)
        stack.append(name)
        on_stack.add(name)
        for target in sorted(uses.get(name, ())):
            if target not in index:
                visit(target)
                low[name] = min(low[name], low[target])
            elif target in on_stack:
                low[name] = min(low[name], index[target])
        if low[name] == index[name]:
            circle = []
            while not circle or circle[-1] != name:
                circle.append(stack.pop())
                on_stack.discard(circle[-1])
            if len(circle) > 1:
                found.append(sorted(circle))

    for name in sorted(uses):
        if name not in index:
            visit(name)
    return sorted(found, key=lambda circle: (-len(circle), circle))


def shown(uses):
    """The circles in words: each file with what it uses of the others."""
    lines = []
    for circle in _components(uses):
        lines.append(f"circle of {len(circle)} files")
        for name in circle:
            for target in circle:
                if names := uses[name].get(target):
                    lines.append(f"  {name} -> {target}: {', '.join(sorted(names))}")
    return lines


def main(arguments):
    root = ROOT
    if arguments and Path(arguments[0]).is_dir():
        root = Path(arguments.pop(0)).resolve()
    crates = arguments or [*sorted(path.name for path in (root / "rust").iterdir() if path.is_dir()), "addon"]
    for crate in crates:
        uses = addon_uses(root) if crate == "addon" else crate_uses(root, crate)
        sizes = [len(circle) for circle in _components(uses)]
        print(f"{crate}: {len(sizes)} circles of {sizes} files")
        if arguments:
            print("\n".join(shown(uses)))


if __name__ == "__main__":
    main(sys.argv[1:])
