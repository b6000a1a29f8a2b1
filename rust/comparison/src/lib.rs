//! Recordings compared with their simulation: measures, residuals, where they exceed noise, handprints; reads no files.
#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod center_of_pressure;
mod comparison;
mod location;
mod parameter_words;
mod prints;
mod compare;

pub use compare::compare;
pub use comparison::{
    Bin, Compared, Comparison, Frame, Kind, Measure, RecordingComparison, SIGNIFICANT, Scanned,
    Series, Still, Trend, Variable, WorstPlace, compare_fit, compare_still, on_skin,
};
pub use location::locate::{Search, locate};
pub use location::mismatch::{Carrier, Location, Mismatch, Place, Shown, When};
pub use parameter_words::of_what;
pub use prints::{PosePart, Pressed, PrintRegion, Printed, StillPrint, compare_print};
