"""Run inside Blender: installs, enables and disables three times, uninstalls; prints one line of JSON."""

import json
import sys
from pathlib import Path

import bpy

MODULE = "bl_ext.user_default.thenar"


def handlers():
    """How many functions each of Blender's handler lists holds."""
    lists = {name: getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers)}
    return {name: len(held) for name, held in lists.items() if isinstance(held, list)}


def classes():
    """Every class of the add-on that Blender knows."""
    bases = (bpy.types.Operator, bpy.types.Panel, bpy.types.PropertyGroup, bpy.types.UIList, bpy.types.AddonPreferences)
    return sorted(
        found.__name__
        for base in bases
        for found in base.__subclasses__()
        if found.is_registered and MODULE in found.__module__
    )


def installed(extensions):
    """What of Thenar lies in the extension folder."""
    return sorted(path.name for path in extensions.rglob("thenar*") if ".cache" not in path.parts)


def live(zip_path):
    import addon_utils  # on the path only once bpy is loaded

    extensions = Path(bpy.utils.user_resource("EXTENSIONS"))
    addon_utils.enable("bl_pkg")
    before = handlers()
    bpy.ops.extensions.package_install_files(filepath=zip_path, repo="user_default", enable_on_install=True)
    lives = []
    for _ in range(3):
        addon_utils.enable(MODULE)
        on = {
            "enabled": addon_utils.check(MODULE)[1],
            "classes": classes(),
            "scene": hasattr(bpy.context.scene, "thenar"),
        }
        addon_utils.disable(MODULE)
        off = {"classes": classes(), "scene": hasattr(bpy.context.scene, "thenar"), "handlers": handlers() == before}
        lives.append({"on": on, "off": off})
    there = installed(extensions)
    repos = bpy.context.preferences.extensions.repos
    index = [repo.module for repo in repos].index("user_default")
    bpy.ops.extensions.package_uninstall(repo_index=index, pkg_id="thenar")
    return {"lives": lives, "there": there, "left": installed(extensions)}


print("RESULT " + json.dumps(live(sys.argv[1])), flush=True)
