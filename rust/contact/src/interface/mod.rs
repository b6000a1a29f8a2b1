//! What happens in the plane of the contact and across it: friction and adhesion.

pub mod shear_kernel;
pub mod shear_matrix;
pub mod shear_response;
pub mod discs;
pub mod stick_slip;
pub mod pull;

pub(crate) mod attraction;
pub(crate) mod friction;
pub(crate) mod shear_fields;
mod dense;
#[cfg(test)]
mod paths;

pub use dense::{StickSlip, solve_stick_slip};
