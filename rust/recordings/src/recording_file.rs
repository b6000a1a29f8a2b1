//! What a measurement file holds, and what a user says about it before it is read.

use crate::curve::Curve;
use crate::detection::Format;
use crate::pressure_map::PressureMap;
use crate::tables::mapping::Columns;

/// What one measurement file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordingFile {
    /// Whose format it is.
    pub format: Format,
    /// Pressure recordings, one per mat.
    pub maps: Vec<PressureMap>,
    /// Indenter recordings, one per run.
    pub curves: Vec<Curve>,
    /// What of the file was not read and why, a sentence each.
    pub notes: Vec<String>,
}

/// What a user says about a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadOptions {
    /// Columns of a table by name.
    pub columns: Columns,
    /// The one run that is wanted of a file with several; all if not given.
    pub run: Option<String>,
}

impl RecordingFile {
    pub(crate) fn of_maps(format: Format, maps: Vec<PressureMap>) -> RecordingFile {
        RecordingFile {
            format,
            maps,
            curves: Vec::new(),
            notes: Vec::new(),
        }
    }

    pub(crate) fn of_curves(format: Format, curves: Vec<Curve>) -> RecordingFile {
        RecordingFile {
            format,
            maps: Vec::new(),
            curves,
            notes: Vec::new(),
        }
    }
}
