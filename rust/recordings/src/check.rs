//! What a file says of its own totals, held against what its values add up to.

use std::fmt;

/// One kind of total, compared over all frames that state it.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// What was compared: `total force`, `raw sum`.
    pub what: &'static str,
    /// Unit of the differences.
    pub unit: &'static str,
    /// Totals that the file states.
    pub compared: usize,
    /// Largest absolute difference between the file's total and ours, in `unit`.
    pub largest_difference: f64,
    /// Frame of that difference, from 0.
    pub frame: usize,
    /// Difference that the rounding of the file explains, in `unit`.
    pub tolerance: f64,
}

impl Check {
    /// A check before the first comparison.
    pub(crate) fn new(what: &'static str, unit: &'static str, tolerance: f64) -> Check {
        Check {
            what,
            unit,
            compared: 0,
            largest_difference: 0.0,
            frame: 0,
            tolerance,
        }
    }

    pub(crate) fn compare(&mut self, frame: usize, stated: f64, ours: f64) {
        let difference = (stated - ours).abs();
        if difference > self.largest_difference || self.compared == 0 {
            self.largest_difference = difference;
            self.frame = frame;
        }
        self.compared += 1;
    }

    /// Whether every stated total is within the tolerance of ours.
    pub fn agrees(&self) -> bool {
        // A total rounded to 0.01 may be off by exactly half of that, in decimals.
        self.largest_difference <= self.tolerance * (1.0 + 1e-6)
    }
}

impl fmt::Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Four digits at most: a tolerance that was converted from another unit has many.
        let tolerance = format!("{:.4}", self.tolerance);
        let tolerance = tolerance.trim_end_matches('0').trim_end_matches('.');
        let verdict = if self.agrees() { "agrees" } else { "disagrees" };
        write!(
            f,
            "{} of {} frames {verdict} with the file's own: {:.3} {} apart at most (frame {}), {} {} allowed",
            self.what,
            self.compared,
            self.largest_difference,
            self.unit,
            self.frame,
            tolerance,
            self.unit
        )
    }
}
