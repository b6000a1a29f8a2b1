//! Forward models: predicted samples for given parameters, by the mesh and by tables (surrogate).

pub mod setup;
pub mod mesh;
pub mod tables;
pub mod surrogate;
