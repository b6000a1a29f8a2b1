"""The native contact's arrays as the writer wants them."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import native
from ..scene import write
from ..scene.units import Floats
from ..steps import Cancel, Progress
from . import product_edge, skin_edge

if TYPE_CHECKING:
    from ..native import Contact

_ASKED_MM = 10.0
"""Gaps beyond are not asked for: within two rings of a contact they say nothing of its edge."""


def fields_of(contact: "Contact", job: Any) -> write.Fields:
    """What a contact writes, without its edge; `job` is the `workflow.Job` that it is of."""
    gap = np.asarray(contact.gap_mm)
    return write.Fields(
        displacement_mm=np.asarray(contact.displacement_mm),
        pressure_mpa=np.asarray(contact.pressure_mpa),
        force_n=np.asarray(contact.force_n),
        depth_mm=np.fmax(-gap, 0.0),
        overlap_mm=np.clip(-np.where(np.isnan(gap), np.inf, gap), -skin_edge.REACH_MM, skin_edge.REACH_MM),
        regions=job.reading.hand.regions,
        product_pressure_mpa=np.asarray(contact.product_pressure_mpa),
        offset_mm=offset_mm(contact, job),
        shear=None if contact.friction is None else _shear(contact),
        thickness_mm=job.thickness_mm,
        grip_displacement_mm=contact.grip_displacement_mm,
    )


def edged(
    fields: write.Fields, contact: "Contact", job: Any, cancel: Cancel | None = None, progress: Progress | None = None
) -> write.Fields:
    """The same with the edge of the contact on skin and product; no Blender in it, so that a thread may run it."""
    if progress is not None:
        progress("edge", 0.0)
    fields, hand, product = skin_edged(fields, contact, job, cancel), job.reading.hand, job.reading.product
    places = product.vertices_mm + fields.offset_mm
    if fields.grip_displacement_mm is not None:
        places = places + fields.grip_displacement_mm
    edge = product_edge.signed_distance(
        (hand.posed_mm + fields.displacement_mm, hand.triangles, fields.edge_mm),
        (places, product.triangles, fields.product_pressure_mpa),
        native.module.Product,
    )
    return replace(fields, product_edge_mm=edge)


def skin_edged(fields: write.Fields, contact: "Contact", job: Any, cancel: Cancel | None = None) -> write.Fields:
    """The same with the edge on the skin alone, which takes half as long."""
    hand = job.reading.hand
    pressed = contact.pressed_product or job.product

    def gaps(points: Floats) -> Floats:
        found: Floats = pressed.gap_mm(points - fields.offset_mm, cut_off_mm=_ASKED_MM, cancel=cancel)["gap_mm"]
        return found

    skin = hand.posed_mm + fields.displacement_mm
    edge = skin_edge.signed_distance(skin, hand.triangles, fields.pressure_mpa, gaps)
    return replace(fields, edge_mm=edge)


def offset_mm(contact: "Contact", job: Any) -> Floats:
    """How far the product moved to carry its force (3), world axes, mm; zero without a force target."""
    if job.force_n is None:
        return np.zeros(3)
    return float(contact.offset_mm) * np.asarray(contact.direction, dtype=np.float64)


def _shear(contact: "Contact") -> tuple[Floats, Floats]:
    margin = np.asarray(contact.slip_margin)
    return np.asarray(contact.tangential_traction_mpa), np.where(np.isnan(margin), 1.0, margin)
