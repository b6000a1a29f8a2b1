//! Stages 1 and 2: gaps to the product, active zone, press direction of each site.

pub mod active_zone;
pub mod gaps;
pub mod graph_diffusion;
pub mod press_direction;
