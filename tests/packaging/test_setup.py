"""What `cargo xtask setup` promises: the environment, the installed extension and the binary."""

import subprocess

import products
import pytest

ENABLE = """
import addon_utils
module = addon_utils.enable("bl_ext.user_default.thenar")
print(module.__file__)
addon_utils.disable("bl_ext.user_default.thenar")
"""


@pytest.mark.parametrize("environment", products.BLENDERS)
def test_environment_has_blender_the_module_and_the_add_on(environment):
    script = "import bpy, thenar, thenar_blender; print(bpy.app.version_string, thenar_blender.__file__)"
    end = products.run(environment, ["-c", script])
    assert end.stdout.startswith(products.BLENDERS[environment]), end.stderr


def test_edits_of_the_add_on_reach_the_environment():
    script = "import importlib.util as u; print(u.find_spec('thenar_blender').origin)"
    origin = products.run("venv", ["-c", script]).stdout.strip()
    assert products.Path(origin).resolve().parent == products.ROOT / "addon"


@pytest.mark.parametrize("environment", products.BLENDERS)
def test_extension_stands_in_the_user_folder(environment):
    resources = products.TARGET / "blender"
    end = products.run(environment, ["-c", "import bpy" + ENABLE], BLENDER_USER_RESOURCES=str(resources))
    assert str(resources / "extensions/user_default/thenar") in end.stdout, end.stderr


def test_binary_states_the_version():
    end = subprocess.run([products.TARGET / "release/thenar", "--version"], capture_output=True, text=True, timeout=60)
    assert end.stdout.split()[-1:] == [products.VERSION], end.stderr
