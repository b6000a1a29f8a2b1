//! What was measured: recordings, studies, mats and prints, their comparison with simulation, and its diagnosis.

pub mod comparison;
pub mod diagnosis;
pub mod placing;
pub mod print_comparison;
pub mod prints;
pub mod readings;
pub mod recordings;
pub mod study;
