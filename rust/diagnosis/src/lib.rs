//! Comparison of recordings with the simulation, and what explains the difference; reads no files and knows nothing of Blender.
#![doc = include_str!("../README.md")]

mod errors;
mod random;
mod statistics;
mod observe;
mod replay;
mod noise;
mod fit;
mod location;
mod words;
pub mod comparison;
pub mod prints;
pub mod report;
pub mod diagnose;
mod compare;

pub use compare::compare;
pub use diagnose::{DiagnoseOptions, Diagnosis, diagnose, findings_json};
pub use errors::DiagnosisError;
pub use fit::{EffectFit, Estimate, Fit, Fitting, Found, Free, Options, Target, fit_study};
pub use location::{Carrier, Location, Mismatch, Place, Search, Shown, When, locate};
pub use observe::{Censoring, Mat, Measured, Moment, Phase, Quantity, Sample, Scan, ScanPoint};
