//! Findings of channels other than force over depth: force across the skin, and cells of a mat.

pub(crate) mod mat_ceiling;
pub(crate) mod mat_gain;
pub(crate) mod slides;
