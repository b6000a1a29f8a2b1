"""How far Thenar's layer is from the finite elements where nothing is planted: the mismatch that every null carries."""

import numpy as np
import thenar
from proof import pressing
from trial import pads, studies

SQUARE = 6  # raster cells a side over which pressures are compared: 2.4 mm
SPACING_MM = 0.7  # of the layer's vertices: its own error is then small beside the mismatch


def mismatch(pad):
    """(largest, rms) difference of mean pressures over the largest pressure, one modulus refitted to each frame."""
    shape = studies.Pad(pad, 1.0)
    found = []
    for tool in ("plate", "rod"):
        truth = studies.table()[f"{pad}/{tool}/pressure_mpa"].astype(float)
        for frame, index in zip(truth, pads.MAPPED, strict=True):
            model = _squares(_pressed(shape, tool, pads.STRAINS[index] * shape.thickness))
            frame = _squares(frame)
            off = (frame - model * (frame * model).sum() / (model**2).sum()) / frame.max()
            found.append((np.abs(off).max(), np.sqrt((off[frame > 0.0] ** 2).mean())))
    return np.max(found, axis=0)


def _pressed(shape, tool, depth):
    """Pressure raster of the layer under a tool."""
    vertices, triangles = shape.surface(SPACING_MM)
    material = pressing.material(pads.SHEAR_MPA, shape.thickness)
    product = pressing.plate_over(-depth) if tool == "plate" else pressing.cylinder_over(-depth, shape.rod_radius)
    contact = thenar.Skin(vertices, triangles, materials=[material]).press(*product)
    place = vertices + contact.displacement_mm
    if tool == "rod":
        arc = shape.rod_radius * np.arctan2(place[:, 0], shape.rod_radius - depth - place[:, 2])
        place[:, 0] = arc
    return _raster(place, triangles, np.asarray(contact.force_n))


def _raster(place, triangles, force):
    """Nodal forces spread over their triangles, per raster cell, MPa."""
    corners = place[triangles]
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(doubled, axis=1) / 2.0
    nodal = np.zeros(len(place))
    np.add.at(nodal, triangles.ravel(), np.repeat(area / 3.0, 3))
    pressure = np.divide(force, nodal, out=np.zeros_like(force), where=force > 0.0)
    u, v = (np.mgrid[0:8, 0:8].reshape(2, -1) + 0.5) / 8.0
    share = np.stack([1.0 - np.sqrt(u), np.sqrt(u) * (1.0 - v), np.sqrt(u) * v])  # even over a triangle
    points = np.einsum("tai,as->tsi", corners, share).reshape(-1, 3)
    push = (pressure[triangles] @ share).ravel() * np.repeat(area / 64.0, 64)
    edges = (np.arange(pads.RASTER_CELLS + 1) - pads.RASTER_CELLS / 2) * pads.RASTER_MM
    total = np.histogram2d(points[:, 1], points[:, 0], bins=(edges, edges), weights=push)[0]
    return total * force.sum() / push.sum() / pads.RASTER_MM**2


def _squares(raster):
    """Means over squares of SQUARE cells."""
    count = pads.RASTER_CELLS // SQUARE
    rim = (pads.RASTER_CELLS - count * SQUARE) // 2
    inner = raster[rim : rim + count * SQUARE, rim : rim + count * SQUARE]
    return inner.reshape(count, SQUARE, count, SQUARE).mean(axis=(1, 3))


def main():
    """Prints the table of the README."""
    for pad in pads.PADS:
        worst, rms = mismatch(pad)
        print(f"{pad:8s} rms {100 * rms:4.1f} %  largest {100 * worst:4.1f} % of the largest pressure")


if __name__ == "__main__":
    main()
