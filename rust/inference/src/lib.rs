//! What recordings say of a model's parameters: noise, forward models, fits, selection, design; knows no verdict, files or Blender.
#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

pub mod errors;
pub mod random;
pub mod distributions;
pub mod number_format;
pub(crate) mod interpolation;

pub mod observe;
pub mod noise;
pub mod forward;
pub mod parameters;
pub mod least_squares;
pub mod fit;
pub mod checks;
pub mod selection;
pub mod design;
pub mod grasp;

pub use errors::InferenceError;
pub use fit::fitting::{Fitting, Options, fit_study};
pub use fit::result::Fit;
pub use observe::measured::{
    Censoring, Mat, Measured, Moment, Phase, Quantity, Sample, Scan, ScanPoint,
};
pub use parameters::effect_parameters::{EffectFit, Found, Free};
pub use parameters::estimate::Estimate;
pub use parameters::target::Target;
