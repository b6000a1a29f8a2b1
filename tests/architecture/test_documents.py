"""The documents keep their rules, and each rule speaks when it is broken."""

import document_rules
import pytest
from test_rooms import ROOT

SOUND = {
    "README.md": "# Top\n[there](rust/x/README.md#two-words) `cargo xtask demo`, "
    "`cargo test -p thenar-x --test all ball::`",
    "rust/x/README.md": "# X\n## Two words\n[back](../../README.md) [out](https://example.org) [here](#x)\n",
    "rust/x/tests/all/main.rs": "mod ball;\n",
    "rust/x/tests/all/ball.rs": "//! B.\n",
    "rust/xtask/src/main.rs": '//! M.\n        "demo" => demo(),\n',
    "tests/trial/scoring/ceiling.py": '"""C."""\n',
}
PLANTED = [
    (document_rules.links, "[a](rust/y/README.md)", "leads nowhere"),
    (document_rules.links, "[a](../outside.md)", "leads nowhere"),
    (document_rules.links, "[a](rust/x/README.md#three)", "names no heading"),
    (document_rules.commands, "`cargo xtask fly`", "fly"),
    (document_rules.commands, "`cargo test -p thenar-x --test mindlin`", "mindlin"),
    (document_rules.commands, "`cargo test -p thenar-x --test all mindlin::`", "mindlin"),
    (document_rules.commands, "`cargo test -p thenar-y`", "thenar-y"),
    (document_rules.commands, "`pytest tests/proof/test_none.py`", "test_none.py"),
    (document_rules.commands, "`python -m trial.floor`", "trial.floor"),
    (document_rules.commands, "`python -m trial.scoring.floor`", "trial.scoring.floor"),
    (document_rules.pictures, None, "allowed"),
]


def build(root, contents):
    for name, text in contents.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


@pytest.mark.parametrize("rule", document_rules.ALL, ids=lambda rule: rule.__name__)
def test_rule_holds(rule):
    assert rule(ROOT) == []


@pytest.mark.parametrize("rule", document_rules.ALL, ids=lambda rule: rule.__name__)
def test_sound_documents_are_left_in_peace(rule, tmp_path):
    build(tmp_path, SOUND)
    assert rule(tmp_path) == []


@pytest.mark.parametrize(("rule", "text", "word"), PLANTED)
def test_planted_fault_is_named(rule, text, word, tmp_path):
    build(tmp_path, SOUND | {"README.md": SOUND["README.md"] + (text or "")})
    if text is None:
        build(tmp_path, {"addon/docs/pictures/large.png": "x" * (document_rules.LARGEST_PICTURE + 1)})
    assert any(word in complaint for complaint in rule(tmp_path)), rule(tmp_path)


def test_every_rule_has_a_planted_fault():
    assert {rule for rule, *_ in PLANTED} == set(document_rules.ALL)
