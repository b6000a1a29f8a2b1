//! The prepared hand: vertices of the skin, regions, materials and the tissue that the effects leave.

pub mod arc_length;
pub mod materials;
pub mod merged_vertices;
pub mod parameters;
pub mod prepare;
pub mod sites;
pub mod tissue;
