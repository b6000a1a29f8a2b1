//! Forces between skin and product beyond normal contact: friction and adhesion.

pub mod shear_kernel;
pub mod shear_matrix;
pub mod shear_response;
pub mod disc_solver;
pub mod stick_slip;
pub mod drag_force_search;

pub(crate) mod adhesion;
pub(crate) mod friction_state;
pub(crate) mod pulls;
pub(crate) mod friction;
pub(crate) mod shear_result;
mod dense_stick_slip;
#[cfg(test)]
mod stick_slip_paths;

pub use dense_stick_slip::{StickSlip, solve_stick_slip};
