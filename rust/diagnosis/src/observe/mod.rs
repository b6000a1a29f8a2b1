//! Recordings of a study as moments of a protocol and samples in the recording's own terms.

pub mod limits;
pub mod measured;
pub mod robust_scale;
pub mod protocol_phases;
pub mod first_touch;
pub mod downsampling;
pub mod indentation;
pub mod pressure_map;
pub mod scan_registration;
pub mod surface_scan;
pub mod study;
