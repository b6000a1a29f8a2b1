//! The fit of the mesh model's parameters to several recordings: estimates with intervals, simulation, noise and residuals.

pub mod result;
pub mod initial_guess;
pub mod fitting;
pub mod print_presses;
