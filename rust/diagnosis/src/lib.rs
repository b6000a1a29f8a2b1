//! Comparison of recordings with the simulation, and what explains the difference; reads no files and knows nothing of Blender.
#![doc = include_str!("../README.md")]

mod errors;
mod random;
mod distributions;
mod number_format;

mod observe;
mod noise;
mod forward;
mod parameters;
mod least_squares;
mod fit;
mod checks;
mod selection;
mod design;

pub mod comparison;
mod location;
pub mod prints;
mod compare;

pub mod diagnose;
pub mod report;

pub use compare::compare;
pub use diagnose::{DiagnoseOptions, Diagnosis, diagnose, findings_json};
pub use errors::DiagnosisError;
pub use fit::fitting::{Fitting, Options, fit_study};
pub use fit::result::Fit;
pub use location::locate::{Search, locate};
pub use location::mismatch::{Carrier, Location, Mismatch, Place, Shown, When};
pub use observe::measured::{
    Censoring, Mat, Measured, Moment, Phase, Quantity, Sample, Scan, ScanPoint,
};
pub use parameters::effect_parameters::{EffectFit, Found, Free};
pub use parameters::estimate::Estimate;
pub use parameters::target::Target;
