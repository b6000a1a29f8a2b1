//! Warm-start state: forces and travels of the last solve, offset and slope of the last force search.

use crate::interface::pulls::Pull;
use crate::solve::Accuracy;

/// Where one solve ended, for the next to start from; a walk through a protocol keeps its own.
#[derive(Debug, Clone, Default)]
pub struct WarmStart {
    /// What the last solve found.
    pub last: StartContact,
    /// Travel found by force control, mm.
    pub offset: f64,
    /// Slope there of the search for it, in its own terms per mm.
    pub slope: Option<f64>,
    /// Attraction of the last row of a protocol.
    pub pulls: Vec<Pull>,
    /// How far solves go from here.
    pub accuracy: Accuracy,
}

/// A solved contact by site, for the next solve to start from; empty for none.
#[derive(Debug, Clone, Default)]
pub struct StartContact {
    /// Normal force, N.
    pub force: Vec<f64>,
    /// Travel along the site's direction, mm; empty to begin with the undeformed skin all the same.
    pub travel: Vec<f64>,
}
