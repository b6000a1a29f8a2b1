//! A measurement file of any maker to recordings: opening, telling formats apart by content, limits.

use crate::curve::Curve;
use crate::detection::{Format, HEAD, format_of};
use crate::fault::Fault;
use crate::lines::Lines;
use crate::pressure_map::PressureMap;
use crate::{RecordingError, makers, tables};
use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Read};
use std::path::Path;

/// Largest text file that is read, bytes; it is read line by line.
pub const LARGEST_TEXT: u64 = 4 << 30;
/// Largest workbook or archive that is read, bytes, packed; it is held in memory.
pub const LARGEST_ARCHIVE: u64 = 128 << 20;

/// What one measurement file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordingFile {
    /// Whose format it is.
    pub format: Format,
    /// Pressure recordings, one per mat.
    pub maps: Vec<PressureMap>,
    /// Indenter recordings, one per run.
    pub curves: Vec<Curve>,
}

impl RecordingFile {
    pub(crate) fn of_maps(format: Format, maps: Vec<PressureMap>) -> RecordingFile {
        RecordingFile {
            format,
            maps,
            curves: Vec::new(),
        }
    }

    pub(crate) fn of_curves(format: Format, curves: Vec<Curve>) -> RecordingFile {
        RecordingFile {
            format,
            maps: Vec::new(),
            curves,
        }
    }
}

/// Reads a measurement file; its format follows from what it holds, never from its name.
///
/// Memory is bounded: a text is read line by line and may hold 2^26 numbers and lines of 1 MiB; see [`LARGEST_TEXT`] and
/// [`LARGEST_ARCHIVE`].
///
/// # Errors
/// [`RecordingError`] if the file cannot be read, is of no format that is known, breaks its format, or is too large.
pub fn read(file: &Path) -> Result<RecordingFile, RecordingError> {
    let unreadable = |source| RecordingError::Unreadable {
        file: file.to_path_buf(),
        source,
    };
    let opened = File::open(file).map_err(unreadable)?;
    let about = opened.metadata().map_err(unreadable)?;
    if about.is_dir() {
        let problem = "it is a folder".to_string();
        return Err(Fault::file(problem, "name a measurement file in it").in_file(file));
    }
    read_from(BufReader::with_capacity(1 << 16, opened), about.len())
        .map_err(|fault| fault.in_file(file))
}

/// Reads a recording from the bytes of a file that is called `file` in messages.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(bytes: &[u8], file: &Path) -> Result<RecordingFile, RecordingError> {
    read_from(bytes, bytes.len() as u64).map_err(|fault| fault.in_file(file))
}

fn read_from(mut source: impl BufRead, size: u64) -> Result<RecordingFile, Fault> {
    let mut head = Vec::new();
    let reading = (&mut source).take(HEAD as u64).read_to_end(&mut head);
    reading.map_err(|error| Fault::file(format!("reading stopped ({error})"), "check the disk"))?;
    let format = format_of(&head)?;
    let limit = if format.is_archive() {
        LARGEST_ARCHIVE
    } else {
        LARGEST_TEXT
    };
    if size > limit {
        let problem = format!("{size} bytes are more than the {limit} that are read");
        return Err(Fault::file(
            problem,
            "export a shorter part of the recording",
        ));
    }
    let whole = Cursor::new(head).chain(source);
    if format.is_archive() {
        let mut bytes = Vec::new();
        let reading = whole.take(limit).read_to_end(&mut bytes);
        reading
            .map_err(|error| Fault::file(format!("reading stopped ({error})"), "check the disk"))?;
        return makers::read_archive(format, bytes).and_then(with_samples);
    }
    let mut lines = Lines::new(whole);
    let read = match format {
        Format::CurveTable => tables::curves::read(&mut lines),
        Format::MapTable => tables::maps::read(&mut lines),
        _ => makers::read_text(format, &mut lines),
    };
    read.and_then(with_samples)
}

/// Refuses a curve none of whose columns could be kept.
fn with_samples(file: RecordingFile) -> Result<RecordingFile, Fault> {
    if file.curves.iter().all(|curve| curve.samples() > 0) {
        return Ok(file);
    }
    let problem = "no column holds numbers with a unit that is known".to_string();
    Err(Fault::file(
        problem,
        "export time, force and length with their units",
    ))
}
