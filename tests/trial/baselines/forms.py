"""The catalogue as simple closed forms on force curves, for the curve fitter: how each effect changes a force.

Layer factors are Dimitriadis et al. 2002 (bonded layer, Eq. 8); the hysteresis is Dahl's 1968; relaxation is one
exponential in a hereditary integral over the elastic force, drainage the same with a time that grows with the contact's
area. Every form does nothing at amplitude zero. Effects that curves on one site do not show (inclusion, friction,
region_coupling, crosstalk, misregistration) are not in it.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import expit

TIMES_S = (0.1, 1.0, 5.0)
SPREAD = (0.25, 1.0, 4.0)  # of the times of a relaxation
# Hu et al. 2010, sphere on a poroelastic half space: 0.491 exp(-0.908 sqrt(x)) + 0.509 exp(-1.679 x), the first term as
# exponentials (rate, share; within 0.02).
MASTER = ((1.679, 0.509), (0.08, 0.06), (0.45, 0.223), (3.0, 0.139), (30.0, 0.069))
SHORTEST_S = 0.04  # so that no recording lasts more than 700 of it


@dataclass(frozen=True)
class Form:
    """An effect: its function, bounds of amplitude and number, where fits begin, at which stage it acts."""

    act: object
    low: tuple
    high: tuple
    starts: tuple
    stage: int


@dataclass
class Motion:
    """What of the recordings does not change in a fit: (recordings, samples), and the order of each."""

    time: np.ndarray
    depth: np.ndarray
    radius: np.ndarray
    order: np.ndarray
    thickness: float
    scale: float

    @classmethod
    def of(cls, curves):
        """Padded samples repeat the last one, so that nothing happens there."""
        time, depth = (_filled(table) for table in (curves.time, curves.depth))
        return cls(time, depth, curves.radii[:, None], curves.orders, curves.thickness, float(curves.scale().max()))

    def strain(self):
        """Contact radius over the tool's."""
        return np.sqrt(np.maximum(self.depth, 0.0) / self.radius)


def layer(motion, thickness, poisson):
    """Force on a bonded layer over that on a half space of the same shear modulus with Poisson's ratio 1/2."""
    nu, chi = poisson, np.sqrt(motion.radius * np.maximum(motion.depth, 0.0)) / thickness
    a = -(1.2876 - 1.4678 * nu + 1.3442 * nu**2) / (1.0 - nu) / np.pi
    b = (0.6387 - 1.0277 * nu + 1.5164 * nu**2) / (1.0 - nu) / np.pi
    series = 1.0 - 2.0 * a * chi + 4.0 * a**2 * chi**2 - 8.0 * (a**3 + 4.0 / 15.0 * b) * chi**3
    series = series + 16.0 * a * (a**3 + 0.6 * b) * chi**4
    return series * 0.5 / (1.0 - nu)


def bone(force, motion, p):
    return force * layer(motion, motion.thickness * np.exp(p[0]), 0.5) / layer(motion, motion.thickness, 0.5)


def compressibility(force, motion, p):
    return force * layer(motion, motion.thickness, 0.5 - p[0]) / layer(motion, motion.thickness, 0.5)


def stiff_skin(force, motion, p):
    reach = np.sqrt(motion.radius * np.maximum(motion.depth, 1e-4))
    return force * (1.0 + p[0] / reach)


def stiffening_law(force, motion, p):
    return force * np.exp(p[0] * motion.strain())


def relaxation(force, motion, p):
    parts = (_faded(force, motion.time, np.exp(p[1]) * factor) for factor in SPREAD)
    return np.maximum(force - p[0] * sum(parts) / len(SPREAD), 0.0)  # the skin lags behind a tool that leaves


def drainage(force, motion, p):
    area = motion.radius[:, 0] * motion.depth.max(axis=1)
    parts = (share * _faded(force, motion.time, np.exp(p[1]) * area / rate) for rate, share in MASTER)
    return np.maximum(force - p[0] * sum(parts), 0.0)


def cycle_softening(force, motion, p):
    into = np.maximum(np.diff(np.maximum(motion.depth, 0.0), axis=1, prepend=0.0), 0.0)
    return force * (1.0 - p[0] * (1.0 - np.exp(-np.cumsum(into, axis=1) / np.exp(p[1]))))


