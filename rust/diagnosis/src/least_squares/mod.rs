//! Robust least squares with bounds and priors (Levenberg-Marquardt, Huber loss): of the mesh model, and of the surrogate.

pub mod objective;
pub mod levenberg_marquardt;
pub mod confidence_intervals;
pub mod surrogate_fit;
