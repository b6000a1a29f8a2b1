"""Installs and enables the extension zip in the Blender user folder given by BLENDER_USER_RESOURCES."""

import os
import sys

import bpy

MODULE = "bl_ext.user_default.thenar"


def install(zip_path):
    """Whether Blender took the zip and enabled the add-on, and kept that in its preferences."""
    import addon_utils  # on the path only once bpy is loaded

    addon_utils.enable("bl_pkg")
    result = bpy.ops.extensions.package_install_files(filepath=zip_path, repo="user_default", enable_on_install=True)
    _, is_enabled = addon_utils.check(MODULE)
    if result != {"FINISHED"} or not is_enabled:
        print(f"{zip_path} was not installed: {result}, enabled: {is_enabled}", file=sys.stderr)
        return False
    bpy.ops.wm.save_userpref()
    return True


code = 0 if install(sys.argv[1]) else 1
sys.stdout.flush()
sys.stderr.flush()
# Blender 4.5 hangs at exit while an add-on is registered.
os._exit(code)
