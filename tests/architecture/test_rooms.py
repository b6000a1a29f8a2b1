"""The house keeps its rules: every rule holds for this repository."""

from pathlib import Path

import addon_rules
import layout_rules
import pytest
import rust_rules

ROOT = Path(__file__).resolve().parents[2]
RULES = layout_rules.ALL + rust_rules.ALL + addon_rules.ALL


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
def test_rule_holds(rule):
    assert not (wrong := rule(ROOT)), "\n".join(wrong)
