//! A digit as an elliptical section swept along its bent chain of bones: breadth, palmar and dorsal depth run along the length.

use super::solid::{Capsule, ellipsoid_value};
use crate::skeleton::Digit;
use thenar_surface::Vec3;

/// A point in the coordinates of a digit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Station {
    /// Along the bones from the first joint, mm; negative before it.
    pub along: f64,
    /// Across, mm, positive in the direction of the flexion axis.
    pub across: f64,
    /// From the bone axis towards the pad, mm; negative on the back.
    pub palmar: f64,
}

/// Section at one place along a digit: half breadth, palmar and dorsal depth from the bone axis, mm.
#[derive(Clone, Copy)]
pub(super) struct Section {
    pub along: f64,
    pub half: f64,
    pub palmar: f64,
    pub dorsal: f64,
}

/// The swept solid.
pub(super) struct Sweep {
    digit: Digit,
    starts: [f64; 4],
    sections: Vec<Section>,
    slopes: Vec<[f64; 3]>,
    /// The round tip starts here and ends at `end`, mm along.
    pub cap: f64,
    pub end: f64,
    /// Round start: begins at 0 and reaches this far back, mm.
    root: f64,
    hull: Capsule,
    /// Unit normals of the planes that part the bones, and the pad directions in those planes: start, two joints, end.
    normals: [Vec3; 4],
    pads: [Vec3; 4],
}

impl Sweep {
    /// A sweep through `sections` (in order along the digit) that is rounded off over `cap` mm at the tip and `root` mm behind the first joint.
    pub fn new(digit: &Digit, sections: Vec<Section>, cap: f64, root: f64) -> Sweep {
        let lengths = digit.lengths();
        let starts = [
            0.0,
            lengths[0],
            lengths[0] + lengths[1],
            lengths.iter().sum(),
        ];
        let end = starts[3] + digit.tip_mm;
        let slopes = (0..sections.len())
            .map(|k| slope_at(&sections, k))
            .collect();
        let widest = sections
            .iter()
            .map(|s| s.half.max(s.palmar).max(s.dorsal))
            .fold(0.0, f64::max);
        let hull = Capsule {
            start: digit.joints[0],
            edge: digit.joints[3] - digit.joints[0],
            radius: 0.25 * lengths[0] + widest.max(root).max(digit.tip_mm),
        };
        let at_planes = |v: [Vec3; 3]| {
            [
                v[0],
                (v[0] + v[1]).normalize(),
                (v[1] + v[2]).normalize(),
                v[2],
            ]
        };
        Sweep {
            digit: digit.clone(),
            starts,
            sections,
            slopes,
            cap: end - cap,
            end,
            root,
            hull,
            normals: at_planes(digit.along),
            pads: at_planes(digit.palmar),
        }
    }

    /// A capsule that holds the digit.
    pub fn hull(&self) -> &Capsule {
        &self.hull
    }

    /// Coordinates of a point along the digit; continuous across the joints, where sections turn about the flexion axis.
    pub fn station(&self, p: Vec3) -> Station {
        let d = &self.digit;
        let across = (p - d.joints[0]).dot(&d.axis);
        let bone = (1..3)
            .filter(|&k| (p - d.joints[k]).dot(&self.normals[k]) > 0.0)
            .count();
        let before = (p - d.joints[bone]).dot(&self.normals[bone]);
        let after = (d.joints[bone + 1] - p).dot(&self.normals[bone + 1]);
        let length = self.starts[bone + 1] - self.starts[bone];
        let (along, share) = if bone == 0 && before < 0.0 {
            (before, 0.0)
        } else if bone == 2 && after < 0.0 {
            (self.starts[3] - after, 1.0)
        } else {
            let share = before / (before + after).max(0.2 * length);
            (self.starts[bone] + share * length, share)
        };
        let center = d.joints[bone] + d.along[bone] * (along - self.starts[bone]);
        let share = share.clamp(0.0, 1.0);
        let pad = self.pads[bone] * (1.0 - share) + self.pads[bone + 1] * share;
        Station {
            along,
            across,
            palmar: (p - center).dot(&pad.normalize()),
        }
    }

    /// Signed distance to the digit's skin without its nail, mm.
    pub fn distance(&self, at: &Station) -> f64 {
        let section = self.section(at.along);
        let depth = if at.palmar > 0.0 {
            section.palmar
        } else {
            section.dorsal
        };
        let (beyond, reach) = if at.along > self.cap {
            (at.along - self.cap, self.end - self.cap)
        } else {
            (at.along.min(0.0), self.root)
        };
        ellipsoid_value(
            Vec3::new(at.across, beyond, at.palmar),
            Vec3::new(section.half, reach, depth),
        )
    }

    /// Section at a place along the digit, by cubic Hermite interpolation.
    pub fn section(&self, along: f64) -> Section {
        let s = &self.sections;
        let last = s.len() - 1;
        let along = along.clamp(s[0].along, s[last].along);
        let k = s[1..last]
            .iter()
            .take_while(|section| section.along < along)
            .count();
        let width = s[k + 1].along - s[k].along;
        let t = (along - s[k].along) / width;
        let value = |a: f64, b: f64, from: f64, to: f64| {
            let (t2, t3) = (t * t, t * t * t);
            (2.0 * t3 - 3.0 * t2 + 1.0) * a
                + (3.0 * t2 - 2.0 * t3) * b
                + width * ((t3 - 2.0 * t2 + t) * from + (t3 - t2) * to)
        };
        let (from, to) = (self.slopes[k], self.slopes[k + 1]);
        Section {
            along,
            half: value(s[k].half, s[k + 1].half, from[0], to[0]),
            palmar: value(s[k].palmar, s[k + 1].palmar, from[1], to[1]),
            dorsal: value(s[k].dorsal, s[k + 1].dorsal, from[2], to[2]),
        }
    }
}

/// Slope at a section: zero at extremes and at the ends, else the harmonic mean of both sides, so that nothing overshoots (Fritsch & Butland 1984).
fn slope_at(sections: &[Section], k: usize) -> [f64; 3] {
    if k == 0 || k + 1 == sections.len() {
        return [0.0; 3];
    }
    let (a, b, c) = (sections[k - 1], sections[k], sections[k + 1]);
    let mean = |u: f64, v: f64, w: f64| {
        let (left, right) = ((v - u) / (b.along - a.along), (w - v) / (c.along - b.along));
        if left * right <= 0.0 {
            0.0
        } else {
            2.0 * left * right / (left + right)
        }
    };
    [
        mean(a.half, b.half, c.half),
        mean(a.palmar, b.palmar, c.palmar),
        mean(a.dorsal, b.dorsal, c.dorsal),
    ]
}
