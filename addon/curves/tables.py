"""What there is to draw: columns over the frames of the bake that plays, or of the recording that is chosen."""

import json
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ..languages import iface
from ..ownership import own
from ..recordings import settings as recordings
from ..scene import baked

BAKE, RECORDING = "BAKE", "RECORDING"


@dataclass(frozen=True)
class Column:
    """One quantity over the frames: a `title`, in the user's language, and `unit` to show, and `values` (k,)."""

    title: str
    unit: str
    values: np.ndarray

    def said(self, row):
        """The value of a row with its unit."""
        value = float(self.values[row])
        text = f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.3g}"
        return f"{text} {self.unit}".strip()


@dataclass(frozen=True)
class Table:
    """`columns` over `frames` (k,), numbers by which its source counts them; `row` is the one that is shown."""

    source: str
    frames: np.ndarray
    columns: tuple
    row: int

    @property
    def shares(self):
        """Where each frame is between the first (0) and the last (1), (k,)."""
        return (self.frames - self.frames[0]) / max(float(np.ptp(self.frames)), 1e-12)

    def near(self, share):
        """The row that is nearest to a share of the way from the first frame to the last."""
        return int(np.abs(self.shares - share).argmin())


def of(context, source):
    """The table of the bake that plays, or of the chosen recording; None where there is nothing over time."""
    return _of_bake(context.scene) if source == BAKE else _of_recording(context)


def _of_bake(scene):
    hand = scene.thenar.hand
    if hand is None or not hand.thenar.bake_path:
        return None
    found = baked.curves(hand)
    if found is None or len(found["frame"]) < 2:
        return None
    frames = _shown_frames(scene, hand, len(found["frame"]))
    columns = (
        Column(iface("Force"), "N", found["force_n"]),
        Column(iface("Area"), "cm²", np.asarray(found["area_mm2"]) / 100.0),
        Column(iface("Peak"), "kPa", found["peak_kpa"]),
    )
    return Table(BAKE, frames, columns, int(np.abs(frames - scene.frame_current).argmin()))


def _shown_frames(scene, hand, count):
    """The frame of the timeline at which each baked row plays, (count,), as its modifier has it."""
    cache = next((modifier for modifier in own.bake_modifiers(hand) if modifier.show_viewport), None)
    if cache is None or cache.play_mode != "SCENE":
        return hand.thenar.bake.frame_start + np.arange(count)
    stretch = scene.render.frame_map_old / scene.render.frame_map_new
    return (np.arange(count) + cache.frame_start) / (cache.frame_scale * stretch)


def _of_recording(context):
    item = recordings.chosen(context)
    kept = _read(item.curves) if item is not None else None
    if kept is None or len(kept["frame"]) < 2:
        return None
    frames = np.array(kept["frame"])
    if kept["unit"] == "kPa":
        titles, units = (iface("Force"), iface("Area"), iface("Peak")), ("N", "cm²", "kPa")
    else:
        peak = "kPa" if kept["unit"].startswith("kPa") else ""
        titles, units = (iface("Sum"), iface("Cells"), iface("Peak")), ("", "", peak)
    values = (np.array(kept[name]) for name in ("force", "area", "peak"))
    columns = tuple(Column(*each) for each in zip(titles, units, values, strict=True))
    return Table(RECORDING, frames, columns, int(np.abs(frames - item.frame).argmin()))


@lru_cache(maxsize=8)
def _read(text):
    try:
        kept = json.loads(text) if text else None
        return kept if kept is None or kept.keys() >= _PARTS else None
    except (ValueError, AttributeError):
        return None  # text of something else: as none


_PARTS = {"unit", "frame", "force", "area", "peak"}


def sentence(table, row):
    """What a frame reads, for a tooltip."""
    values = ", ".join(f"{column.title} {column.said(row)}" for column in table.columns)
    return iface("Frame {frame}: {values}", frame=f"{table.frames[row]:g}", values=values)
