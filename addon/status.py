"""What panels and handlers say about the moment: native module, run under way, results out of date. Nothing lasts."""

import platform
import sys
from collections.abc import Callable
from typing import Any


class Run:
    """The solve under way: `stage` (empty when none runs), `fraction` done, and the text last `shown` of them."""

    stage = ""
    fraction = 0.0
    shown = ""


class Following:
    """How Live gets on in a scene: updates a second, milliseconds each, and why it does not follow, if so."""

    rate = 0.0
    ms = 0.0
    problem = ""


run = Run()
last_error = ""
"""The last sentence that a button reported as an error, for a bug report."""
native_problem = ""
"""Why the native module cannot be used, as one sentence; empty if it can."""
look_changed: list[Callable[[Any], object]] = []
"""Called with the context after range, colours or legend were changed."""
map_changed: list[Callable[[Any], object]] = []
"""Called with the context after a map was shown, hidden or brought up to date."""
comfort_changed: list[Callable[[Any], object]] = []
"""Called with the context after the threshold of comfort was changed."""
live_switched: list[Callable[[Any], object]] = []
"""Called with the context after Live was switched on or off."""
live: dict[str, Following] = {}
"""What Live tells of each scene, by its name: a `Following`."""
_stale: dict[str, bool] = {}


def where() -> str:
    """Platform and Python, for a report."""
    return f"{platform.system()} {platform.machine()}, Python {sys.version.split()[0]}"


def set_native_problem(text: str) -> None:
    """Remember why the native module cannot be used."""
    global native_problem
    native_problem = text


def set_last_error(text: str) -> None:
    """Remember what a button reported as an error."""
    global last_error
    last_error = text


def set_stale(scene_name: str, stale: bool) -> None:
    """Remember whether the result of the scene of that name is out of date."""
    _stale[scene_name] = bool(stale)


def is_stale(scene_name: str) -> bool:
    """Whether the result of that scene was last seen out of date."""
    return _stale.get(scene_name, False)


def forget() -> None:
    """Drop what is known of results."""
    _stale.clear()
