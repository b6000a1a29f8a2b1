"""Whether the contact model's drainage foresees what finite elements lose under tools that it was not fitted to.

    python -m trial.finite_elements.drained_layers        (in `tests`)

Numbers of `drainage` are fitted to one recording of a small sphere on each of the second trial's pads, on none of
which a constant of the law was set, and then the recordings of two larger spheres are followed: by the curve of a half
space and by that of a layer. All are loads over those of the same pad without drainage. Prints what is left over hold
and way back, rms, in percent of the peak load.
"""

import numpy as np
import thenar
from proof import pressing
from scipy.optimize import least_squares
from trial import protocols
from trial.drawing import truths

SHEAR_MPA = 0.01
SPACINGS = 9  # mesh spacings in the radius of the contact
FITTED, FOLLOWED = "slow, small sphere", ("large sphere", "wide sphere")
EVALUATIONS = 12
DOWN = (0.0, 0.0, -1.0)
NUMBERS = {"halfspace": ("diffusivity_mm2_per_s",), "layer": ("diffusivity_mm2_per_s", "spread")}
STARTS = {"diffusivity_mm2_per_s": 2.0, "spread": 1.0}
FORMS = (0, 1)


def theirs(pad, name, form, amplitude):
    """Finite elements' loads of a protocol over the largest without drainage, from where the tool has arrived."""
    kept = slice(2 * protocols.STEPS[0], None)
    loads = truths.runs()[f"{pad}/drainage/{form}/{amplitude}/{name}"].astype(float)
    return (loads / truths.runs()[f"{pad}/none/0/0/{name}"].astype(float).max())[kept]


class Followed:
    """A protocol of the trial on a mesh of the contact model."""

    def __init__(self, pad, name):
        thickness, radius = protocols.PADS[pad][1], protocols.radius(pad, protocols.PROTOCOLS[name].tool)
        depth = protocols.depth(pad)
        self.contact_mm = np.sqrt(radius * depth)
        skin, product = pressing.sphere_on_flat(radius, depth, self.contact_mm / SPACINGS)
        # `sphere_on_flat` has it sunk in; offsets begin where it touches.
        self.product = (product[0] + np.array([0.0, 0.0, depth]), product[1])
        self.skin = thenar.Skin(*skin, materials=[pressing.material(SHEAR_MPA, thickness)])
        self.course = protocols.course(pad, name, protocols.STEPS)
        self.most = self._loads([]).max()

    def _loads(self, effects):
        protocol = {"time_s": self.course[:, 0], "offset_mm": self.course[:, 1]}
        return self.skin.run(protocol, *self.product, direction=DOWN, effects=effects).force_n

    def loads(self, curve, amplitude, radius_mm, numbers):
        """Loads over the largest without drainage, from where the tool has arrived."""
        shape = dict(zip(NUMBERS[curve], numbers, strict=True))
        effect = thenar.Effect("drainage", amplitude, curve=curve, radius_mm=radius_mm, **shape)
        return self._loads([effect])[2 * protocols.STEPS[0] :] / self.most


def fitted(small, wanted, curve):
    """(amplitude, numbers) with which a curve follows the small sphere best."""

    def residual(x):
        return small.loads(curve, x[0], small.contact_mm, np.exp(x[1:])) - wanted

    start = [0.6, *np.log([STARTS[name] for name in NUMBERS[curve]])]
    most = [1.0, *[np.log(20.0 if name.startswith("diff") else 3.0) for name in NUMBERS[curve]]]
    least = [0.02, *[np.log(0.02 if name.startswith("diff") else 0.3) for name in NUMBERS[curve]]]
    fit = least_squares(residual, start, bounds=(least, most), diff_step=0.02, max_nfev=EVALUATIONS)
    return fit.x[0], np.exp(fit.x[1:]), 100.0 * np.sqrt(np.mean(fit.fun**2))


def left(pad, form, amplitude, curve):
    """What is left, in percent of the peak load: under the small sphere, and by larger one."""
    small = Followed(pad, FITTED)
    amount, numbers, fit = fitted(small, theirs(pad, FITTED, form, amplitude), curve)

    def missed(name):
        loads = Followed(pad, name).loads(curve, amount, small.contact_mm, numbers)
        return 100.0 * np.sqrt(np.mean((loads - theirs(pad, name, form, amplitude)) ** 2))

    return fit, [missed(name) for name in FOLLOWED], (amount, *numbers)


def main():
    """Prints the table."""
    for pad in protocols.SECOND:
        for form in FORMS:
            for curve in NUMBERS:
                fit, foreseen, numbers = left(pad, form, 1.0, curve)
                errors = ", ".join(f"{one:.2f} %" for one in foreseen)
                about = f"{pad:13s} form {form} {curve:9s} fitted {fit:.2f} %"
                print(f"{about}, foreseen {errors}  {np.round(numbers, 2)}", flush=True)


if __name__ == "__main__":
    main()
