//! Recordings of a study as moments of a protocol and samples in the recording's own terms.

pub(crate) mod limits;
pub mod measured;
pub mod robust_scale;
pub(crate) mod protocol_phases;
pub(crate) mod first_touch;
pub(crate) mod downsampling;
pub(crate) mod smoothing;
pub(crate) mod depth_jitter;
pub(crate) mod motion;
pub(crate) mod indentation;
pub(crate) mod pressure_map;
pub(crate) mod scan_registration;
pub(crate) mod surface_scan;
pub(crate) mod study;
