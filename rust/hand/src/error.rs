//! What can go wrong when a hand is made.

use thiserror::Error;

/// Why no hand could be made.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum HandError {
    /// A measurement is not a number, or no hand has it.
    #[error("{what} is {found} {unit}; give a value from {low} to {high} {unit}")]
    OutOfRange {
        /// Which measurement.
        what: &'static str,
        /// Its unit, empty for the percentile.
        unit: &'static str,
        /// What was given.
        found: f64,
        /// Smallest value taken.
        low: f64,
        /// Largest value taken.
        high: f64,
    },
    /// The surface did not close; the spacing does not suit the measurements.
    #[error("the skin did not close at a spacing of {spacing_mm} mm; use a spacing nearer 2.5 mm")]
    NotClosed {
        /// The spacing asked for, mm.
        spacing_mm: f64,
    },
    /// The finished surface was refused as a mesh.
    #[error("the skin is no valid mesh: {0}")]
    Mesh(#[from] thenar_surface::MeshError),
}
