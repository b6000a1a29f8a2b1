//! Nuisance parameters of one recording: contact zero, gain, load-cell zero, form error, pose of mat or scan, counts per kPa.

use thenar_contact::Material;
use thenar_contact::instrument::Placement;

/// Depths at which the model's form may be off.
pub(crate) const KNOTS: usize = 4;

/// What belongs to one recording alone, besides the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nuisance {
    /// Depth of the true first touch in the recording's own depth, mm: the true depth is that much less.
    pub zero_mm: f64,
    /// Natural logarithm of the factor on force and pressure.
    pub log_gain: f64,
    /// Force that the load cell shows without load, N.
    pub force_zero_n: f64,
    /// Logarithm of a factor on the load, at [`KNOTS`] equal parts of the deepest depth; 0 at first touch, straight between.
    pub form: [f64; KNOTS],
    /// How the mat lies otherwise than the study says.
    pub placement: Placement,
    /// Natural logarithm of counts per kPa; 0 on a calibrated mat.
    pub log_counts: f64,
    /// How a scan lies otherwise than it was first laid: shift (mm), and turn (rad) about its own center.
    pub scan: [f64; 6],
}

/// Materials by region, and what belongs to one recording.
pub type At<'a> = (&'a [Material], &'a Nuisance);

impl Nuisance {
    /// None.
    pub fn none() -> Nuisance {
        Nuisance {
            zero_mm: 0.0,
            log_gain: 0.0,
            force_zero_n: 0.0,
            form: [0.0; KNOTS],
            placement: Placement::default(),
            log_counts: 0.0,
            scan: [0.0; 6],
        }
    }
}
