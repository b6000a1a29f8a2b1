"""From the answers to the study: skin, tools and presses are written next to the recordings and loaded."""

from pathlib import Path

import numpy as np

from ..recordings import loading
from ..scene.checks import Refusal
from . import drafting, settings, skins, writing

_SHAPES = {"SPHERE": "sphere", "CYLINDER": "cylinder", "PLANE": "plane", "PUNCH": "punch"}


def make(context):
    """Write the study and load it; the proposal is then closed. Returns its title. Raises `Refusal`, `ThenarError`."""
    drafting.read_again(context)
    problem = drafting.problem(context)
    if problem:
        raise Refusal(problem)
    state = context.scene.thenar_new_study
    skin = _skin(context, state)
    tools = [_tool(protocol, skin) for protocol in state.protocols]
    texts = writing.texts(state.title or "Study", skin, tools, list(_presses(state)))
    folder, title = state.folder, state.title
    writing.write(folder, texts, state.replaces)
    loading.load(context, folder)
    drafting.discard(state)
    return title


def _skin(context, state):
    if state.skin == settings.HAND:
        return skins.of_hand(context, context.scene.thenar.hand, state.site_vertex, state.site_region)
    contacts = []
    for item in state.files:
        tool = state.protocols[item.protocol - 1]
        radius = 0.5 * tool.diameter_mm
        contacts.append(radius if tool.shape == "PUNCH" else min(radius, np.sqrt(radius * item.reach_mm)))
    return skins.flat((max(min(contacts), 1e-3), max(contacts)), state.thickness_mm)


def _tool(protocol, skin):
    """The axis of a cylinder lies across the direction of travel, from the skin's y axis on turned about it."""
    inward = skin.direction
    along = np.array([0.0, 1.0, 0.0]) if abs(inward[1]) < 0.9 else np.array([1.0, 0.0, 0.0])
    along = along - inward * (along @ inward)
    along /= np.linalg.norm(along)
    angle = np.radians(protocol.turn_deg)
    axis = np.cos(angle) * along + np.sin(angle) * np.cross(inward, along)
    diameter = float(f"{protocol.diameter_mm:.6g}")  # Blender keeps single precision
    return writing.Tool(protocol.name, _SHAPES[protocol.shape], diameter, axis)


def _presses(state):
    """Recordings in the order of the list; repeats are numbered within their protocol."""
    counts = {}
    for item in state.files:
        counts[item.protocol] = counts.get(item.protocol, 0) + 1
        name = f"{state.protocols[item.protocol - 1].name}, repeat {counts[item.protocol]}"
        columns = tuple(drafting.columns_of(state, item))
        yield writing.Press(name, Path(item.path).name, item.run, columns, item.protocol - 1)
