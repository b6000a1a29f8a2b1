"""The extension in Blender 5.0 and 4.5: installed from its zip, enabled and disabled three times, uninstalled."""

import json
from pathlib import Path

import products
import pytest

SCRIPT = Path(__file__).with_name("life_of_an_extension.py")


@pytest.fixture(scope="module", params=products.BLENDERS)
def life(request, tmp_path_factory):
    """What one process saw; that it ended by itself means that nothing stayed registered (4.5 would hang)."""
    resources = tmp_path_factory.mktemp(request.param)
    end = products.run(request.param, [SCRIPT, products.ZIP], BLENDER_USER_RESOURCES=str(resources))
    assert end.returncode == 0, end.stdout + end.stderr
    return json.loads(end.stdout.split("RESULT ")[1].splitlines()[0]) | {"log": end.stdout + end.stderr}


def test_each_enabling_brings_the_same_classes(life):
    on = [one["on"] for one in life["lives"]]
    assert on[0]["enabled"] and on[0]["scene"] and on[0]["classes"]
    assert on[0] == on[1] == on[2]


def test_each_disabling_leaves_nothing(life):
    for one in life["lives"]:
        assert one["off"] == {"classes": [], "scene": False, "handlers": True}


def test_wheel_is_installed_with_it_and_goes_with_it(life):
    assert "thenar" in life["there"] and f"thenar-{products.VERSION}.dist-info" in life["there"]
    assert life["left"] == []


def test_no_traceback_and_no_warning_is_printed(life):
    assert "Traceback" not in life["log"] and "Warning" not in life["log"], life["log"]
