//! A measurement file of any maker to recordings: opening, telling formats apart by content, limits.

use crate::detection::{Format, HEAD, Kind, kind_of};
use crate::fault::{Fault, shown};
use crate::recording_file::{ReadOptions, RecordingFile};
use crate::tables::curves::Rows;
use crate::text::lines::Lines;
use crate::{RecordingError, contents, makers, plain_file};
use std::io::{BufRead, BufReader, Cursor, Read};
use std::path::Path;

/// Largest text file that is read, bytes; it is read line by line.
pub const LARGEST_TEXT: u64 = 4 << 30;
/// Largest workbook or archive that is read, bytes, packed; it is held in memory.
pub const LARGEST_ARCHIVE: u64 = 128 << 20;

/// Reads a measurement file; its format follows from what it holds, never from its name.
///
/// Memory is bounded: a text is read line by line and may hold 2^26 numbers and lines of 1 MiB; see [`LARGEST_TEXT`] and
/// [`LARGEST_ARCHIVE`].
///
/// # Errors
/// [`RecordingError`] if the file cannot be read, is of no format that is known, breaks its format, or is too large.
pub fn read(file: &Path) -> Result<RecordingFile, RecordingError> {
    read_with(file, &ReadOptions::default())
}

/// As [`read`], with what a user says about the file.
///
/// # Errors
/// As [`read`], and for a column or a run that the file does not hold.
pub fn read_with(file: &Path, options: &ReadOptions) -> Result<RecordingFile, RecordingError> {
    let (opened, size) = plain_file::open(file)?;
    read_from(BufReader::with_capacity(1 << 16, opened), size, options)
        .map_err(|fault| fault.in_file(file))
}

/// Reads a recording from the bytes of a file that is called `file` in messages.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(bytes: &[u8], file: &Path) -> Result<RecordingFile, RecordingError> {
    read_bytes_with(bytes, file, &ReadOptions::default())
}

/// As [`read_bytes`], with what a user says about the file.
///
/// # Errors
/// As [`read_with`].
pub fn read_bytes_with(
    bytes: &[u8],
    file: &Path,
    options: &ReadOptions,
) -> Result<RecordingFile, RecordingError> {
    read_from(bytes, bytes.len() as u64, options).map_err(|fault| fault.in_file(file))
}

fn read_from(
    mut source: impl BufRead,
    size: u64,
    options: &ReadOptions,
) -> Result<RecordingFile, Fault> {
    let mut head = Vec::new();
    let stopped = |error| Fault::file(format!("reading stopped ({error})"), "check the disk");
    let reading = (&mut source).take(HEAD as u64).read_to_end(&mut head);
    reading.map_err(stopped)?;
    let kind = kind_of(&head, &options.columns)?;
    let limit = match kind {
        Kind::Text(_) => LARGEST_TEXT,
        Kind::Zip | Kind::OldWorkbook => LARGEST_ARCHIVE,
    };
    if size > limit {
        let problem = format!("{size} bytes are more than the {limit} that are read");
        return Err(Fault::file(
            problem,
            "export a shorter part of the recording",
        ));
    }
    let whole = Cursor::new(head).chain(source);
    let read = match kind {
        Kind::Text(format) => {
            let mut lines = Lines::new(whole);
            contents::read_text(&mut lines, format, (&options.columns, Rows::Whole))
        }
        Kind::Zip | Kind::OldWorkbook => {
            let mut bytes = Vec::new();
            whole.take(limit).read_to_end(&mut bytes).map_err(stopped)?;
            read_archive(bytes, kind, options)
        }
    };
    read.and_then(with_samples)
        .and_then(|file| only_run(file, options))
}

fn read_archive(bytes: Vec<u8>, kind: Kind, options: &ReadOptions) -> Result<RecordingFile, Fault> {
    if kind == Kind::Zip && makers::jpk::is_jpk(&bytes)? {
        if !options.columns.is_empty() {
            let problem = format!("{} names its columns itself", Format::JpkArchive.name());
            return Err(Fault::file(problem, "take the names of columns out"));
        }
        return makers::jpk::read(bytes, options.run.as_deref());
    }
    contents::read_workbook(bytes, &options.columns)
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

/// The run that is wanted, if one is.
fn only_run(file: RecordingFile, options: &ReadOptions) -> Result<RecordingFile, Fault> {
    let Some(wanted) = &options.run else {
        return Ok(file);
    };
    let names: Vec<String> = file.curves.iter().map(|curve| curve.name.clone()).collect();
    let curves: Vec<_> = file
        .curves
        .into_iter()
        .filter(|curve| curve.name == *wanted)
        .collect();
    if curves.len() == 1 {
        return Ok(RecordingFile { curves, ..file });
    }
    let problem = format!(
        "{} of its runs are called {}",
        curves.len(),
        shown(wanted.as_bytes())
    );
    Err(Fault::file(problem, listed(&names)))
}

/// The names of the runs, as many as a message can hold.
pub(crate) fn listed(names: &[String]) -> String {
    if names.iter().all(String::is_empty) {
        return "take run out: its run has no name".into();
    }
    let shown: Vec<String> = names
        .iter()
        .take(8)
        .map(|name| shown(name.as_bytes()))
        .collect();
    let more = if names.len() > 8 { ", ..." } else { "" };
    format!("give run as one of {}{more}", shown.join(", "))
}
