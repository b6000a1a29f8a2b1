//! The surrogate forward model: force by elastic tables, relaxing springs and an instrument model; about 100 times faster than the mesh.

pub mod force_recording;
pub mod relaxation_spectrum;
pub mod relaxing_springs;
pub mod mechanism;
pub mod screen;
pub mod model;
pub mod effect_laws;
pub mod stiffness_factor;
pub mod force_prediction;
pub mod derivatives;
pub mod prepared_study;
#[cfg(test)]
pub mod synthetic;
