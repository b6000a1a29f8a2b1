//! Live presses: extrapolation from the last frame, and sites that keep their last solution.

pub mod extrapolation;
pub mod reused_sites;
