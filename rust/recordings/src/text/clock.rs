//! Times of frames or samples, which must increase.

use crate::fault::Fault;

/// Times so far, s.
#[derive(Debug, Default)]
pub(crate) struct Clock(Vec<f64>);

impl Clock {
    /// Adds the time of the frame that stands on `line`.
    pub fn push(&mut self, line: usize, time_s: f64) -> Result<(), Fault> {
        if let Some(last) = self.0.last().filter(|last| time_s <= **last) {
            let problem = format!("time does not increase: {time_s} s follows {last} s");
            return Err(Fault::line(
                line,
                problem,
                "sort the rows by time, and remove what was recorded twice",
            ));
        }
        self.0.push(time_s);
        Ok(())
    }

    pub fn last(&self) -> Option<f64> {
        self.0.last().copied()
    }

    pub fn times(self) -> Vec<f64> {
        self.0
    }
}
