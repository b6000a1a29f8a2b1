//! Pressure mats, and errors of instruments.

mod instrument_effects;
mod instrument_mat;
mod instrument_press;
