//! A nail as relief in the skin: sunk at the root and the sides, standing free at its end.

use super::sweep::{Station, Sweep};

/// Depth of the step at the nail's root, mm. Below about 0.4 mm a mesh with 1.2 mm edges loses it.
const ROOT_STEP: f64 = 0.75;
/// Height of the free edge over the pulp, mm.
const FREE_EDGE: f64 = 0.25;
/// The step is spread over this width, mm.
const STEP_WIDTH: f64 = 0.9;

/// One nail plate.
pub(crate) struct Nail {
    middle: f64,
    half_length: f64,
    half_width: f64,
}

impl Nail {
    /// The nail of a digit: .70 of the tip's breadth wide on a finger, .74 on the thumb, 1.12 times as long.
    pub(super) fn new(sweep: &Sweep, is_thumb: bool) -> Nail {
        let breadth = 2.0 * sweep.section(sweep.cap).half;
        let half_width = 0.5 * breadth * if is_thumb { 0.74 } else { 0.70 };
        let half_length = half_width * 1.12;
        Nail {
            middle: sweep.end - 1.1 - half_length,
            half_length,
            half_width,
        }
    }

    /// Distance to the outline, mm, negative on the plate; infinite on the palm side.
    pub fn outline(&self, at: &Station) -> f64 {
        if at.palmar > 0.0 {
            return f64::INFINITY;
        }
        let corner = 0.45 * self.half_width;
        let x = (at.across.abs() - self.half_width + corner).max(0.0);
        let y = ((at.along - self.middle).abs() - self.half_length + corner).max(0.0);
        let inner = (at.across.abs() - self.half_width)
            .max((at.along - self.middle).abs() - self.half_length);
        if x > 0.0 && y > 0.0 {
            x.hypot(y) - corner
        } else {
            inner
        }
    }

    /// What the nail adds to the digit's distance field, mm; positive sinks the skin.
    pub(super) fn relief(&self, at: &Station) -> f64 {
        let outline = self.outline(at);
        if outline > STEP_WIDTH {
            return 0.0;
        }
        let t = (0.5 - outline / STEP_WIDTH).clamp(0.0, 1.0);
        let plate = t * t * (3.0 - 2.0 * t);
        let along = ((at.along - self.middle) / self.half_length).clamp(-1.0, 1.0);
        let free = (0.5 * (1.0 + along)).powi(3);
        plate * (ROOT_STEP * (1.0 - free) - FREE_EDGE * free)
    }
}
