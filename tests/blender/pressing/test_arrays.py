"""The extension moves arrays whole: nowhere does Python walk over vertices, corners, faces or attribute values."""

import ast
from pathlib import Path

import thenar_blender

SOURCES = [path for path in Path(thenar_blender.__file__).parent.rglob("*.py") if "hand" not in path.parts[-2:-1]]
ELEMENTS = {"vertices", "loops", "polygons", "edges", "points", "loop_triangles", "vertex_normals"}
# Weights have no array access, and the nodes that read them whole touch the scene, which neither a digest of it nor the
# update of a hand's settings must do.
ALLOWED = {("regions.py", "vertices"), ("weights.py", "vertices")}


def walked(tree):
    """Names of what loops and comprehensions walk over, where it is an attribute: `mesh.vertices` gives vertices."""
    for node in ast.walk(tree):
        if isinstance(node, ast.For | ast.comprehension):
            for part in ast.walk(node.iter):
                if isinstance(part, ast.Attribute):
                    yield part.attr, part.lineno


def test_the_search_finds_a_loop():
    tree = ast.parse("out = [v.co for v in mesh.vertices]\nfor a, b in zip(x, key.points): pass")
    assert {name for name, _ in walked(tree)} >= {"vertices", "points"}


def test_no_loop_over_elements():
    found = [
        f"{path.name}:{line} walks over {name}"
        for path in SOURCES
        for name, line in walked(ast.parse(path.read_text(encoding="utf-8")))
        if name in ELEMENTS and (path.name, name) not in ALLOWED
    ]
    assert len(SOURCES) > 30 and not found, found
