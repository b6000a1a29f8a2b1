"""What panels show of the pose library."""

from . import library


def draw_button(layout, context):
    """The button that adds the library, while it is not there."""
    if library.registered(context) is None:
        layout.operator("thenar.add_pose_library", icon="ASSET_MANAGER")
