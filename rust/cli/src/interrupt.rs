//! Ctrl-C: asks the work to stop, and ends the process if it does not hear soon. Never in the middle of writing.

use crate::fault::Fault;
use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// How long the work may take to hear that it is to stop; below the 0.2 s that users are promised.
const GRACE: Duration = Duration::from_millis(120);

static IS_CANCELLED: AtomicBool = AtomicBool::new(false);
/// True once the results are written; held while they are.
static IS_WRITTEN: Mutex<bool> = Mutex::new(false);

/// Watches Ctrl-C from now on.
///
/// # Errors
/// If the operating system refuses.
pub fn watch() -> Result<(), Fault> {
    let end = || {
        IS_CANCELLED.store(true, Ordering::Relaxed);
        std::thread::sleep(GRACE);
        let is_written = IS_WRITTEN.lock().unwrap_or_else(PoisonError::into_inner);
        if !*is_written {
            let fault = Fault::cancelled();
            fault.complain();
            exit(fault.code());
        }
    };
    let refused = |error| {
        Fault::Other(format!(
            "Ctrl-C cannot be watched ({error}); start it from a terminal"
        ))
    };
    ctrlc::set_handler(end).map_err(refused)
}

/// True once Ctrl-C was pressed.
pub fn is_cancelled() -> bool {
    IS_CANCELLED.load(Ordering::Relaxed)
}

/// Runs `write` unless Ctrl-C was pressed before; from then on Ctrl-C waits for it.
///
/// # Errors
/// What `write` returns, or that the work was cancelled.
pub fn writing(write: impl FnOnce() -> Result<(), Fault>) -> Result<(), Fault> {
    let mut is_written = IS_WRITTEN.lock().unwrap_or_else(PoisonError::into_inner);
    if is_cancelled() {
        // The handler owns the message and the exit code; wait for it.
        drop(is_written);
        std::thread::sleep(10 * GRACE);
        return Err(Fault::cancelled());
    }
    write()?;
    *is_written = true;
    Ok(())
}
