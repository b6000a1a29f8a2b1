//! Mesh, study and measurement files to arrays with units; the only library crate that reads files.
//!
//! Knows nothing of physics or of Blender. Every error names the file, the line or byte, and the remedy.
//! [`study::Study`] loads a folder of recordings with their setting. [`read`] tells a maker's format by what a file holds and gives [`PressureMap`]s or [`Curve`]s.

mod error;
mod fault;
mod lines;
mod fields;
mod units;
mod clock;
mod check;
mod pressure_map;
mod curve;
mod detection;
mod tables;
mod makers;
mod recording;
pub mod handprint;
pub mod meshes;
pub mod study;

pub use check::Check;
pub use curve::{Channel, Curve, Fact, Segment};
pub use detection::Format;
pub use error::RecordingError;
pub use pressure_map::{Grid, PressureMap, PressureUnit, Sensel, Source, Threshold};
pub use recording::{LARGEST_ARCHIVE, LARGEST_TEXT, RecordingFile, read, read_bytes};
pub use study::Study;
