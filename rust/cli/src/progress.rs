//! The line that tells how far the work is, on a terminal only.

use std::io::{IsTerminal, Write};
use std::sync::{Mutex, PoisonError};

/// Shows stage and share on standard error; nothing where that is no terminal.
pub struct ProgressLine {
    shown: Mutex<Option<String>>,
    is_terminal: bool,
}

impl ProgressLine {
    /// A line that shows nothing yet.
    pub fn new() -> ProgressLine {
        ProgressLine {
            shown: Mutex::new(None),
            is_terminal: std::io::stderr().is_terminal(),
        }
    }

    /// Shows a stage and the share of the whole work that is done, 0 to 1.
    pub fn show(&self, stage: &str, share: f64) {
        if !self.is_terminal {
            return;
        }
        let line = format!("{stage} {:.0} %", 100.0 * share.clamp(0.0, 1.0));
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        if shown.as_ref() != Some(&line) {
            let _ = write!(std::io::stderr(), "\r\x1b[K{line}");
            *shown = Some(line);
        }
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        let shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        if shown.is_some() {
            let _ = write!(std::io::stderr(), "\r\x1b[K");
        }
    }
}