def rate_independent_loss(force, motion, p):
    step = np.diff(np.maximum(motion.depth, 0.0), axis=1, prepend=0.0)
    state, out = np.zeros(len(step)), np.zeros_like(step)
    for k in range(step.shape[1]):
        sign = np.sign(step[:, k])
        state = np.where(sign == 0.0, state, sign + (state - sign) * np.exp(-np.abs(step[:, k]) / np.exp(p[1])))
        out[:, k] = state
    return force * (1.0 + 0.5 * p[0] * (out - 1.0))


def adhesion(force, motion, p):
    """On the way out and above the skin, a tension as large as the tool's radius, until it lets go."""
    deepest = np.maximum(np.maximum.accumulate(motion.depth, axis=1), 1e-6)
    free = 1.0 - np.exp(10.0 * (np.minimum(motion.depth / deepest, 1.0) - 1.0))
    after = np.maximum.accumulate(motion.depth, axis=1) > 0.0
    return force - p[0] * after * free * motion.radius * np.clip(1.0 + motion.depth / np.exp(p[1]), 0.0, 1.0)


def gain(force, motion, p):
    return force * (1.0 + p[0] * (motion.order >= p[1])[:, None])


def offset(force, motion, p):
    return force + p[0] * motion.scale


def drift(force, motion, p):
    return force + p[0] * motion.scale * motion.time


def saturation(force, motion, p):
    ceiling, soft = motion.scale * (1.02 - p[0]), 0.02 * motion.scale
    return force - soft * np.logaddexp(0.0, (force - ceiling) / soft) * (p[0] > 0.0)


def threshold(force, motion, p):
    return force * expit((force / motion.scale - p[0]) / (0.05 * p[0] + 1e-6))


def timing(force, motion, p):
    return np.stack([np.interp(t - p[0], t, f) for t, f in zip(motion.time, force, strict=True)])


def _faded(force, time, tau):
    """What a single exponential has forgotten of a force: its increments, each times 1 - exp(-age / tau)."""
    tau = np.maximum(np.reshape(tau, (-1, 1)), SHORTEST_S)
    age = (time - time[:, :1]) / tau
    middle = np.concatenate([np.zeros((len(age), 1)), 0.5 * (age[:, 1:] + age[:, :-1])], axis=1)
    steps = np.diff(force, axis=1, prepend=force[:, :1])
    return force - force[:, :1] - np.exp(-age) * np.cumsum(np.exp(middle) * steps, axis=1)


def _filled(table):
    """NaN at the ends replaced by the last number before."""
    last = np.isfinite(table).sum(axis=1) - 1
    return np.where(np.isfinite(table), table, np.take_along_axis(table, last[:, None], axis=1))


_SLOW = tuple((0.1, np.log(t)) for t in TIMES_S)
FORMS = {
    "bone": Form(bone, (-1.2,), (0.7,), ((-0.1,),), 0),
    "compressibility": Form(compressibility, (0.0,), (0.25,), ((0.02,),), 0),
    "stiff_skin": Form(stiff_skin, (0.0,), (10.0,), ((0.05,),), 0),
    "stiffening_law": Form(stiffening_law, (-4.0,), (6.0,), ((0.1,),), 1),
    "cycle_softening": Form(cycle_softening, (0.0, -3.0), (0.9, 4.0), ((0.1, 0.0), (0.1, 1.5)), 2),
    "relaxation": Form(relaxation, (0.0, -5.0), (0.95, 4.0), _SLOW, 2),
    "drainage": Form(drainage, (0.0, -8.0), (0.95, 3.0), tuple((0.1, np.log(t / 10.0)) for t in TIMES_S), 2),
    "rate_independent_loss": Form(rate_independent_loss, (0.0, -5.0), (0.9, 1.0), ((0.1, -2.0), (0.1, -0.5)), 2),
    "adhesion": Form(adhesion, (0.0, -5.0), (1.0, 1.0), ((1e-4, -1.0),), 3),
    "gain": Form(gain, (-0.9, 0.0), (2.0, 100.0), (), 4),
    "offset": Form(offset, (-0.5,), (0.5,), ((0.001,),), 4),
    "drift": Form(drift, (-0.1,), (0.1,), ((0.0005,),), 4),
    "saturation": Form(saturation, (0.0,), (0.9,), ((0.05,), (0.3,)), 4),
    "threshold": Form(threshold, (0.0,), (0.3,), ((0.005,), (0.03,)), 4),
    "timing": Form(timing, (-0.2,), (0.5,), ((0.01,),), 4),
}
COMPLIANCE = Form(None, (0.0,), (0.5,), ((0.01,),), -1)  # acts on the depth, before all others; share of the deepest
FORMS["fixture_compliance"] = COMPLIANCE
