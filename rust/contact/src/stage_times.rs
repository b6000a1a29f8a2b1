//! Wall time of a press by stage, and what accompanies a press through its stages.

use std::time::Instant;

use crate::Control;

/// Wall time by stage, s.
pub(crate) type Seconds = Vec<(&'static str, f64)>;

/// What accompanies a press: cancellation and progress, and the wall times so far.
pub(crate) struct Watch<'a, 'c> {
    pub control: &'a Control<'c>,
    pub seconds: &'a mut Seconds,
}

/// Adds the time since `started` to a stage.
pub(crate) fn add_time(seconds: &mut Seconds, stage: &'static str, started: Instant) {
    let elapsed = started.elapsed().as_secs_f64();
    match seconds.iter_mut().find(|s| s.0 == stage) {
        Some(entry) => entry.1 += elapsed,
        None => seconds.push((stage, elapsed)),
    }
}
