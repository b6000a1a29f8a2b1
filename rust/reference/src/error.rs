//! What can go wrong in a reference solve.

/// Why a reference solve has no result.
#[derive(Debug, thiserror::Error)]
pub enum ReferenceError {
    /// The tissue cannot be meshed or computed as given.
    #[error("{what}: found {found}; {remedy}")]
    Tissue {
        /// Which input, and where.
        what: String,
        /// The value found there.
        found: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The equations were not solved to their tolerance.
    #[error(
        "the reference solve stopped at {share:.0} % of the depth: {unbalanced:.1} % of the contact force is not balanced, most at skin \
         vertex {vertex}; press less deep, or give thicker tissue there"
    )]
    Unsolved {
        /// How much of the depth was reached, %.
        share: f64,
        /// Norm of the residual over the norm of the contact forces, %.
        unbalanced: f64,
        /// Vertex with the largest residual.
        vertex: usize,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}
