"""`python -m thenar_blender`: the command line with the bpy module in place of a Blender program."""

import os
import shutil
import sys
import traceback
from pathlib import Path

import bpy


def run():
    """Start from factory settings, register, run, unregister. Returns the exit code."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    package = sys.modules[__package__]
    package.register()
    try:
        from .terminal import command_line

        return command_line.main(sys.argv[1:])
    finally:
        package.unregister()


def leave(code):
    """End the process with this code, without bpy's own teardown: it may hang for good (4.5), all work done."""
    sys.stdout.flush()
    sys.stderr.flush()
    session = Path(bpy.app.tempdir)
    if session.name.startswith("blender_"):  # otherwise bpy made no folder of its own, and this is the system's
        shutil.rmtree(session, ignore_errors=True)
    os._exit(code)


if __name__ == "__main__":
    try:
        code = run()
    except BaseException:
        traceback.print_exc()
        code = 1
    leave(code)
