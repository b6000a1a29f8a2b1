//! Opens files that are files: no folder, no pipe, no device, which would hang or never end.

use crate::RecordingError;
use crate::fault::Fault;
use std::fs::File;
use std::path::Path;

/// Opens a file and gives its size, bytes.
///
/// # Errors
/// A file that cannot be opened, or is none.
pub(crate) fn open(file: &Path) -> Result<(File, u64), RecordingError> {
    let unreadable = |source| RecordingError::Unreadable {
        file: file.to_path_buf(),
        source,
    };
    // Before it is opened: opening a pipe waits for whoever writes into it.
    let about = std::fs::metadata(file).map_err(unreadable)?;
    if about.is_dir() {
        let problem = "it is a folder".to_string();
        return Err(Fault::file(problem, "name a measurement file in it").in_file(file));
    }
    if !about.is_file() {
        let problem = "it is a pipe or a device, not a file".to_string();
        return Err(
            Fault::file(problem, "save what it gives to a file, and name that").in_file(file),
        );
    }
    Ok((File::open(file).map_err(unreadable)?, about.len()))
}

/// The bytes of a file of at most `largest` bytes.
///
/// # Errors
/// For what is no plain file or cannot be read, and for a larger file, with `remedy`.
pub fn bytes(file: &Path, largest: u64, remedy: &'static str) -> Result<Vec<u8>, RecordingError> {
    use std::io::Read;
    let unreadable = |source| RecordingError::Unreadable {
        file: file.to_path_buf(),
        source,
    };
    let (opened, size) = open(file)?;
    let mut bytes = Vec::new();
    if size <= largest {
        opened
            .take(largest + 1)
            .read_to_end(&mut bytes)
            .map_err(unreadable)?;
    }
    if size > largest || bytes.len() as u64 > largest {
        let size = size.max(bytes.len() as u64);
        let problem = format!("{size} bytes are more than the {largest} that are read");
        return Err(Fault::file(problem, remedy).in_file(file));
    }
    Ok(bytes)
}
