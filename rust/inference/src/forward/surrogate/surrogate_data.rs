//! Data shared by all surrogate models of a study: recordings, elastic tables, whitening, and the parameters of every model.

use crate::forward::surrogate::force_recording::ForceRecording;
use crate::forward::tables::elastic::Elastic;
use crate::noise::whitening::Whitening;
use crate::parameters::surrogate_parameter::Coordinate;

/// What all candidate models of a study share.
pub struct Surrogate<'a> {
    /// Recordings.
    pub courses: &'a [ForceRecording],
    /// Tables.
    pub elastic: &'a Elastic,
    /// How residuals are whitened.
    pub whitening: &'a Whitening,
    /// Measured values of all samples, stacked; those that are not screened stand for their own simulation.
    pub measured: &'a [f64],
    /// What is free in every model.
    pub shared: Vec<Coordinate>,
    /// Largest force and depth of the study.
    pub most: (f64, f64),
    /// Smallest peak force of a recording, N.
    pub least_peak: f64,
    /// Floor over it, below which readings cannot be told from noise.
    pub least_floor: f64,
}
