//! The closest point of one triangle, in f64.

use crate::mesh::triangles::Vec3;

/// Where on a triangle a point lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feature {
    /// Inside the triangle.
    Face,
    /// On the edge from corner i to corner i + 1.
    Edge(u8),
    /// At corner i.
    Vertex(u8),
}

/// The point of a triangle that is closest to another point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosestPoint {
    /// The point, mm.
    pub point: Vec3,
    /// Its weights on the three corners, >= 0, with sum 1.
    pub barycentric: [f64; 3],
    /// Which part of the triangle it lies on.
    pub feature: Feature,
    /// Square of the distance, mm2.
    pub distance_squared: f64,
}

/// The point of the triangle `corners` closest to `point`, both mm (Ericson, Real-Time Collision Detection, 2005, 5.1.5: the seven Voronoi
/// regions of a triangle). A triangle without area gives the closest point of one of its edges.
pub fn closest_point(corners: [Vec3; 3], point: Vec3) -> ClosestPoint {
    closest_on(
        corners[0],
        corners[1] - corners[0],
        corners[2] - corners[0],
        point,
    )
}

/// [`closest_point`] for a triangle given by a corner and the two sides that leave it.
#[inline(always)]
pub(crate) fn closest_on(a: Vec3, ab: Vec3, ac: Vec3, p: Vec3) -> ClosestPoint {
    let ap = p - a;
    let (v, w, feature) = weights(&ab, &ac, &ap);
    let on = ab * v + ac * w;
    let barycentric = [(1.0 - v - w).max(0.0), v, w];
    ClosestPoint {
        point: a + on,
        barycentric,
        feature,
        distance_squared: (ap - on).norm_squared(),
    }
}

#[inline(always)]
fn weights(ab: &Vec3, ac: &Vec3, ap: &Vec3) -> (f64, f64, Feature) {
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (0.0, 0.0, Feature::Vertex(0));
    }
    let (bb, bc, cc) = (ab.norm_squared(), ab.dot(ac), ac.norm_squared());
    let (d3, d4) = (d1 - bb, d2 - bc);
    if d3 >= 0.0 && d4 <= d3 {
        return (1.0, 0.0, Feature::Vertex(1));
    }
    let (d5, d6) = (d1 - bc, d2 - cc);
    if d6 >= 0.0 && d5 <= d6 {
        return (0.0, 1.0, Feature::Vertex(2));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (ratio(d1, bb), 0.0, Feature::Edge(0));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (0.0, ratio(d2, cc), Feature::Edge(2));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let w = ratio(d4 - d3, (d4 - d3) + (d5 - d6));
        return (1.0 - w, w, Feature::Edge(1));
    }
    let sum = va + vb + vc;
    let (v, w) = (ratio(vb, sum), ratio(vc, sum));
    (v, w.min(1.0 - v), Feature::Face)
}

/// A quotient that is a weight whatever rounding did: a flat triangle may divide 0 by 0.
#[inline(always)]
fn ratio(part: f64, whole: f64) -> f64 {
    if whole > 0.0 {
        (part / whole).clamp(0.0, 1.0)
    } else {
        0.0
    }
}
