//! Signed distances, and how far is looked for them.

use crate::mesh::triangles::Vec3;

/// How far queries look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GapLimits {
    /// Points outside and farther from the product than this give `None`, mm; infinity for a search in full.
    pub cut_off_mm: f64,
    /// Deepest penetration, mm, to be read through thin walls.
    pub max_depth_mm: f64,
}

/// Signed distance from a point to a product.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// Signed distance, mm, < 0 inside.
    pub distance: f64,
    /// The point of the product it is measured to, mm.
    pub closest: Vec3,
    /// Unit gradient of the signed distance: away from the product outside, the shortest way out inside. On edges it is the mean direction.
    pub normal: Vec3,
    /// Triangle of [`crate::Product::mesh`] that holds `closest`.
    pub triangle: u32,
    /// Weights of `closest` on the corners of that triangle.
    pub barycentric: [f64; 3],
}

/// Which side of the surface a point is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    Inside,
    Outside,
}

/// The reading of the same place from the other side of its sheet.
pub(crate) fn flipped(gap: &Gap) -> Gap {
    Gap {
        distance: -gap.distance,
        normal: -gap.normal,
        ..*gap
    }
}
