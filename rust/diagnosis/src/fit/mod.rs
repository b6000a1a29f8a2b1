//! What a fit of the parameters to several recordings gives: estimates with intervals, simulation, noise, and what is left.

mod adequacy;
mod conduct;
mod descent;
mod effects;
mod form;
mod intervals;
mod parameters;
mod poses;
mod printed;
mod problem;
mod setting;
mod start;

pub(crate) use adequacy::blocks;
pub use conduct::{Fitting, Options, fit_study};
pub use effects::{EffectFit, Found, Free};

use nalgebra::DMatrix;

use crate::Measured;

/// What an estimate belongs to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Target {
    /// The material of a region, by name.
    Region(String),
    /// A recording, by name: its contact zero, or pose.
    Recording(String),
    /// The instrument.
    Instrument,
}

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

/// What a fit hands to comparison, location and report. Lists by recording are in the study's order, and aligned with
/// [`Measured::samples`].
#[derive(Debug, Clone)]
pub struct Fit {
    /// The recordings.
    pub measured: Vec<Measured>,
    /// Simulated values at the estimates, in the samples' units.
    pub simulated: Vec<Vec<f64>>,
    /// Simulated values with the parameters at which the fit began.
    pub before: Vec<Vec<f64>>,
    /// Standard deviation of the noise of every sample, in its unit.
    pub sigma: Vec<Vec<f64>>,
    /// Whitened residual with all taken out that parameters can absorb: `P L^-1 (measured - simulated)`. Normal and
    /// independent with variance 1 where nothing is missing; 0 for a censored sample that the simulation agrees with.
    pub projected: Vec<Vec<f64>>,
    /// Orthonormal columns that span what parameters can absorb, whitened, all recordings stacked in order: `P = I - Q Q^T`.
    pub absorbed: DMatrix<f64>,
    /// Fitted numbers.
    pub estimates: Vec<Estimate>,
    /// Probability that noise alone leaves as much as is left; None where no repeats tell the noise.
    pub lack_of_fit_p: Option<f64>,
    /// What a reader should be told, a sentence each.
    pub notes: Vec<String>,
}
