//! The motion of a stage under noisy readings of its depth.

pub(crate) mod by_lines;
pub(crate) mod legs;
pub(crate) mod line;
