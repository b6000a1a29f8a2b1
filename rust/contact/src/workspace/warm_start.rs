//! Warm-start state: forces and travels of the last solve, offset and slope of the last force search.

use std::sync::Arc;

use crate::interface::pulls::Pull;
use crate::solve::Accuracy;

/// State of the last solve that the next one starts from; a protocol keeps its own. Copies share what is large.
#[derive(Debug, Clone, Default)]
pub struct WarmStart {
    /// Forces and travels of the last solve.
    pub(crate) last: Arc<StartContact>,
    /// Travel found by force control, mm.
    pub(crate) offset: f64,
    /// Slope of the force search at that travel, in its own measure of force per mm.
    pub(crate) slope: Option<f64>,
    /// Attraction of the last row of a protocol.
    pub(crate) pulls: Vec<Pull>,
    /// Accuracy of the solves that start here.
    pub(crate) accuracy: Accuracy,
}

/// A solved contact by site, for the next solve to start from; empty for none.
#[derive(Debug, Clone, Default)]
pub struct StartContact {
    /// Normal force, N.
    pub force: Vec<f64>,
    /// Travel along the site's direction, mm; empty to begin with the undeformed skin all the same.
    pub travel: Vec<f64>,
}
