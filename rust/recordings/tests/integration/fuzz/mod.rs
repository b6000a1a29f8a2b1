//! Damaged files at random: every reader keeps its promises.

mod mesh_fuzz;
mod recording_fuzz;
mod study_fuzz;
