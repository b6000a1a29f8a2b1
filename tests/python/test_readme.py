"""README.md: its Python runs as it stands, and gives a contact with the force that it asks for."""

from pathlib import Path

import numpy as np
import pytest

README = Path(__file__).parents[2] / "README.md"


def test_the_python_of_the_readme_runs(capsys):
    code = README.read_text().split("```python\n")[1].split("```")[0]
    assert len(code.splitlines()) <= 12
    names = {}
    exec(compile(code, "README.md", "exec"), names)
    assert np.linalg.norm(names["contact"].total_force_n) == pytest.approx(5.0, rel=0.01)
    assert len(capsys.readouterr().out.splitlines()) == 2
