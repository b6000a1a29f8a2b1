//! Where the joints are at rest and how each digit is turned, for the right hand.

use crate::proportions::{
    FINGERS, FingerProportions, METACARPAL_BASE_Y, REFERENCE, THUMB_BASE_X, THUMB_LENGTHS, TIP,
};
use nalgebra::{Rotation3, Unit};
use thenar_surface::Vec3;

/// A chain of three bones that bends about one axis: a finger's phalanges, or the whole thumb.
#[derive(Debug, Clone)]
pub(crate) struct Digit {
    /// Prefix of every name that belongs to the digit.
    pub name: &'static str,
    /// Joint centres and the end of the last bone, mm.
    pub joints: [Vec3; 4],
    /// Unit directions of the three bones.
    pub along: [Vec3; 3],
    /// Unit directions in which the pads of the three bones face.
    pub palmar: [Vec3; 3],
    /// Unit flexion axis, common to the three bones; a positive turn flexes.
    pub axis: Vec3,
    /// Skin at the tip lies this far beyond the last joint entry, mm.
    pub tip_mm: f64,
    /// Centre of the metacarpal base, mm (the thumb's own first joint for the thumb).
    pub base: Vec3,
}

impl Digit {
    /// Lengths of the three bones, mm.
    pub fn lengths(&self) -> [f64; 3] {
        std::array::from_fn(|k| (self.joints[k + 1] - self.joints[k]).norm())
    }
}

/// Every joint of a hand of the given size.
#[derive(Debug, Clone)]
pub(crate) struct Skeleton {
    /// Hand length, mm.
    pub length: f64,
    /// Hand breadth, mm.
    pub breadth: f64,
    /// Index, middle, ring, little, thumb.
    pub digits: Vec<Digit>,
}

/// Place of the thumb in [`Skeleton::digits`].
pub(crate) const THUMB: usize = 4;

impl Skeleton {
    /// The skeleton of a right hand `length` by `breadth` mm.
    pub fn new(length: f64, breadth: f64) -> Skeleton {
        let mut digits: Vec<Digit> = FINGERS
            .iter()
            .map(|finger| place_finger(finger, length, breadth))
            .collect();
        digits.push(place_thumb(length, breadth));
        Skeleton {
            length,
            breadth,
            digits,
        }
    }

    /// A point given in mm of the reference hand, moved to this hand.
    pub fn point(&self, x: f64, y: f64, z: f64) -> Vec3 {
        Vec3::new(x * self.across(), y * self.lengthwise(), z * self.across())
    }

    /// Breadth and depth of this hand over the reference hand's.
    pub fn across(&self) -> f64 {
        self.breadth / REFERENCE.1
    }

    /// Length of this hand over the reference hand's.
    pub fn lengthwise(&self) -> f64 {
        self.length / REFERENCE.0
    }
}

pub(crate) fn turn(v: Vec3, axis: Vec3, degrees: f64) -> Vec3 {
    Rotation3::from_axis_angle(&Unit::new_normalize(axis), degrees.to_radians()) * v
}

fn place_finger(finger: &FingerProportions, length: f64, breadth: f64) -> Digit {
    let arch = finger.arch_mm * breadth / REFERENCE.1;
    let mcp = Vec3::new(finger.head[0] * breadth, finger.head[1] * length, arch);
    let base = Vec3::new(
        finger.base_x * breadth,
        METACARPAL_BASE_Y * length,
        arch.min(-1.0),
    );
    let [splay, roll, bends @ ..] = finger.rest;
    let straight = turn(Vec3::y(), Vec3::z(), -splay);
    let axis = turn(straight.cross(&Vec3::z()), straight, -roll).normalize();
    let lengths = finger
        .phalanges
        .map(|fraction| fraction * finger.shorter * length);
    chain(
        finger.name,
        mcp,
        straight,
        axis,
        Phalanges { bends, lengths },
    )
    .with(base, TIP * length)
}

/// The thumb stands out of the palm plane: its pad faces ulnarly, nearly at right angles to the finger pads.
fn place_thumb(length: f64, breadth: f64) -> Digit {
    let base = Vec3::new(
        THUMB_BASE_X * breadth,
        METACARPAL_BASE_Y * length,
        2.0 * breadth / REFERENCE.1,
    );
    let straight = Vec3::new(0.60, 0.66, 0.46).normalize();
    let axis = straight.cross(&Vec3::new(-0.74, 0.30, 0.60)).normalize();
    let lengths = THUMB_LENGTHS.map(|fraction| fraction * length);
    chain(
        "thumb",
        base,
        straight,
        axis,
        Phalanges {
            bends: [0.0, 12.0, 10.0],
            lengths,
        },
    )
    .with(base, TIP * length)
}

/// How far each phalanx is bent at rest, degrees, and how long it is, mm.
struct Phalanges {
    bends: [f64; 3],
    lengths: [f64; 3],
}

fn chain(
    name: &'static str,
    start: Vec3,
    straight: Vec3,
    axis: Vec3,
    Phalanges { bends, lengths }: Phalanges,
) -> Digit {
    let mut joints = [start; 4];
    let mut along = [straight; 3];
    let mut direction = straight;
    for k in 0..3 {
        direction = turn(direction, axis, bends[k]);
        along[k] = direction;
        joints[k + 1] = joints[k] + direction * lengths[k];
    }
    let palmar = along.map(|d| axis.cross(&d));
    Digit {
        name,
        joints,
        along,
        palmar,
        axis,
        tip_mm: 0.0,
        base: start,
    }
}

impl Digit {
    fn with(mut self, base: Vec3, tip_mm: f64) -> Digit {
        (self.base, self.tip_mm) = (base, tip_mm);
        self
    }
}
