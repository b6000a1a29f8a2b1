"""Templates of the sentences that a result keeps in English, read from the sources in Rust and Python."""

import ast
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
RUST = {
    "rust/contact/src/fields/warnings.rs": ("impl fmt::Display for Warning", ""),
    "rust/contact/src/skin/prepare.rs": ("if welded.merged() > 0", "let welded_regions"),
    "rust/surface/src/solid/orientation.rs": ("warnings.push", "audit.warnings"),
}
"""File -> where its sentences begin and end."""
MODEL = "rust/contact/src/skin/prepare.rs", "fn title", ""
AUDIT = "rust/surface/src/mesh/audit.rs"
"""Sentences of a count and what there is so many of, and of a mesh that is inside out."""
MESHES = "the hand", "the product"
"""What these sentences call the meshes."""
PYTHON = {
    "addon/reference/notes.py": {"of", "_vertices"},
    "addon/results/grades.py": {"judge"},
    "addon/results/sentences.py": {"_with_others"},
    "addon/results/comfort.py": {"_sentence"},
    "addon/scene/read.py": {"_hand_warnings", "_carry_problem"},
    "addon/scene/write.py": {"_notes", "_listed"},
    "addon/scene/baked.py": {"notes"},
    "addon/skin_display/shown.py": {"notes", "_listed"},
    "addon/workflow.py": {"_left_out"},
}
"""File -> functions whose strings are sentences, or parts of them."""
_LITERAL = re.compile(r'"((?:[^"\\]|\\.)*)"', re.DOTALL)
_MACRO = re.compile(r"\b(?:write|format)!\(|write_str\(")
_FIELD = re.compile(r"\{(\w*)(?::[^}]*)?\}")


def everything():
    """template -> where it stands."""
    out = {}
    for name, (begin, end) in RUST.items():
        out |= dict.fromkeys(of_rust(_between(_read(name), begin, end)), name)
    out |= dict.fromkeys(of_rust(_between(_read(MODEL[0]), *MODEL[1:])), MODEL[0])
    out |= dict.fromkeys(of_audit(_read(AUDIT)), AUDIT)
    for name, functions in PYTHON.items():
        found = of_python(_read(name), functions)
        assert found, name
        out |= dict.fromkeys(found, name)
    return out


def of_rust(text):
    """Templates of the format macros in Rust's text; one for each of the words that a field without name may hold."""
    starts = [found.end() for found in _MACRO.finditer(text)]
    out = []
    for start, end in zip(starts, [*starts[1:], len(text)], strict=True):
        literals = [_plain(found[1]) for found in _LITERAL.finditer(text[start:end])]
        if not literals:
            continue
        template, *words = literals
        one_of = words if "{}" in template else []
        out += [_named(template.replace("{}", word, 1)) for word in one_of] or [_named(template)]
    return [template for template in out if _is_sentence(template)]


def of_audit(text):
    """What a mesh has, by its kinds of faults."""
    body = _between(text, "fn warnings", "impl Mesh")
    phrases = [found for found in map(_plain, _LITERAL.findall(body)) if "{" not in found]
    sentences = [f"{{name}} has {{n}} {phrase}" for phrase in phrases]
    return [*MESHES, *sentences, *[template for template in of_rust(body) if "inside out" in template]]


def of_python(text, functions):
    """Templates of the strings with words that functions of these names hold, their docstrings left out."""
    out = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef) and node.name in functions:
            for line in node.body[1:] if ast.get_docstring(node) else node.body:
                out += [template for template in _strings(line) if _is_sentence(template)]
    return out


def _is_sentence(template):
    """Whether there are words in it; a key of a table, or what joins a list, is none."""
    fixed = _FIELD.sub("", template)
    return " " in fixed and len(re.findall("[a-z]", fixed)) > 3


def _strings(node):
    if isinstance(node, ast.JoinedStr):
        used, parts = {}, []
        for part in node.values:
            field = part.value if isinstance(part, ast.Constant) else _field(part.value, used)
            parts.append(f"'{field}'" if getattr(part, "conversion", -1) == ord("r") else field)
        return ["".join(parts)]
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return [node.value]
    return [text for child in ast.iter_child_nodes(node) for text in _strings(child)]


def _field(node, used):
    """A field named after the expression; a second one of that name has a number."""
    node = node.func if isinstance(node, ast.Call) else node
    name = getattr(node, "attr", getattr(node, "id", "value")).strip("_")
    used[name] = used.get(name, 0) + 1
    return f"{{{name}{used[name] if used[name] > 1 else ''}}}"


def _named(template):
    """Fields of Rust without their formats; those without a name get one each."""
    used = iter(range(1, 10))
    return _FIELD.sub(lambda found: f"{{{found[1] or f'value{next(used)}'}}}", template)


def _plain(literal):
    return re.sub(r"\\\n\s*", "", literal).replace('\\"', '"')


def _between(text, begin, end):
    start = text.index(begin)
    return text[start : text.index(end, start) if end else len(text)]


def _read(name):
    return (ROOT / name).read_text("utf-8")


if __name__ == "__main__":
    for template, where in everything().items():
        print(f"{where}: {template}")
