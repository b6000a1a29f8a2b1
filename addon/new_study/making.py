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
    contacts = sorted(((_contact_mm(state, item), item.name) for item in state.files), key=lambda each: each[0])
    (least, smallest), (most, largest) = contacts[0], contacts[-1]
    if most > skins.LARGEST_MM:
        raise Refusal(
            f"the tool of '{largest}' touches a radius of about {most:.3g} mm, more than the "
            f"{skins.LARGEST_MM:.0f} mm that the flat piece of skin allows; check its diameter and the depth's unit, "
            "or give a larger mesh in study.toml"
        )
    if not skins.fits(least, most):
        raise Refusal(
            f"the contact of '{smallest}' (radius about {least:.2g} mm) is too small next to that of '{largest}' "
            f"({most:.2g} mm) for one piece of skin; check the unit of the depth and the diameters, "
            "or make a study of each"
        )
    return skins.flat((least, most), state.thickness_mm)


def _contact_mm(state, item):
    """Radius of contact, mm: of a ball on a half-space by Hertz, at most its own; at least a micrometer."""
    tool = state.protocols[item.protocol - 1]
    radius = 0.5 * tool.diameter_mm
    return max(1e-3, radius if tool.shape == "PUNCH" else min(radius, np.sqrt(radius * item.reach_mm)))


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
