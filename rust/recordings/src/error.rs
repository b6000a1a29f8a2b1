//! Why a file could not be read: which file, where in it, what is wrong, what to do.

use std::borrow::Cow;
use std::path::PathBuf;

/// A file that could not be turned into arrays.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The file cannot be opened or read at all.
    #[error("{}: cannot be read ({source}); check the name and your rights to it", file.display())]
    Unreadable {
        /// The file that was asked for.
        file: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The file as a whole is not what it should be.
    #[error("{}: {problem}; {remedy}", file.display())]
    File {
        /// The file that was read.
        file: PathBuf,
        /// What is wrong.
        problem: String,
        /// What to do about it.
        remedy: Cow<'static, str>,
    },
    /// One line of a text file is wrong.
    #[error("{}, line {line}: {problem}; {remedy}", file.display())]
    Line {
        /// The file that was read.
        file: PathBuf,
        /// Line number, from 1.
        line: usize,
        /// What is wrong.
        problem: String,
        /// What to do about it.
        remedy: Cow<'static, str>,
    },
    /// One place of a binary file is wrong.
    #[error("{}, byte {byte}: {problem}; {remedy}", file.display())]
    Byte {
        /// The file that was read.
        file: PathBuf,
        /// Offset from the start of the file, from 0.
        byte: usize,
        /// What is wrong.
        problem: String,
        /// What to do about it.
        remedy: Cow<'static, str>,
    },
}
