//! Stages 1 and 2: gaps to the product, the active zone and the direction in which each vertex is pressed.

pub mod active_zone;
pub mod gaps;
pub mod graph_diffusion;
pub mod press_direction;
