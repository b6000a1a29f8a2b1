"""What breaks a rule today may only fall: `ratchets.toml` holds, and each ratchet speaks when it is broken."""

from pathlib import Path

import circles
import pytest
import ratchets
import signatures
from test_rules import CRATE, build

ROOT = Path(__file__).resolve().parents[2]
LONG = "def f(a, b, c, d, e, f):\n    pass\n"
# Rule, files of a small house, the place and the count that are found.
PLANTED = [
    (
        ratchets.files_in_circles,
        {"rust/surface/src/a.rs": "use crate::b::B;\n", "rust/surface/src/b.rs": "use super::a::A;\n"},
        ("surface", 2),
    ),
    (
        ratchets.files_in_circles,
        {"addon/a.py": "from . import b\n", "addon/b.py": "def f():\n    from .a import x\n"},
        ("addon", 2),
    ),
    (
        ratchets.largest_circle,
        {f"rust/surface/src/{a}.rs": f"fn f() {{ crate::{b}::g(); }}\n" for a, b in ("ab", "bc", "ca", "de", "ed")},
        ("surface", 3),
    ),
    (
        ratchets.values_per_function,
        {"rust/surface/src/a.rs": "fn f((a, b): (&A, [f64; 3]), c: &(B, (C, D)), e: E) {}\n"},
        ("surface", 1),
    ),
    (ratchets.values_per_function, {"addon/a.py": LONG}, ("addon", 1)),
    (
        ratchets.files_per_folder,
        {f"addon/f{k}.py": '"""X."""\n' for k in range(17)},
        ("addon", 2),
    ),
    (ratchets.readme_lines, {"README.md": "line\n" * 153}, ("README.md", 3)),
    (ratchets.avoided_words, {"rust/surface/src/borne_out.rs": "//! X.\n"}, ("surface", 1)),
    (
        ratchets.avoided_words,
        {"rust/surface/src/a.rs": "#[cfg(test)]\nmod t { #[test]\n#[ignore]\nfn what_is_told_anew() {} }\n"},
        ("surface", 2),
    ),
    (ratchets.avoided_words, {"tests/test_a.py": "def test_what_stands():\n    pass\n"}, ("tests", 1)),
]
HOUSE = {"rust/surface/Cargo.toml": CRATE, "rust/surface/src/lib.rs": "//! Meshes.\nmod a;\nmod b;\npub use a::A;\n"}


@pytest.mark.parametrize("rule", ratchets.ALL, ids=lambda rule: rule.__name__)
def test_count_is_the_one_in_the_table(rule):
    assert not (wrong := ratchets.complaints(ROOT, rule, ratchets.read_table(ROOT))), "\n".join(wrong)


@pytest.mark.parametrize("rule", ratchets.ALL, ids=lambda rule: rule.__name__)
def test_sound_house_counts_nothing(rule, tmp_path):
    build(tmp_path, HOUSE)
    assert ratchets.counts(tmp_path, rule) == {}


@pytest.mark.parametrize(("rule", "files", "found"), PLANTED)
def test_planted_fault_is_counted(rule, files, found, tmp_path):
    build(tmp_path, HOUSE | files)
    assert ratchets.counts(tmp_path, rule) == dict([found])
    place, count = found
    table = {rule.__name__: {place: count}}
    assert ratchets.complaints(tmp_path, rule, table) == []
    [risen] = ratchets.complaints(tmp_path, rule, {rule.__name__: {place: count - 1}})
    assert f"{place}: {count}, {count - 1} allowed" in risen
    [fallen] = ratchets.complaints(tmp_path, rule, {rule.__name__: {place: count + 1}})
    assert f"lower the ratchet to {count} " in fallen


def test_every_ratchet_has_a_planted_fault():
    assert {rule for rule, *_ in PLANTED} == set(ratchets.ALL)


