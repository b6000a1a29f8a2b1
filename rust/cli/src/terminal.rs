//! What is written to the terminal.

use crate::fault::printable;
use std::io::Write;

/// Writes to the terminal; a reader that has gone away (`thenar ... | head`) is no fault.
pub fn write(text: &str) {
    let _ = std::io::stdout().write_all(printable(text).as_bytes());
}
