//! Numbers of moments and frames to which long recordings are thinned.

/// Moments of an indentation that are compared; one that has not half more keeps them all.
pub(crate) const MOST_MOMENTS: usize = 100;

/// The same of frames of a map.
pub(crate) const MOST_FRAMES: usize = 40;
