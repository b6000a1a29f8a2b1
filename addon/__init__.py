"""Thenar: presses a hand against a product and shows the skin's shape, pressure and forces. Registration only."""

from . import (
    curves,
    diagnosis,
    grasp,
    grasp_data,
    hand,
    hand_shape,
    handlers,
    languages,
    live,
    looks,
    new_study,
    operators,
    panels,
    picture_sets,
    pose_library,
    presets,
    product_files,
    recordings,
    refining,
    rigging,
    start,
    tabs,
)
from .grasp_choices import more as more_grasps
from .grasp_targets import operators as grasp_targets
from .properties import settings
from .views import viewport

_MODULES = (
    languages,
    settings,
    tabs,
    operators,
    presets,
    product_files,
    start,
    panels,
    hand,
    rigging,
    grasp,
    more_grasps,
    grasp_targets,
    grasp_data,
    pose_library,
    hand_shape,
    picture_sets,
    recordings,
    curves,
    refining,
    new_study,
    diagnosis,
    looks,
    viewport,
    handlers,
    live,
)


def register():
    """Register everything; where the native module is missing, the panel states the reason."""
    for module in _MODULES:
        module.register()


def unregister():
    """Unregister everything again, in reverse."""
    for module in reversed(_MODULES):
        module.unregister()