def test_table_is_rewritten_lower_and_higher_only_by_name(tmp_path):
    build(tmp_path, HOUSE | {"addon/a.py": LONG, "README.md": "line\n" * 153})
    table = {"readme_lines": {"README.md": 9}, "files_per_folder": {"rust/gone": 4}}
    new, refused = ratchets.updated(tmp_path, table)
    assert new == {"readme_lines": {"README.md": 3}}
    assert refused == ["values_per_function.addon: 1, 0 allowed"]
    new, refused = ratchets.updated(tmp_path, table, ["values_per_function.addon"])
    assert new["values_per_function"] == {"addon": 1} and not refused
    build(tmp_path, {ratchets.TABLE.as_posix(): ratchets.written(new)})
    assert ratchets.read_table(tmp_path) == new


@pytest.mark.parametrize(
    ("parameters", "values"),
    [
        ("", 0),
        ("&mut self, a: A", 2),
        ("self: Box<Self>", 1),
        ("a: A, b: impl Fn(A, &B) -> (C, D), c: HashMap<A, Vec<(B, C)>>", 3),
        ("(a, (b, c)): (A, (B, C)), d: &'a (D, E)", 5),
        ("[a, b]: [A; 2], Pair { x: left, y }: Pair, _: (A)", 3),
        ("#[cfg(x)] mut a: &mut [(A, B)], f: fn(A, B) -> C", 2),
        ("work: &dyn Fn(&(A, B), [f64; { N + 1 }]), rest: Option<(A, B)>,", 2),
        ("place: Place, other: &Place", 6),
    ],
)
def test_values_are_counted_through_tuples(parameters, values):
    head = "type Place = (A, B, C);\npub(crate) fn f<'a, A: Fn(B, C) -> D, const N: usize>"
    text = f"{head}({parameters}) -> (A, B) {{ g(|a, b| a) }}\n"
    assert signatures.of_rust(text) == [("f", values)]


@pytest.mark.parametrize(
    ("files", "sizes"),
    [
        # The file that holds an item counts, not the one that passes it on.
        ({"m/mod.rs": "mod a;\npub use a::A;\n", "m/a.rs": "pub struct A;\n", "x.rs": "use crate::m::A;\n"}, []),
        (
            {
                "m/mod.rs": "mod a;\npub use a::A;\n",
                "m/a.rs": "use crate::x::X;\npub struct A;\n",
                "x.rs": "use crate::m::A;\n",
            },
            [2],
        ),
        (
            {
                "m/mod.rs": "mod a;\npub use a::*;\n",
                "m/a.rs": "use crate::x::X;\npub struct A;\n",
                "x.rs": "use crate::m::A;\n",
            },
            [2],
        ),
        # A child that uses what its parent holds, and a parent that uses its child.
        ({"m/mod.rs": "mod a;\nuse a::f;\npub struct S;\n", "m/a.rs": "use super::S;\n"}, [2]),
        ({"m/mod.rs": "mod a;\npub struct S;\nfn g() { a::f(S) }\n", "m/a.rs": "use super::S;\n"}, [2]),
        # Through a module that was brought in, and in braces.
        ({"x.rs": "use crate::{y, z::{self, Z}};\nfn f() { y::g(); }\n", "y.rs": "fn g(x: crate::x::X) {}\n"}, [2]),
        # Tests, comments and strings do not count.
        ({"x.rs": "use crate::y::Y;\n", "y.rs": '// crate::x::f\nconst S: &str = "crate::x::f";\n'}, []),
        ({"x.rs": "use crate::y::Y;\n", "y.rs": "#[cfg(test)]\nmod tests { use crate::x::X; }\nstruct Y;\n"}, []),
        (
            {
                "x.rs": "#[cfg(test)]\nmod t;\nstruct X;\n",
                "x/t.rs": "use super::X;\nuse crate::y::Y;\n",
                "y.rs": "use crate::x::X;\n",
            },
            [],
        ),
        (
            {
                "x.rs": "#[cfg(test)]\nmod t {}\nuse crate::y::Y;\n",
                "y.rs": "fn f<'a>(c: char) -> bool { c == '\"' && crate::x::f('\\'') }\n",
            },
            [2],
        ),
    ],
)
def test_circles_are_those_of_items(files, sizes, tmp_path):
    build(tmp_path, {f"rust/surface/src/{name}": text for name, text in files.items()})
    assert [len(circle) for circle in circles.of_crate(tmp_path, "surface")] == sizes
