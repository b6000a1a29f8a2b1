"""The add-on's sample studies are what their command makes, small, and answered as they were drawn."""

import json

import numpy as np
import pytest
import thenar
from trial.worlds import sample_studies

LARGEST_BYTES = 200_000
RIGHT = {
    "nothing_missing": ({"nothing_missing", "parameters"}, []),
    "concealed_effect": ({"missing_physics"}, ["relaxation"]),
}


@pytest.mark.parametrize("name", sorted(sample_studies.SAMPLES))
def test_the_command_makes_the_shipped_files(name, tmp_path):
    sample_studies.make(tmp_path)
    made = {each.name: each for each in (tmp_path / name).iterdir()}
    shipped = {each.name: each for each in (sample_studies.FOLDER / name).iterdir()}
    assert made.keys() == shipped.keys()
    assert made["study.toml"].read_text() == shipped["study.toml"].read_text()
    for file in made:
        if file.endswith(".csv"):
            tables = [np.loadtxt(each[file], delimiter=",", skiprows=1) for each in (made, shipped)]
            np.testing.assert_allclose(*tables, atol=2e-5)
    assert sum(each.stat().st_size for each in shipped.values()) < LARGEST_BYTES


@pytest.mark.parametrize("name", sorted(sample_studies.SAMPLES))
def test_a_sample_is_answered_as_it_was_drawn(name):
    verdicts, effects = RIGHT[name]
    found = thenar.diagnose(thenar.Study.load(sample_studies.FOLDER / name))
    assert found.verdict in verdicts, found.sentence
    assert [each["effect"] for each in json.loads(found.to_json())["findings"]] == effects
