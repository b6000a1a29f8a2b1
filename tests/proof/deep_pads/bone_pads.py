"""Pads of a hand, half an ellipsoid of skin over half an ellipsoid of bone, facing +z, and tools that press them."""

import numpy as np
import thenar
from proof import meshes, pressing

SHEAR_MPA = 0.01
CYLINDER_MM = 24.0
SPHERE_MM = 12.0


def skin(semi_axes, spacing):
    """(vertices, triangles) of the upper half, vertices about `spacing` mm apart."""
    a = np.asarray(semi_axes, dtype=float)
    pairs = (a[[0, 0, 1]] * a[[1, 2, 2]]) ** 1.6
    area = 4.0 * np.pi * (pairs.mean()) ** (1.0 / 1.6)
    vertices, triangles = meshes.ellipsoid(tuple(a), int(area / (0.866 * spacing**2)))
    return meshes.keep_triangles(vertices, triangles, vertices[triangles][:, :, 2].mean(axis=1) > 0.0)


def tool(name, height):
    """A rigid tool whose lowest point lies at z = `height`: plate, cylinder across the finger, or sphere."""
    if name == "plate":
        return pressing.plate_over(height, half=60.0)
    if name == "cylinder":
        return pressing.cylinder_over(height, CYLINDER_MM, length=120.0, segments=512)
    return meshes.sphere(SPHERE_MM, (0.0, 0.0, height + SPHERE_MM), 25.0, 0.3)


def material(bone, thickness, stiffening=0.0, shear_mpa=SHEAR_MPA):
    """Tissue of that thickness over a bone of those semi-axes, mm."""
    return thenar.Material(
        g0_mpa=shear_mpa,
        g_lim_mpa=shear_mpa,
        thickness_mm=thickness,
        stiffening=stiffening,
        bone_half_width_mm=bone[1],
        bone_half_length_mm=bone[0],
    )


def layer(axes, tissue, presses, spacing):
    """Contacts of the layer model: `presses` are (tool, depth mm)."""
    prepared = thenar.Skin(*skin(axes, spacing), materials=tissue)
    return [prepared.press(*tool(name, axes[2] - depth)) for name, depth in presses]


def solid(axes, bone, presses, stiffening=0.0, spacing=2.5):
    """Contacts of the reference solve of the same pad, held in the plane below."""
    vertices, triangles = skin(axes, spacing)
    used, triangles = np.unique(triangles, return_inverse=True)
    vertices, triangles = vertices[used], triangles.reshape(-1, 3)
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    rim, count = np.unique(edges, axis=0, return_counts=True)
    held = np.isin(np.arange(len(vertices)), rim[count == 1])
    ones = np.ones(len(vertices))
    under = vertices / np.asarray(axes) * np.asarray(bone)
    return [
        thenar.reference_press(
            vertices,
            triangles,
            under,
            SHEAR_MPA * ones,
            *tool(name, axes[2] - depth),
            held=held.tolist(),
            stiffening=stiffening * ones,
        )
        for name, depth in presses
    ]
