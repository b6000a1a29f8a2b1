"""How many values each function takes, counted through tuples; the receiver of a method is one of them."""

import ast

import rust_tokens

MOST = 5


def of_rust(text, aliases=None):
    """Name and number of values of every function of `text` outside its tests."""
    code, _ = rust_tokens.without_tests(rust_tokens.tokens(text))
    aliases = aliases if aliases is not None else tuples_by_name([text])
    found = []
    for at in range(len(code) - 2):
        if code[at] == "fn" and (code[at + 1][0].isalpha() or code[at + 1][0] == "_"):
            start = at + 2
            if code[start] == "<":
                start = _after_angles(code, start)
            inside = code[start + 1 : rust_tokens.closing(code, start)]
            found.append((code[at + 1], sum(_parameter(one, aliases) for one in _split(inside))))
    return found


def of_python(text):
    """The same for Python; what is given by name alone counts too."""
    found = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            arguments = node.args
            count = len(arguments.posonlyargs) + len(arguments.args) + len(arguments.kwonlyargs)
            found.append((node.name, count))
    return found


def tuples_by_name(texts):
    """Names that stand for tuples, by `type Name = (...)`: they hide no values."""
    found = {}
    for text in texts:
        code, _ = rust_tokens.without_tests(rust_tokens.tokens(text))
        for at in range(len(code) - 3):
            if code[at] == "type":
                equals = at + 2
                if code[equals] == "<":
                    equals = _after_angles(code, equals)
                if code[equals] == "=" and code[equals + 1] == "(":
                    found[code[at + 1]] = code[equals + 1 : code.index(";", equals)]
    return found


def _parameter(found, aliases):
    while found[:2] == ["#", "["]:
        found = found[rust_tokens.closing(found, 1) + 1 :]
    for at, token in enumerate(found):
        if token in ("(", "[", "{") and ":" not in found[:at]:
            # A pattern: its colon comes behind it.
            behind = rust_tokens.closing(found, at) + 1
            return _values(found[behind + 1 :], aliases)
        if token == ":":
            return _values(found[at + 1 :], aliases)
    return 1


def _values(found, aliases):
    """Values of one type: a tuple has those of its parts, anything else is one."""
    while found and (found[0] in ("&", "mut") or found[0].startswith("'")):
        found = found[1:]
    if found and found[0] == "(" and rust_tokens.closing(found, 0) == len(found) - 1:
        return sum(_values(part, aliases) for part in _split(found[1:-1]))
    if found and found[0] in aliases and (len(found) == 1 or found[1] == "<"):
        return _values(aliases[found[0]], {name: type_ for name, type_ in aliases.items() if name != found[0]})
    return 1


def _split(found):
    """Parts between commas that stand in no bracket."""
    parts, part, depth = [], [], 0
    for token in [*found, ","]:
        if token == "," and depth == 0:
            if part:
                parts.append(part)
            part = []
        else:
            depth += (token in "([{<") - (token in ")]}>") if len(token) == 1 else 0
            part.append(token)
    return parts


def _after_angles(found, at):
    depth = 0
    while True:
        depth += (found[at] == "<") - (found[at] == ">")
        at += 1
        if depth == 0:
            return at
