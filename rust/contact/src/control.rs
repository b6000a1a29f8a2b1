//! Progress and cancellation of a long run.

use crate::ContactError;

/// Cancellation and progress of one call.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// Asked often; true stops the run with [`ContactError::Cancelled`].
    pub cancelled: &'a (dyn Fn() -> bool + Sync),
    /// Told the stage and its share done, 0 to 1, never decreasing within a call.
    pub progress: &'a (dyn Fn(&str, f64) + Sync),
}

impl Control<'static> {
    /// Never cancels, tells nobody.
    pub fn none() -> Self {
        Control {
            cancelled: &|| false,
            progress: &|_, _| {},
        }
    }
}

impl Control<'_> {
    /// # Errors
    /// [`ContactError::Cancelled`] if the caller asked to stop.
    pub fn check(&self) -> Result<(), ContactError> {
        if (self.cancelled)() {
            Err(ContactError::Cancelled)
        } else {
            Ok(())
        }
    }

    /// Reports progress, then checks for cancellation.
    ///
    /// # Errors
    /// [`ContactError::Cancelled`] if the caller asked to stop.
    pub fn step(&self, stage: &str, fraction: f64) -> Result<(), ContactError> {
        (self.progress)(stage, fraction.clamp(0.0, 1.0));
        self.check()
    }
}
