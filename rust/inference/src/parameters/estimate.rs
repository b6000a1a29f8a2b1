//! Estimate of one parameter with its 90 % interval.

use crate::parameters::target::Target;

/// One fitted number.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Name with its unit: `g0_mpa`, `contact_zero_mm`, `pose_x_mm`.
    pub name: String,
    /// What it belongs to.
    pub target: Target,
    /// Where the fit began.
    pub start: f64,
    /// The estimate.
    pub value: f64,
    /// Lower end of the 90 % interval.
    pub low: f64,
    /// Upper end of the 90 % interval.
    pub high: f64,
    /// Smallest and largest admissible value.
    pub bounds: (f64, f64),
    /// True if the estimate lies on a bound.
    pub is_at_bound: bool,
}
