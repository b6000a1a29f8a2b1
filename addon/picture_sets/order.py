"""What is asked for: which picture, where to, how large; and file names that lie over nobody's file."""

import json
import re
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path

import bpy

from ..scene.checks import Refusal

GRIP, CARD, TURN, UNROLLED = "GRIP_AND_PRINT", "COMFORT_CARD", "TURNTABLE", "UNROLLED"
GLASS, LIVE = "ON_GLASS", "LIVE_FILM"
KINDS = (
    (GRIP, "Grip and Print", "The hand on the product, and the same hand opened with its pressure, in one scale (PNG)"),
    (
        CARD,
        "Comfort Card",
        "One page: product and hand, force, area, peak, and bars by finger; if asked for, hands of the 5th, 50th and "
        "95th percentile next to each other (PNG and PDF)",
    ),
    (
        TURN,
        "Turntable",
        "A film of 4 s in which hand and product turn once, the product drawn clear (MP4; numbered PNG where Blender "
        "has no FFmpeg). 96 frames: takes minutes to an hour",
    ),
    (UNROLLED, "Wrapped and Unrolled", "The product in the hand, and its surface unrolled with the pressure (PNG)"),
    (
        GLASS,
        "On Glass",
        "The hand seen through the product as glass, skin pale where blood is pressed out of it, and the same with its "
        "pressure; for products pressed from one side, as a plate (PNG)",
    ),
    (
        LIVE,
        "Live Film",
        "A film of the scene's animation at its own frame rate, every frame solved, seen through the product drawn "
        "clear, with running numbers (MP4; numbered PNG where Blender has no FFmpeg). Takes minutes to an hour",
    ),
)
SUFFIXES = {
    GRIP: (".png",),
    CARD: (".png", ".pdf"),
    TURN: (".mp4",),
    UNROLLED: (".png",),
    GLASS: (".png",),
    LIVE: (".mp4",),
}
LEAST, MOST = 64, 4320
"""Pixels of a picture's height."""
SAMPLES = 8


@dataclass
class Order:
    """One picture to make: its kind, where to, its height in pixels, and what is said of the result."""

    kind: str
    target: str
    height: int = 1080
    samples: int = SAMPLES
    is_stale: bool = False
    with_percentiles: bool = False
    rate: int = 24
    """Frames a second of a film."""
    scene: str = ""
    frames: int = 48
    """Most frames of a film of the scene's animation."""
    tell: Callable = field(default=lambda stage, share: None)
    """Called with what is under way and how far it is, 0 to 1."""

    @property
    def factor(self):
        """Pixels per unit of a page; a picture is 1080 units high, a card more."""
        return self.height / 1080.0


@dataclass(frozen=True)
class Progress:
    """Part of an order's progress: from where, and how much of it."""

    order: Order
    first: float = 0.0
    span: float = 1.0

    def part(self, number, count, stage="render"):
        """Who is to be called with the share done, 0 to 1, of one of `count` parts."""
        return lambda share: self.order.tell(stage, self.first + self.span * (number + share) / count)


def to_text(order):
    """The order as JSON, without whom to tell."""
    values = asdict(order)
    del values["tell"]
    return json.dumps(values)


def from_text(text):
    """The order of a JSON text."""
    return Order(**json.loads(text))


def no_text():
    """Blender before 4.4 cannot write text into an image."""
    return "" if bpy.app.version >= (4, 4) else "pictures need Blender 4.4 or later, which writes text into images"


def check(order):
    """Refuse what cannot be made. Raises `Refusal`."""
    if no_text():
        raise Refusal(no_text())
    if order.kind not in SUFFIXES:
        raise Refusal(f"there is no picture '{order.kind}'; known: {', '.join(SUFFIXES)}")
    if not LEAST <= order.height <= MOST:
        raise Refusal(f"a picture {order.height} pixels high cannot be made; give {LEAST} to {MOST}")
    if not 1 <= order.rate <= 60:
        raise Refusal(f"a film of {order.rate} frames a second cannot be made; give 1 to 60")
    if order.frames < 2:
        raise Refusal(f"a film of {order.frames} frames cannot be made; give 2 or more")
    suffix = Path(order.target).suffix.lower()
    if suffix not in SUFFIXES[order.kind]:
        raise Refusal(f"'{Path(order.target).name}' has an unknown extension; give {SUFFIXES[order.kind][0]}")


def targets(order):
    """The paths that an order writes."""
    path = Path(order.target)
    return [path.with_name(path.stem + suffix) for suffix in SUFFIXES[order.kind]]


def refuse_to_overwrite(order):
    """Refuse an order whose files exist. Raises `Refusal`."""
    for path in targets(order):
        if path.exists():
            raise Refusal(f"'{path}' exists already; choose another name, or tick Overwrite")


def free_path(folder, kind, product):
    """A path in `folder` named after product and picture, numbered where such a file exists already."""
    words = re.sub(r"[^\w]+", "-", f"{product} {kind}".lower()).strip("-").replace("_", "-")
    number = 1
    while True:
        stem = words if number == 1 else f"{words}-{number}"
        paths = [Path(folder) / f"{stem}{suffix}" for suffix in SUFFIXES[kind]]
        if not any(path.exists() for path in paths):
            return paths[0]
        number += 1
