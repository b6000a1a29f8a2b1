//! The hand as one signed distance field: negative inside, smooth unions of fingers, palm, thumb and wrist.

mod crease;
mod finger;
mod nail;
mod palm;
mod solid;
mod sweep;
mod thumb;

use crate::skeleton::{Skeleton, THUMB};
use crease::Crease;
pub(crate) use nail::Nail;
use solid::{Chain, FAR_SHARE, soft_max, soft_min};
pub(crate) use sweep::Station;
use sweep::Sweep;
use thenar_surface::Vec3;

/// What the field's slope stays below away from its steps (nails, creases), and the height of those; extraction looks for the skin by them.
/// They hold outside the flesh, not on a digit's axis: there a point reads the semi-axis in its own direction, not the smallest (see
/// `ellipsoid_value`), and the field leaps. Extraction follows the skin into what they miss.
pub(crate) const MAX_SLOPE: f64 = 1.3;
pub(crate) const MAX_STEP: f64 = 1.0;
/// Two fingers blend over this many mm only; more and they web.
const FINGER_TO_FINGER: f64 = 1.0;
const FINGER_TO_PALM: f64 = 5.0;
const THUMB_TO_PALM: f64 = 9.0;

/// The right hand's flesh.
pub(crate) struct Flesh {
    digits: Vec<Sweep>,
    nails: Vec<Nail>,
    palm: Chain,
    /// Corners of a box around palm and thumb.
    palm_box: (Vec3, Vec3),
    creases: Vec<Crease>,
    /// The forearm ends here, y in mm.
    pub cut_y: f64,
}

impl Flesh {
    /// Grows the flesh on a skeleton.
    pub fn new(skeleton: &Skeleton) -> Flesh {
        let mut digits: Vec<Sweep> = (0..THUMB).map(|k| finger::sweep(skeleton, k)).collect();
        digits.push(thumb::sweep(skeleton));
        let nails = (0..digits.len())
            .map(|k| Nail::new(&digits[k], k == THUMB))
            .collect();
        let palm = palm::palm(skeleton);
        let (corners, thumb) = (palm.bounds(), digits[THUMB].hull().bounds());
        Flesh {
            digits,
            nails,
            palm_box: (corners.0.inf(&thumb.0), corners.1.sup(&thumb.1)),
            palm,
            creases: crease::palm_creases(skeleton),
            cut_y: -40.0 * skeleton.lengthwise(),
        }
    }

    /// Signed distance to the skin, mm; exact in sign, approximate in size away from the skin.
    pub fn value(&self, p: Vec3) -> f64 {
        let mut fingers = f64::INFINITY;
        for k in 0..THUMB {
            fingers = self.with_digit(p, k, fingers, FINGER_TO_FINGER);
        }
        if FAR_SHARE * self.palm_distance(p) > fingers + FINGER_TO_PALM {
            return fingers;
        }
        let palm = self.palm.value(p, f64::INFINITY);
        let palm = self.with_digit(p, THUMB, palm, THUMB_TO_PALM);
        let hand = soft_min(fingers, self.palm.carve(p, palm), FINGER_TO_PALM);
        let hand = if hand.abs() < 4.0 {
            hand + self.crease_depth(p)
        } else {
            hand
        };
        soft_max(hand, self.cut_y - p.y, 3.0)
    }

    /// The field and its gradient at once, from the corners of a tetrahedron of 0.03 mm.
    pub fn value_and_gradient(&self, p: Vec3) -> (f64, Vec3) {
        const STEP: f64 = 0.015;
        let corners = [
            [1.0, 1.0, 1.0],
            [1.0, -1.0, -1.0],
            [-1.0, 1.0, -1.0],
            [-1.0, -1.0, 1.0],
        ];
        let (mut value, mut gradient) = (0.0, Vec3::zeros());
        for [x, y, z] in corners {
            let corner = Vec3::new(x, y, z);
            let here = self.value(p + corner * STEP);
            value += 0.25 * here;
            gradient += corner * (here / (4.0 * STEP));
        }
        (value, gradient)
    }

    /// The skin's point nearest to a point close to it: `steps` Newton steps along the gradient.
    pub fn project(&self, mut p: Vec3, steps: usize) -> Vec3 {
        for _ in 0..steps {
            let (value, gradient) = self.value_and_gradient(p);
            p -= gradient * (value / gradient.norm_squared().max(0.09)).clamp(-1.5, 1.5);
        }
        p
    }

    /// The nail plate of each digit, index to thumb.
    pub fn nails(&self) -> &[Nail] {
        &self.nails
    }

    /// Where a point lies along a digit (index, middle, ring, little, thumb).
    pub fn station(&self, digit: usize, p: Vec3) -> Station {
        self.digits[digit].station(p)
    }

    /// Distance to the outline of a digit's nail, mm, positive on both sides of it; infinite on the palm side.
    pub fn nail_distance(&self, digit: usize, p: Vec3) -> f64 {
        if self.digits[digit].hull().distance(p) > 0.0 {
            return f64::INFINITY;
        }
        self.nails[digit]
            .outline(&self.digits[digit].station(p))
            .abs()
    }

    /// Field of one digit alone; large where the digit is far.
    pub fn digit(&self, digit: usize, p: Vec3) -> f64 {
        self.with_digit(p, digit, f64::INFINITY, 0.0)
    }

    /// Corners of a box that holds the skin, mm.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let (mut low, mut high) = self.palm.bounds();
        for digit in &self.digits {
            let corners = digit.hull().bounds();
            low = low.inf(&corners.0);
            high = high.sup(&corners.1);
        }
        low.y = self.cut_y;
        (low - Vec3::repeat(3.0), high + Vec3::repeat(3.0))
    }

    fn with_digit(&self, p: Vec3, digit: usize, others: f64, blend: f64) -> f64 {
        let sweep = &self.digits[digit];
        if sweep.hull().distance(p) > others + blend {
            return others;
        }
        let station = sweep.station(p);
        let own = sweep.distance(&station) + self.nails[digit].relief(&station);
        soft_min(own, others, blend)
    }

    /// Distance to a box around palm and thumb.
    fn palm_distance(&self, p: Vec3) -> f64 {
        let (low, high) = self.palm_box;
        (low - p).sup(&(p - high)).sup(&Vec3::zeros()).norm()
    }

    fn crease_depth(&self, p: Vec3) -> f64 {
        self.creases
            .iter()
            .map(|crease| crease.depth(p))
            .fold(0.0, f64::max)
    }
}
