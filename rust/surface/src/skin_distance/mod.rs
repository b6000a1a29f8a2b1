//! A coarse table of distances along a skin.

pub(crate) mod patches;
pub(crate) mod shortest_paths;
pub(crate) mod table;
