//! Checks of recordings and residuals: lack of fit, forces that are read in steps, copies that are no repeats, short waves that repeats share, signatures of effects, heteroscedasticity, change points of the gain.

pub mod coarse_forces;
pub(crate) mod copies;
pub(crate) mod lack_of_fit;
pub mod signatures;
pub mod heteroscedasticity;
pub mod depth_curve;
pub mod short_waves;
pub(crate) mod gain_step;
