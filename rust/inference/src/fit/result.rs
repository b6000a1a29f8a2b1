//! Result of a fit: estimates, simulation, noise, projected residual, lack-of-fit probability.

use nalgebra::DMatrix;

use crate::observe::measured::Measured;
use crate::parameters::estimate::Estimate;

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
