//! Indentation of a flat layer by a sphere, with or without a stiff skin that stretches: an axisymmetric model on rings.
//!
//! Without a skin it is as exact as its rings: on a half space within 0.2 % of Sneddon's sphere (1965), from a fifteenth of the deepest depth.
//! The contact model on meshes takes a stiff skin for a plate at small strains. Here the skin gives way through its own thickness
//! (`wave_response`) and is stretched by its own deflection (`membrane_tension`): what a ball meets that is small against the skin, and what it meets
//! once it has sunk in. Against the finite elements of `tests/trial` see `python -m trial.finite_elements.against_skin`.

mod stiff_skin;
mod wave_response;
mod ring_quadrature;
mod ring_contact;
mod membrane_tension;
mod sphere;

pub use sphere::{Ball, SHALLOWEST};
pub use stiff_skin::StiffSkin;
