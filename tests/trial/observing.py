"""What a recording makes of a force: instruments that err, skin that does what no list holds, scatter, noise.

Every distortion takes a case's `Press`es in their order and an amplitude, and changes them in place; at zero it does
nothing. Those of an instrument bear the names of the findings. Their forms are this file's own.
"""

from dataclasses import dataclass

import numpy as np

CORRELATION_S = 0.15
SLOWER = 4.0  # memory of slow noise


@dataclass
class Press:
    """One recording: times (s), true and stated depths (mm), force (N)."""

    protocol: str
    repeat: int
    order: int
    time: np.ndarray
    depth: np.ndarray
    stated: np.ndarray
    force: np.ndarray

    def touching(self):
        """Where the tool is in the skin."""
        return self.depth > 0.0


def gain(presses, amplitude, random):
    """From the middle of the session on, the amplifier reads more (or less)."""
    sign = random.choice([-1.0, 1.0])
    for press in presses:
        if press.order >= len(presses) // 2:
            press.force *= 1.0 + sign * amplitude


def offset(presses, amplitude, random):
    """The amplifier's zero is off: the same share of the session's largest force everywhere."""
    shift = random.choice([-1.0, 1.0]) * amplitude * largest(presses)
    for press in presses:
        press.force += shift


def drift(presses, amplitude, random):
    """The zero creeps from the moment when each recording starts, contact or not, slower and slower."""
    rate = random.choice([-1.0, 1.0]) * amplitude * largest(presses) * 0.5
    for press in presses:
        press.force += rate * np.log1p(press.time / 4.0)


def saturation(presses, amplitude, random):
    """The amplifier bends over near its ceiling, the same for all."""
    ceiling = largest(presses) * (1.0 - 0.75 * amplitude)
    for press in presses:
        above = np.maximum(press.force - ceiling, 0.0) / (0.03 * ceiling)
        press.force = np.minimum(press.force, ceiling * (1.03 - 0.03 * np.exp(-above)))


def threshold(presses, amplitude, random):
    """The sensor is blind below a force."""
    least = amplitude * 0.6 * min(press.force.max() for press in presses)
    for press in presses:
        press.force = np.where(press.force < least, 0.0, press.force)


def fixture_compliance(presses, amplitude, random):
    """The frame yields to the force, so the stage has moved further than the tool."""
    yielding = 0.4 * amplitude * max(press.depth.max() for press in presses) / largest(presses)
    for press in presses:
        press.stated = press.stated + yielding * np.maximum(press.force, 0.0)


def timing(presses, amplitude, random):
    """The force is stamped later than the depth."""
    for press in presses:
        press.force = np.interp(press.time - 0.25 * amplitude, press.time, press.force)


def pulse(presses, amplitude, random):
    """The heart beats under the tool, in step with nothing."""
    for press in presses:
        beat = np.sin(2.0 * np.pi * 1.2 * press.time + random.uniform(0.0, 6.28))
        press.force = press.force * (1.0 + 0.5 * amplitude * beat)


def tone(presses, amplitude, random):
    """Muscles under the skin tense and let go over seconds, each time in another way."""
    for press in presses:
        wander = np.zeros(len(press.time))
        for period in (2.5, 4.1, 7.3):
            wander += random.standard_normal() * np.sin(2.0 * np.pi * press.time / period + random.uniform(0.0, 6.28))
        press.force = press.force * (1.0 + 0.25 * amplitude * wander)


def blister(presses, amplitude, random):
    """A pocket gives way at some force of the tool, in every press anew, and closes when it is gone."""
    for press in presses:
        at = 0.55 * press.depth.max()
        press.force = press.force * (1.0 - 0.6 * amplitude / (1.0 + np.exp(-(press.depth - at) / 0.012)))


INSTRUMENT = {one.__name__: one for one in (gain, offset, drift, saturation, threshold, fixture_compliance, timing)}
UNLISTED = {one.__name__: one for one in (pulse, tone, blister)}


def largest(presses):
    """Force of all, N."""
    return max(press.force.max() for press in presses)


def scatter(presses, random, gain_share, zero_mm):
    """Repeats differ: the skin's stiffness of the moment, the judged first touch."""
    for press in presses:
        press.force = press.force * (1.0 + gain_share * random.standard_normal())
        press.stated = press.stated + zero_mm * random.standard_normal()


def disturb(presses, random, noise, kind):
    """Colored noise, a share of each recording's largest force; of `kind` normal, outliers or slow."""
    memory = SLOWER * CORRELATION_S if kind == "slow" else CORRELATION_S
    for press in presses:
        keep = np.exp(-np.diff(press.time, prepend=press.time[0]) / memory)
        white = random.standard_normal(len(press.time))
        for k in range(1, len(white)):
            white[k] = keep[k] * white[k - 1] + np.sqrt(1.0 - keep[k] ** 2) * white[k]
        if kind == "outliers":
            white = white + 6.0 * (random.random(len(white)) < 0.01) * random.standard_normal(len(white))
        press.force = press.force + noise * press.force.max() * white
