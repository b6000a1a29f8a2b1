"""`python -m thenar_blender`: the command line with the bpy module in place of a Blender program."""

import sys

import bpy


def run():
    """Start from factory settings, register, run, unregister. Returns the exit code."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    package = sys.modules[__package__]
    package.register()
    try:
        from . import command_line

        return command_line.main(sys.argv[1:])
    finally:
        package.unregister()


if __name__ == "__main__":
    code = run()
    sys.stdout.flush()
    sys.exit(code)
