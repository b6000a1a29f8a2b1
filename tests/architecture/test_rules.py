"""Every rule speaks when it is broken: each sees a small house with a planted fault, and one without."""

import addon_rules
import layout_rules
import pytest
import rust_rules

CRATE = '[package]\nname = "x"\nversion.workspace = true\n[lints]\nworkspace = true\n'
SOUND = {
    "Cargo.toml": '[workspace.package]\nversion = "1.0.0"\n',
    "addon/blender_manifest.toml": 'schema_version = "2.0.0"\nversion = "1.0.0"\n',
    "addon/names.py": '"""Names."""\n\nVERSION = "1.0.0"\n',
    "rust/surface/Cargo.toml": CRATE,
    "rust/surface/src/lib.rs": "//! Meshes.\n",
    "rust/contact/Cargo.toml": CRATE,
    "rust/contact/src/press.rs": "//! A press.\nimpl Skin {\n    fn x(&self) {}\n}\nfn y(a: &mut Rows, b: &Skin) {}\n",
    "rust/surface/src/tree/bvh.rs": "//! The tree.\nuse obvhs::Bvh;\n",
    "rust/python/src/conversion/arrays.rs": "//! Arrays.\nuse numpy::PyArray1;\n",
    "rust/recordings/src/lib.rs": "//! Files.\nuse std::fs;\n",
    "addon/__init__.py": '"""The extension."""\nimport bpy\nfrom . import native, panels\n',
    "addon/native.py": '"""The native module."""\nimport thenar\n',
    "addon/workflow.py": '"""The order."""\nimport numpy\nfrom . import native\nfrom .scene import units\n',
    "addon/scene/units.py": '"""Units."""\nimport bpy\nimport numpy\n',
    "addon/panels/main.py": '"""Layout."""\nimport bpy\nfrom .. import settings\n',
    "addon/properties/settings.py": '"""Settings."""\nimport bpy\nX = bpy.props.FloatProperty(default=1.0, min=0.0)\n',
}
# Rule, file, what is planted in it, a word of the complaint.
PLANTED = [
    (layout_rules.top_level, "notes.md", "notes", "notes.md"),
    (layout_rules.top_level, "docs/a.md", "notes", "docs"),
    (layout_rules.first_lines, "addon/x.py", "import os\n", "addon/x.py"),
    (layout_rules.first_lines, "rust/surface/src/x.rs", "fn x() {}\n", "x.rs"),
    (layout_rules.lengths, "addon/x.py", '"""X."""\n' + "x = 1\n" * 400, "401 lines"),
    (layout_rules.depth, "rust/surface/src/a/b/c/x.rs", "//! X.\n", "too deep"),
    (layout_rules.depth, "addon/a/b/x.py", '"""X."""\n', "too deep"),
    (layout_rules.names, "addon/utils.py", '"""X."""\n', "'utils'"),
    (layout_rules.names, "rust/surface/src/core/x.rs", "//! X.\n", "'core'"),
    (layout_rules.test_file_names, "tests/b/test_x.py", '"""X."""\n', "same name"),
    (
        rust_rules.crate_dependencies,
        "rust/surface/Cargo.toml",
        CRATE + "[dependencies]\nthenar-contact = {}\n",
        "contact",
    ),
    (rust_rules.crate_dependencies, "rust/surface/Cargo.toml", CRATE + "[dev-dependencies]\nthenar-cli = {}\n", "cli"),
    (rust_rules.crate_dependencies, "rust/extras/Cargo.toml", CRATE, "no place"),
    (rust_rules.python_stays_outside, "rust/surface/Cargo.toml", CRATE + '[dependencies]\npyo3 = "1"\n', "pyo3"),
    (rust_rules.one_file_only, "rust/surface/src/mesh.rs", "//! X.\nuse glam::Vec3A;\n", "bvh.rs"),
    (rust_rules.one_file_only, "rust/python/src/skin.rs", "//! X.\nfn x(a: numpy::PyArray1) {}\n", "arrays.rs"),
    (rust_rules.one_file_only, "rust/comparison/src/x.rs", "//! X.\nconst MAD: f64 = 1.4826;\n", "robust_scale.rs"),
    (rust_rules.one_file_only, "rust/inference/src/fit/x.rs", "//! X.\nfn huber(r: f64) {}\n", "huber.rs"),
    (rust_rules.one_file_only, "rust/inference/src/fit/x.rs", "//! X.\nfn f(damping: f64) {}\n", "marquardt.rs"),
    (rust_rules.libraries_are_silent, "rust/surface/src/x.rs", '//! X.\nfn x() { println!("x"); }\n', "println!"),
    (rust_rules.libraries_are_silent, "rust/recordings/src/x.rs", "//! X.\nfn x() { dbg!(1); }\n", "dbg!"),
    (rust_rules.libraries_read_no_files, "rust/contact/src/x.rs", "//! X.\nuse std::fs::File;\n", "std::fs"),
    (rust_rules.skins_are_only_read, "rust/contact/src/x.rs", "//! X.\nfn x(skin: &mut Skin) {}\n", "&mut Skin"),
    (rust_rules.skins_are_only_read, "rust/contact/src/x.rs", "//! X.\nstruct X(Mutex<Skin>);\n", "Mutex<Skin"),
    (
        rust_rules.skins_are_only_read,
        "rust/contact/src/x.rs",
        "//! X.\nimpl Skin {\n    fn x(&mut self) {}\n}\n",
        "self",
    ),
    (rust_rules.skins_are_only_read, "rust/contact/src/skin/x.rs", "//! X.\nuse std::cell::Cell;\n", "Cell"),
    (rust_rules.lints_are_on, "rust/surface/Cargo.toml", CRATE.replace("[lints]\nworkspace = true\n", ""), "lints"),
    (rust_rules.lints_are_on, "rust/surface/src/x.rs", "//! X.\n#![allow(clippy::unwrap_used)]\n", "unwrap"),
    (
        rust_rules.version_stands_once,
        "rust/surface/Cargo.toml",
        '[package]\nname = "x"\nversion = "1.0.0"\n',
        "version",
    ),
    (addon_rules.native_import, "addon/workflow.py", "import thenar\n", "workflow.py"),
    (addon_rules.native_import, "addon/scene/read.py", "from thenar import Skin\n", "read.py"),
    (addon_rules.rooms, "addon/panels/main.py", "from .. import workflow\n", "workflow"),
    (addon_rules.rooms, "addon/panels/main.py", "from ..native import module\n", "native"),
    (addon_rules.rooms, "addon/scene/read.py", "from ..operators.solve import X\n", "operators"),
    (addon_rules.rooms, "addon/operators/solve.py", "import numpy as np\n", "numpy"),
    (addon_rules.rooms, "addon/names.py", "def f():\n    import bpy\n", "bpy"),
    (addon_rules.rooms, "addon/workflow.py", "from .panels import main\n", "panels"),
    (addon_rules.relative_imports, "addon/workflow.py", "import scene.units\n", "absolute"),
    (addon_rules.relative_imports, "addon/workflow.py", "from thenar_blender import native\n", "absolute"),
    (addon_rules.nothing_else, "addon/workflow.py", "import scipy.sparse\n", "scipy"),
    (addon_rules.nothing_else, "addon/workflow.py", "import pickle\n", "pickle"),
    (addon_rules.nothing_else, "addon/workflow.py", "from urllib import request\n", "urllib"),
    (addon_rules.versions_agree, "addon/names.py", 'VERSION = "1.0.1"\n', "1.0.1"),
    (addon_rules.versions_agree, "addon/blender_manifest.toml", 'version = "0.9.0"\n', "0.9.0"),
    (addon_rules.settings_hold_no_numbers, "addon/properties/settings.py", "X = f(default=0.005)\n", "0.005"),
]


def build(root, contents):
    for name, text in contents.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


@pytest.mark.parametrize("rule", layout_rules.ALL + rust_rules.ALL + addon_rules.ALL, ids=lambda rule: rule.__name__)
def test_sound_house_is_left_in_peace(rule, tmp_path):
    build(tmp_path, SOUND)
    assert rule(tmp_path) == []


@pytest.mark.parametrize(("rule", "file", "text", "word"), PLANTED)
def test_planted_fault_is_named(rule, file, text, word, tmp_path):
    build(tmp_path, SOUND | {"tests/a/test_x.py": '"""X."""\n', file: text})
    assert any(word in complaint for complaint in rule(tmp_path)), rule(tmp_path)


def test_every_rule_has_a_planted_fault():
    shown = {rule for rule, *_ in PLANTED}
    assert shown == set(layout_rules.ALL + rust_rules.ALL + addon_rules.ALL)


def test_code_in_tests_and_comments_does_not_count(tmp_path):
    text = '//! X.\n// println!("x")\n#[cfg(test)]\nmod tests { fn x() { println!("x"); } }\n'
    build(tmp_path, SOUND | {"rust/surface/src/x.rs": text})
    assert rust_rules.libraries_are_silent(tmp_path) == []
