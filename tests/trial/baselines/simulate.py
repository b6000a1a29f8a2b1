"""Simulates the calibration's protocols with Thenar's own effects: what the classifier learns from (simulated.npz).

    python -m trial.baselines.simulate      (in `tests`)

For every pad of the calibration split and every effect that curves on one site show, in a few shapes, the force at the
recorded samples of every protocol, N, for a modulus of UNIT_MPA.
"""

from pathlib import Path

import numpy as np
import thenar
from proof import meshes
from trial import cases, protocols
from trial.baselines.curves import UNIT_MPA, surface

TABLE = Path(__file__).with_name("simulated.npz")
DOWN = (0.0, 0.0, -1.0)


def shapes(thickness):
    """(effect, its shapes) for a pad."""
    times = [dict(time_1_s=0.3 * t, time_2_s=t, time_3_s=4.0 * t) for t in (0.1, 0.6, 2.0)]
    laws = [dict(law="exponential", measure="strain"), dict(law="power", measure="strain", exponent=1.5)]
    return {
        "none": [{}],
        "relaxation": times,
        "drainage": [dict(diffusivity_mm2_per_s=d) for d in (0.3, 1.5, 6.0)],
        "bone": [dict(thickness_mm=share * thickness) for share in (0.5, 0.7)],
        "stiff_skin": [dict(modulus_mpa=e, thickness_mm=h) for e, h in ((1.0, 0.4), (2.0, 0.8))],
        "stiffening_law": [law | dict(reference_strain=r) for law in laws for r in (0.3, 0.6)],
        "compressibility": [dict(poisson_ratio=nu) for nu in (0.35, 0.44)],
        "adhesion": [dict(work_j_per_m2=w) for w in (0.02, 0.08)],
        "cycle_softening": [dict(travel_mm=t) for t in (0.5, 2.0)],
        "rate_independent_loss": [dict(length_mm=length) for length in (0.1, 0.4)],
    }


AMPLITUDES = {"relaxation": 0.4, "cycle_softening": 0.4, "rate_independent_loss": 0.4}


def simulated():
    """{pad/effect/shape/protocol: forces}."""
    found = {}
    for pad, about in protocols.PADS.items():
        if about[0] != "calibration":
            continue
        skin = thenar.Skin(*surface(cases.skin(pad)), materials=[_material(about[1])])
        for effect, forms in shapes(about[1]).items():
            for number, numbers in enumerate(forms):
                given = [] if effect == "none" else [thenar.Effect(effect, AMPLITUDES.get(effect, 1.0), **numbers)]
                for name in protocols.PROTOCOLS:
                    found[f"{pad}/{effect}/{number}/{name}"] = _pressed(skin, pad, name, given)
    return found


def _material(thickness):
    return thenar.Material(g0_mpa=UNIT_MPA, g_lim_mpa=UNIT_MPA, d_lim_mm=1.0, thickness_mm=thickness)


def _pressed(skin, pad, name, effects):
    """Forces of one protocol."""
    time, depth = protocols.sampled(pad, name)
    radius = protocols.radius(pad, protocols.PROTOCOLS[name].tool)
    reach = min(2.2 * np.sqrt(2.0 * radius * protocols.depth(pad)), 1.4 * radius)
    ball = thenar.Product(*meshes.sphere(radius, (0.0, 0.0, radius), reach, 0.25))
    course = skin.run({"time_s": time, "offset_mm": depth}, ball, direction=DOWN, effects=effects)
    return np.asarray(course.force_n, dtype=np.float32)


if __name__ == "__main__":
    np.savez_compressed(TABLE, **simulated())
