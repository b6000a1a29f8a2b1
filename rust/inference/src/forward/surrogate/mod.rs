//! The surrogate forward model: force by elastic tables, relaxing springs and an instrument model; about 100 times faster than the mesh.

pub mod force_recording;
pub mod relaxation_spectrum;
pub(crate) mod relaxing_springs;
pub mod mechanism;
pub mod surrogate_data;
pub mod candidate_model;
pub mod tissue_laws;
pub(crate) mod instrument_laws;
pub(crate) mod stiffness_factor;
pub(crate) mod force_prediction;
pub(crate) mod stiffness_slopes;
pub(crate) mod derivatives;
pub mod prepared_study;
#[cfg(test)]
pub(crate) mod synthetic;
