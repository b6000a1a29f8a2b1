//! Live presses: what is extrapolated from the last frame, and which sites keep their last solution.

pub mod extrapolation;
pub mod reused_sites;
