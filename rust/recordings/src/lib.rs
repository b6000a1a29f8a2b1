//! Mesh, study and measurement files to arrays with units; the only library crate that reads files.
#![doc = include_str!("../README.md")]

mod text;
mod error;
mod fault;
mod check;
mod pressure_map;
mod source;
mod curve;
mod detection;
mod tables;
mod recording_file;
mod makers;
mod contents;
mod recording;
pub mod handprint;
pub mod meshes;
pub mod plain_file;
pub mod study;

pub use check::Check;
pub use curve::{Channel, Curve, Fact, Segment};
pub use detection::Format;
pub use error::RecordingError;
pub use pressure_map::{Grid, PressureMap, PressureUnit, Sensel, Threshold};
pub use recording::{LARGEST_ARCHIVE, LARGEST_TEXT, read, read_bytes, read_bytes_with, read_with};
pub use recording_file::{ReadOptions, RecordingFile};
pub use source::Source;
pub use study::Study;
pub use tables::mapping::Columns;
