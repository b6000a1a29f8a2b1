//! Recordings compared with their simulation: measures, residuals by variable, frames, and the largest residuals.
//!
//! A mat is compared as its instrument would show it: what lies under its threshold counts as nothing on both sides, and
//! what clips counts as the ceiling on both sides. A map without calibration is compared by shape alone: the simulation is
//! scaled to the sum of the reading.

pub mod quantities;
pub mod recording_fit;
pub mod instrument_view;
pub mod series;
pub mod measures;
pub mod trends;
pub mod shown_frames;
pub mod worst_places;
pub mod scan_heights;
pub mod residual_on_skin;
pub mod result;
pub mod sentence;
pub mod compare_fit;
pub mod single_frame;

pub use compare_fit::compare_fit;
pub use quantities::{Kind, Measure, WorstPlace};
pub use residual_on_skin::on_skin;
pub use result::{Compared, Comparison, Frame, RecordingComparison, Series};
pub use scan_heights::Scanned;
pub use single_frame::{Still, compare_still};
pub use trends::{Bin, SIGNIFICANT, Trend, Variable};
