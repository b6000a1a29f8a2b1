//! Robust least squares with bounds and priors (Levenberg-Marquardt, Huber loss): of the mesh model, and of the surrogate.

pub mod huber;
pub(crate) mod levenberg_marquardt;
pub(crate) mod objective;
pub(crate) mod confidence_intervals;
pub mod surrogate_fit;
