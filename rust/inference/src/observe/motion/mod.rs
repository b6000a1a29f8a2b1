//! The motion of a stage under noisy readings of its depth.

pub(crate) mod by_lines;
pub(crate) mod cut;
pub(crate) mod legs;
pub(crate) mod line;
pub(crate) mod moving_average;
pub(crate) mod rounding;
pub(crate) mod stairs;
pub(crate) mod stiffness;
pub(crate) mod stray;
