"""How the proof calls Thenar: plain materials, and products that come from above onto a skin facing +z."""

import numpy as np
import thenar

from proof import meshes

SHEAR_MODULUS = 0.02  # MPa
CONTACT_MODULUS = 4.0 * SHEAR_MODULUS  # E* = 2 G / (1 - nu) at nu = 1/2


def material(shear_modulus=SHEAR_MODULUS, thickness=np.inf, swelling=(0.0, 8.0, 2.0)):
    """One modulus at every depth."""
    return thenar.Material(
        g0_mpa=shear_modulus, g_lim_mpa=shear_modulus, d_lim_mm=4.0, thickness_mm=thickness, swelling=swelling
    )


def press(skin, product, materials=None, model="layer", **more):
    """Presses mesh `product` into mesh `skin`, one region unless `regions` is given."""
    regions = more.pop("regions", None)
    prepared = thenar.Skin(*skin, regions=regions, materials=materials or [material()], model=model)
    return prepared.press(*product, **more)


def sphere_on_flat(radius, depth, spacing, seed=1, extent=1.7):
    """(skin, product): a jittered flat skin and a sphere sunk into it by `depth`, its facets too fine to matter."""
    reach = np.sqrt(2.0 * radius * depth)
    skin = meshes.disc_patch(max(extent * reach, 3.0 * spacing), spacing, 0.15, seed)
    fine = max(reach / 45.0, 0.01)
    return skin, meshes.sphere(radius, (0.0, 0.0, radius - depth), 1.25 * reach, fine)


def fingertip(count=1500):
    """An ellipsoid fingertip whose pad faces +z."""
    return meshes.ellipsoid((8.0, 12.0, 7.0), count)


def plate_over(height, half=40.0, thick=30.0):
    """A thick plate whose lower face lies at z = height."""
    return meshes.box((-half, -half, height), (half, half, height + thick))


def cylinder_over(height, radius=24.0, length=80.0, segments=256, rings=3):
    """A cylinder along y whose lowest line lies at z = height."""
    vertices, triangles = meshes.cylinder(radius, length, segments, rings)
    vertices = vertices @ meshes.rotation((1.0, 0.0, 0.0), np.pi / 2.0).T
    return vertices + np.array([0.0, 0.0, height + radius]), triangles


def written(skin, contact):
    """The deformed skin."""
    return skin[0] + contact.displacement_mm


def relative(value, expected):
    """Signed relative deviation."""
    return float(value / expected - 1.0)
