//! Findings of channels other than force over depth: force across the skin, cells of a mat, and where depth counts from.

pub(crate) mod depth_zero;
pub(crate) mod mat_ceiling;
pub(crate) mod mat_gain;
pub(crate) mod slides;
