//! Noise of pressure maps and scans.

pub(crate) mod mat_noise;
pub(crate) mod mat_smoothing;
pub(crate) mod scan_noise;
