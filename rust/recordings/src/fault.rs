//! A fault inside a file before the file's name is known to it; words and numbers as they may stand in a message.

use crate::RecordingError;
use std::borrow::Cow;
use std::path::Path;

/// Largest number that is taken for a measurement in any unit; some programs write 1e300 for "no value".
pub(crate) const LARGEST: f64 = 1e30;

/// Longest problem and longest remedy of a message, letters; some libraries quote the file, and some lists are long.
const LONGEST_PART: usize = 600;

/// Where in a file a fault lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    File,
    Line(usize),
    Byte(usize),
}

/// What is wrong, where, and what to do about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Fault {
    place: Place,
    problem: String,
    remedy: Cow<'static, str>,
}

impl Fault {
    pub fn file(problem: String, remedy: impl Into<Cow<'static, str>>) -> Fault {
        Fault::at(Place::File, problem, remedy)
    }

    pub fn line(line: usize, problem: String, remedy: impl Into<Cow<'static, str>>) -> Fault {
        Fault::at(Place::Line(line), problem, remedy)
    }

    pub fn at(place: Place, problem: String, remedy: impl Into<Cow<'static, str>>) -> Fault {
        let mut remedy = remedy.into();
        if remedy.contains(char::is_control) || remedy.len() > LONGEST_PART {
            remedy = printable(&remedy).into();
        }
        Fault {
            place,
            problem: printable(&problem),
            remedy,
        }
    }

    /// What is wrong, without its place.
    pub fn problem(&self) -> &str {
        &self.problem
    }

    /// The same fault of a workbook, whose lines are the rows of one of its sheets.
    pub fn in_sheet(self, sheet: &str) -> Fault {
        let sheet = shown(sheet.as_bytes());
        let problem = match self.place {
            Place::Line(row) => format!("sheet {sheet}, row {row}: {}", self.problem),
            _ => format!("sheet {sheet}: {}", self.problem),
        };
        Fault::at(Place::File, problem, self.remedy)
    }

    pub fn in_file(self, file: &Path) -> RecordingError {
        let (file, problem, remedy) = (file.to_path_buf(), self.problem, self.remedy);
        match self.place {
            Place::File => RecordingError::File {
                file,
                problem,
                remedy,
            },
            Place::Line(line) => RecordingError::Line {
                file,
                line,
                problem,
                remedy,
            },
            Place::Byte(byte) => RecordingError::Byte {
                file,
                byte,
                problem,
                remedy,
            },
        }
    }
}

/// A text without letters that steer a terminal, and of one line: what a file or a library says in it may be anything.
fn printable(text: &str) -> String {
    let seen = |c: char| if c.is_control() { '?' } else { c };
    match text.char_indices().nth(LONGEST_PART) {
        Some((end, _)) => text[..end].chars().map(seen).chain("...".chars()).collect(),
        None => text.chars().map(seen).collect(),
    }
}

/// A word of a file as it may stand in a message: readable and short.
pub(crate) fn shown(word: &[u8]) -> String {
    let text: String = String::from_utf8_lossy(word)
        .chars()
        .take(24)
        .map(|c| if c.is_control() { '?' } else { c })
        .collect();
    if word.len() > 24 {
        format!("'{text}...'")
    } else {
        format!("'{text}'")
    }
}

/// A finite number, or what is wrong with it.
pub(crate) fn number(word: &[u8]) -> Result<f64, String> {
    let value = std::str::from_utf8(word)
        .ok()
        .and_then(|text| text.parse::<f64>().ok());
    match value {
        None => Err(format!("{} is not a number", shown(word))),
        Some(value) if !value.is_finite() => Err(format!("{} is not a finite number", shown(word))),
        Some(value) if value.abs() > LARGEST => Err(format!("{} is out of range", shown(word))),
        Some(value) => Ok(value),
    }
}

/// Words of a line, split at blanks.
pub(crate) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|byte| byte.is_ascii_whitespace())
        .filter(|word| !word.is_empty())
}
