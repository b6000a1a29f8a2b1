//! The fit of the mesh model's parameters to several recordings: estimates with intervals, simulation, noise and residuals.

pub mod result;
pub(crate) mod initial_guess;
pub mod fitting;
pub(crate) mod print_presses;
