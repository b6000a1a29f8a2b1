"""Writes a new study: study.toml as its format documents it, and the skin, next to the recordings. Loads nothing."""

import json
import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .. import native
from ..scene.checks import Refusal

STUDY, SKIN, REGIONS = OWN = "study.toml", "study_skin.ply", "study_regions.csv"
"""Names of the files that a study is written to."""


@dataclass(frozen=True)
class Press:
    """One recording: its name, file, run, (key, header) pairs of its columns, and number of its protocol from 0."""

    name: str
    file: str
    run: str
    columns: tuple
    protocol: int


@dataclass(frozen=True)
class Tool:
    """What pressed in one protocol: the protocol's name, a shape of the study format, its diameter and axis."""

    protocol: str
    shape: str
    diameter_mm: float
    axis: np.ndarray


def in_the_way(folder, has_regions=True):
    """Names of the files that writing a study there would replace."""
    wanted = (STUDY, SKIN, *((REGIONS,) if has_regions else ()))
    return [name for name in wanted if (Path(folder) / name).exists()]


def write(folder, texts, replaces):
    """Write the files (text by name) all or none, and have the library read the study. Returns it.

    Raises `Refusal` without consent to replace, where the folder cannot be written, or where the study is refused; the
    folder is then as it was.
    """
    folder = Path(folder)
    there = [name for name in texts if (folder / name).exists()]
    if there and not replaces:
        if len(there) == 1:
            raise Refusal(
                f"{_listed(there)} is in '{folder}' already; "
                "tick Replace them, or copy the recordings into a folder of their own"
            )
        raise Refusal(
            f"{_listed(there)} are in '{folder}' already; "
            "tick Replace them, or copy the recordings into a folder of their own"
        )
    before = _read(folder, there)
    parts = {folder / name: folder / f".{name}.part" for name in texts}
    done = []
    try:
        for path, part in parts.items():
            part.write_bytes(texts[path.name].encode())
        for path, part in parts.items():
            os.replace(part, path)
            done.append(path.name)
        return native.module.Study.load(folder)
    except (OSError, *native.error_types()) as error:
        lost = _restore(folder, done, before)
        if isinstance(error, OSError):
            raise Refusal(
                f"'{folder}' cannot be written ({error.strerror or error}); copy the recordings to a folder of your own"
                + lost
            ) from None
        if lost:
            raise Refusal(f"{error}{lost}") from None
        raise
    finally:
        for part in parts.values():
            _remove(part)


def _read(folder, names):
    """The bytes of files that would be replaced, by name."""
    before = {}
    for name in names:
        try:
            before[name] = (folder / name).read_bytes()
        except OSError as error:
            raise Refusal(
                f"'{name}' in '{folder}' cannot be read ({error.strerror or error}), so it is not replaced; "
                "move it elsewhere, or copy the recordings into a folder of their own"
            ) from None
    return before


def _restore(folder, names, before):
    """Put back what stood there, each file whole. Returns which could not be, as the end of a sentence."""
    lost = []
    for name in names:
        part = folder / f".{name}.part"
        try:
            if name in before:
                part.write_bytes(before[name])
                os.replace(part, folder / name)
            else:
                (folder / name).unlink(missing_ok=True)
        except OSError:
            lost.append(name)
    return f"; {_listed(lost)} could not be put back as before" if lost else ""


def _remove(path):
    """Remove a file if it is there and can be removed."""
    with suppress(OSError):
        path.unlink(missing_ok=True)


def texts(title, skin, tools, presses):
    """The study's files as text by name. `tools` by protocol number. Raises `Refusal` for a region's odd name."""
    if skin.regions is not None:
        _check_names(skin.materials)
    out = {STUDY: _study(title, skin, tools, presses), SKIN: _ply(skin)}
    if skin.regions is not None:
        rows = [f"{number},{name or -1}" for number, name in enumerate(skin.regions)]
        out[REGIONS] = "\n".join(["vertex,region", *rows, ""])
    return out


def _check_names(regions):
    """The library parts rows of regions at commas, takes blanks off, and reads `none` as no skin."""
    for name in regions:
        if "," in name or name != name.strip() or not name.isprintable() or name in {"", "-1", "none"}:
            raise Refusal(
                f"the region '{name}' cannot be written to {REGIONS}: a name there is not none or -1, "
                "and has no comma and no blank at its ends; rename the region under Materials"
            )


def _study(title, skin, tools, presses):
    lines = ["[study]", f"title = {_text(title)}", "", "[skin]", f"mesh = {_text(SKIN)}"]
    if skin.regions is not None:
        lines.append(f"regions = {_text(REGIONS)}")
    for region, numbers in skin.materials.items():
        lines += ["", f"[skin.materials.{_text(region)}]  # where the fit starts"]
        lines += [f"{name} = {_number(value)}" for name, value in numbers.items()]
    kinds = list(dict.fromkeys(_key(tools[press.protocol]) for press in presses))
    called = {key: _called(key, kinds) for key in kinds}
    for key in kinds:
        lines += ["", f"[indenters.{_text(called[key])}]", f"shape = {_text(key[0])}"]
        if key[0] != "plane":
            lines.append(f"radius_mm = {_number(0.5 * key[1])}")
        if key[0] == "cylinder":
            lines.append(f"axis = {_vector(key[2])}")
    lines += ["", f"[sites.{_text(skin.site)}]", f"point_mm = {_vector(skin.point_mm)}"]
    lines.append(f"direction = {_vector(skin.direction)}")
    for press in presses:
        tool = tools[press.protocol]
        lines += ["", "[[recordings]]", f"name = {_text(press.name)}", 'kind = "indentation"']
        lines.append(f"file = {_text(press.file)}")
        if press.run:
            lines.append(f"run = {_text(press.run)}")
        lines += [f"indenter = {_text(called[_key(tool)])}", f"site = {_text(skin.site)}"]
        lines.append(f"protocol = {_text(tool.protocol)}")
        if press.columns:
            lines += ["", "[recordings.columns]"]
            lines += [f"{key} = {_text(header)}" for key, header in press.columns]
    return "\n".join([*lines, ""])


def _key(tool):
    """What makes a tool another one."""
    size = 0.0 if tool.shape == "plane" else tool.diameter_mm
    return tool.shape, size, tuple(tool.axis) if tool.shape == "cylinder" else ()


def _called(key, kinds):
    name = "flat plate" if key[0] == "plane" else f"{key[0]} {key[1]:.5g} mm"
    alike = [kind for kind in kinds if kind[:2] == key[:2]]
    return name if len(alike) == 1 else f"{name} ({alike.index(key) + 1})"


def _ply(skin):
    lines = ["ply", "format ascii 1.0", f"element vertex {len(skin.vertices_mm)}"]
    lines += [f"property double {axis}" for axis in "xyz"]
    lines += [f"element face {len(skin.triangles)}", "property list uchar int vertex_indices", "end_header"]
    lines += [f"{x:.5f} {y:.5f} {z:.5f}" for x, y, z in skin.vertices_mm.tolist()]
    lines += [f"3 {a} {b} {c}" for a, b, c in skin.triangles.tolist()]
    return "\n".join([*lines, ""])


def _text(value):
    """A basic string of TOML; JSON escapes the same letters, but for the one that is deleted here."""
    return json.dumps(value.replace("\x7f", ""), ensure_ascii=False)


def _number(value):
    return '"inf"' if np.isinf(value) else repr(float(f"{value:.7g}"))


def _vector(values):
    return "[" + ", ".join(repr(round(float(value), 6) + 0.0) for value in values) + "]"


def _listed(names):
    return " and ".join(f"'{name}'" for name in names)
