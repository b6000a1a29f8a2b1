//! The prepared hand: sites, regions, materials, and the tissue after effects.

pub mod arc_length;
pub mod materials;
pub mod merged_vertices;
pub mod parameters;
pub mod prepare;
pub mod sites;
pub mod tissue;
