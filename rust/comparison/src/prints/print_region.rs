//! Contact areas of one region of the hand.

/// Contact of one region, by the areas of its vertices.
#[derive(Debug, Clone, PartialEq)]
pub struct PrintRegion {
    /// Its name.
    pub name: String,
    /// Inked, mm2.
    pub recorded_mm2: f64,
    /// In simulated contact, mm2.
    pub simulated_mm2: f64,
    /// Both over either.
    pub overlap: f64,
}
