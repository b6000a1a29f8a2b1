//! Checks of recordings and residuals: lack of fit, signatures of effects, heteroscedasticity, change points of the gain.

pub(crate) mod lack_of_fit;
pub mod signatures;
pub mod heteroscedasticity;
pub(crate) mod gain_step;
