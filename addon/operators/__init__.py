"""Operators: check, one workflow call, report."""

import bpy

from .. import status
from ..results import reports
from . import bake, certify, clear, computing, display, effects, export, regions, report, sizing, solve

_MODULES = (solve, certify, clear, display, regions, effects, export, bake, report, sizing)


def register():
    """Register every operator."""
    status.look_changed.append(display.refresh)
    status.comfort_changed.append(display.judge)
    computing.register()
    for module in _MODULES:
        for cls in module.CLASSES:
            bpy.utils.register_class(cls)


def unregister():
    """End what computes, and unregister them again."""
    computing.unregister()
    status.look_changed.remove(display.refresh)
    status.comfort_changed.remove(display.judge)
    for module in reversed(_MODULES):
        for cls in reversed(module.CLASSES):
            bpy.utils.unregister_class(cls)
    reports.forget()
