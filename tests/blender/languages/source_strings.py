"""Finds the strings that a Python file of the add-on shows: in layouts, reports, tooltips of buttons that are off."""

import ast
import re

SHOWN = {"text", "heading"}
"""Keywords whose value a layout shows."""
AT = {
    **{"paragraph": (2,), "faint": (2,), "alert": (2,)},
    **{"_pair": (1, 2), "_compared": (1, 2), "_numbers": (1,)},
}
"""Functions that show what stands at these places of their arguments."""
SPOKEN = {"iface", "tip", "report"}
"""Functions of `addon/languages`, whose first argument is a template; an operator's own `report` has it second."""
UNITS = frozenset(["N", "mm", "cm", "um", "nm", "kPa", "MPa", "ms", "min", "in", "fps", "mJ"])
UNITS |= {"mN", "uN", "kN", "gf", "kgf", "lbf", "px"}
"""Words that are the same in every language."""


class Sources(ast.NodeVisitor):
    """Strings that a source file shows: `found` (line, text), and `composed` f-strings with words, not translatable."""

    def __init__(self, tree):
        self.found, self.composed, self.polled = [], [], set()
        self._functions, self._module = [], tree
        self.visit(tree)

    def visit_FunctionDef(self, node):
        self._functions.append(node)
        self.generic_visit(node)
        self._functions.pop()

    def visit_ClassDef(self, node):
        for line in node.body:
            if isinstance(line, ast.Assign) and getattr(line.targets[0], "id", "") == "noun":
                self._take(line.value)
        self.generic_visit(node)

    def visit_Call(self, node):
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        for keyword in node.keywords:
            if keyword.arg in SHOWN and isinstance(node.func, ast.Attribute):
                self._take(keyword.value)
        for place in AT.get(name, ()):
            for each in node.args[place : place + 1]:
                self._take(each)
        if name in SPOKEN and node.args and not _is_stage(node):
            self._take(node.args[-1] if isinstance(node.args[0], ast.Set) else node.args[0])
        if name == "allows":
            for each in node.args[1:]:
                self._take(each)
                called = each.value if isinstance(each, ast.Starred) else each
                if isinstance(called, ast.Call):
                    self.polled.add(getattr(called.func, "attr", getattr(called.func, "id", "")))
                elif isinstance(called, ast.Name):
                    self.polled |= self._called_in(called.id)
        self.generic_visit(node)

    def returned(self, names):
        """Take what functions of these names return."""
        for node in ast.walk(self._module):
            if isinstance(node, ast.FunctionDef) and node.name in names:
                values = [line.value for line in ast.walk(node) if isinstance(line, ast.Return)]
                self._functions.append(node)
                for value in values:
                    self._take(value)
                self._functions.pop()
                further = {value.func.id for value in values if isinstance(value, ast.Call) and _is_name(value.func)}
                self.returned(further - names)

    def _called_in(self, name):
        """Functions called in what `name` is assigned in this function."""
        values = [line.value for line in ast.walk(self._functions[-1]) if _assigns(line, name)]
        calls = [call for value in values for call in ast.walk(value) if isinstance(call, ast.Call)]
        return {getattr(call.func, "attr", getattr(call.func, "id", "")) for call in calls}

    def _take(self, node, seen=()):
        """Take what an expression may show: every branch, what its names were assigned."""
        if isinstance(node, ast.Constant):
            self.found += [(node.lineno, node.value)] if isinstance(node.value, str) and is_words(node.value) else []
        elif isinstance(node, ast.JoinedStr):
            fixed = "".join(part.value for part in node.values if isinstance(part, ast.Constant))
            self.composed += [(node.lineno, ast.unparse(node))] if is_words(fixed) else []
        elif isinstance(node, ast.BinOp):
            self.composed += [(n.lineno, n.value) for n in _parts(node) if is_words(n.value)]
        elif isinstance(node, ast.IfExp | ast.BoolOp | ast.Tuple | ast.Subscript):
            for value in self._branches(node):
                self._take(value, seen)
        elif _is_name(node) and node.id not in seen and self._functions:
            self._take_assigned(node.id, (*seen, node.id))

    def _branches(self, node):
        if isinstance(node, ast.IfExp):
            return node.body, node.orelse
        if isinstance(node, ast.Subscript):
            return getattr(self._constant(node.value), "values", ())
        return node.values if isinstance(node, ast.BoolOp) else node.elts

    def _take_assigned(self, name, seen):
        for line in ast.walk(self._functions[-1]):
            if _assigns(line, name):
                self._take(line.value, seen)
            elif isinstance(line, ast.For) and isinstance(line.target, ast.Tuple):
                place = [getattr(each, "id", "") for each in line.target.elts]
                rows = getattr(self._constant(line.iter), "elts", ()) if name in place else ()
                for row in rows:
                    if isinstance(row, ast.Tuple) and len(row.elts) == len(place):
                        self._take(row.elts[place.index(name)], seen)

    def _constant(self, node):
        """What a name of the module stands for; what is no such name stays."""
        if not _is_name(node):
            return node
        return next((line.value for line in self._module.body if _assigns(line, node.id)), node)


def _is_name(node):
    return isinstance(node, ast.Name)


def _is_stage(call):
    """Whether it is `watch.report`, whose words are a stage's; numbers in them are for `languages.stage`."""
    return (
        isinstance(call.func, ast.Attribute)
        and getattr(call.func.value, "id", "") == "watch"
        and isinstance(call.args[0], ast.JoinedStr)
    )


def _assigns(line, name):
    return isinstance(line, ast.Assign) and any(getattr(target, "id", "") == name for target in line.targets)


def _parts(node):
    """Strings in an expression, but those of calls in it."""
    if isinstance(node, ast.Call):
        return []
    own = [node] if isinstance(node, ast.Constant) and isinstance(node.value, str) else []
    return own + [part for child in ast.iter_child_nodes(node) for part in _parts(child)]


def is_words(text):
    """Whether a text holds a word of a language, not units, numbers and signs alone."""
    plain = re.sub(r"\{[^}]*\}", " ", text)
    return any(word not in UNITS for word in re.findall(r"[A-Za-z]{2,}", plain))
