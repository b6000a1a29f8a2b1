//! Eight triangles at a time in f32: lower bounds on their distances, so that only those that may be nearest are measured in f64.

use crate::tree::face::{Face, WIDTH};

/// What rounding to f32 may add to a distance, in parts of the product's extent: 2.4e-7 for coordinates within four extents, as much again
/// for sums of three products, and up to 5e-6 for the tilt of a normal (a rounding of 1.2e-7 over [`THIN`], over two extents).
const ROUNDING: f32 = 1e-5;

/// The same in parts of the distance.
const RELATIVE: f32 = 2e-5;

/// Triangles thinner than this, height over longest edge, have normals that f32 tells badly; they are always measured.
const THIN: f64 = 0.1;

/// Up to eight faces that stand together in the tree.
#[derive(Debug, Clone)]
#[repr(align(32))]
pub(crate) struct Leaf {
    a: [[f32; WIDTH]; 3],
    ab: [[f32; WIDTH]; 3],
    ac: [[f32; WIDTH]; 3],
    pub first: u32,
    pub count: u32,
}

impl Leaf {
    /// Takes `faces`, from index `first` of the tree's, scaled by `shrink`.
    pub(crate) fn new(faces: &[Face], first: usize, shrink: f64) -> Leaf {
        let mut leaf = Leaf {
            a: [[0.0; WIDTH]; 3],
            ab: [[0.0; WIDTH]; 3],
            ac: [[0.0; WIDTH]; 3],
            first: first as u32,
            count: faces.len() as u32,
        };
        for (lane, face) in faces.iter().enumerate() {
            let (ab, ac) = (face.ab * shrink, face.ac * shrink);
            let longest = ab
                .norm_squared()
                .max(ac.norm_squared())
                .max((ac - ab).norm_squared());
            // NaN makes every comparison false, which keeps the face.
            let is_thin = ab.cross(&ac).norm() < THIN * longest || longest < 1e-12;
            let scale = if is_thin { f64::NAN } else { 1.0 };
            for axis in 0..3 {
                self::set(&mut leaf.a, axis, lane, face.a[axis] * shrink);
                self::set(&mut leaf.ab, axis, lane, ab[axis] * scale);
                self::set(&mut leaf.ac, axis, lane, ac[axis] * scale);
            }
        }
        leaf
    }

    /// Bit k is set where face k may lie within the squared distance `bound` of `p`, both in parts of the extent.
    ///
    /// The distance of a triangle is that of its plane where the point projects into it, and else the least of its edges'.
    #[inline(always)]
    pub(crate) fn near(&self, p: &[f32; 3], bound: f32) -> u32 {
        let bound = bound.sqrt() * (1.0 + RELATIVE) + ROUNDING;
        let bound = bound * bound;
        let mut far = [false; WIDTH];
        for k in 0..WIDTH {
            let ab = [self.ab[0][k], self.ab[1][k], self.ab[2][k]];
            let ac = [self.ac[0][k], self.ac[1][k], self.ac[2][k]];
            let ap = [
                p[0] - self.a[0][k],
                p[1] - self.a[1][k],
                p[2] - self.a[2][k],
            ];
            let (bb, bc, cc) = (dot(ab, ab), dot(ab, ac), dot(ac, ac));
            let (d1, d2) = (dot(ab, ap), dot(ac, ap));
            let normal = [
                ab[1] * ac[2] - ab[2] * ac[1],
                ab[2] * ac[0] - ab[0] * ac[2],
                ab[0] * ac[1] - ab[1] * ac[0],
            ];
            let off = dot(normal, ap);
            let plane = off * off / dot(normal, normal);
            let (v, w) = (cc * d1 - bc * d2, bb * d2 - bc * d1);
            // A little wider than the triangle: there the plane is nearer than the edges, so the bound stays one.
            let slack = 1e-4 * (bb * cc);
            let is_within = (v >= -slack) & (w >= -slack) & (v + w <= bb * cc - bc * bc + slack);
            let bcv = [ac[0] - ab[0], ac[1] - ab[1], ac[2] - ab[2]];
            let bp = [ap[0] - ab[0], ap[1] - ab[1], ap[2] - ab[2]];
            let edges = least(
                segment(ab, ap, d1 / bb),
                least(
                    segment(ac, ap, d2 / cc),
                    segment(bcv, bp, dot(bcv, bp) / dot(bcv, bcv)),
                ),
            );
            let squared = if is_within { plane } else { edges };
            far[k] = squared > bound;
        }
        let mut near = (1u32 << self.count) - 1;
        for k in 0..WIDTH {
            near &= !(u32::from(far[k]) << k);
        }
        near
    }
}

fn set(to: &mut [[f32; WIDTH]; 3], axis: usize, lane: usize, value: f64) {
    to[axis][lane] = value as f32;
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Squared distance to the segment from the origin along `v`, where `t` is the unbounded foot.
#[inline(always)]
fn segment(v: [f32; 3], p: [f32; 3], t: f32) -> f32 {
    let t = if t > 0.0 { t } else { 0.0 };
    let t = if t < 1.0 { t } else { 1.0 };
    let d = [p[0] - v[0] * t, p[1] - v[1] * t, p[2] - v[2] * t];
    dot(d, d)
}
