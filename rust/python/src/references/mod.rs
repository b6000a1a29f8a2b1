//! What the layer model is held against: a ball on a flat layer, and tissue as a solid.

pub mod ball;
pub mod solid;
