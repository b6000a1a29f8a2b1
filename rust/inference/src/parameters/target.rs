//! What a parameter belongs to: a region, a recording, or the instrument.

/// What an estimate belongs to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Target {
    /// The material of a region, by name.
    Region(String),
    /// A recording, by name: its contact zero, or pose.
    Recording(String),
    /// The instrument.
    Instrument,
}
