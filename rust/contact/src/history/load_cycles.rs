//! Loading cycles of a protocol: work put in and energy lost.

use super::protocol_result::Course;

/// Force below which the product counts as off the skin, over the largest of the course.
const OFF: f64 = 1e-4;

/// One cycle: from one row without force to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    /// Time of the last row without force before it, s.
    pub start_s: f64,
    /// Time of the first row without force after it, s.
    pub end_s: f64,
    /// Most work done on the skin on the way, N mm.
    pub work: f64,
    /// Work that did not come back, N mm.
    pub loss: f64,
}

impl Cycle {
    /// Share of the work that was lost; 0 without work.
    pub fn share(&self) -> f64 {
        if self.work > 0.0 {
            self.loss / self.work
        } else {
            0.0
        }
    }
}

impl Course {
    /// The cycles that begin and end without force, in their order; what the course is in the middle of at either end is
    /// none.
    ///
    /// Work is summed by trapezoids over the rows, so rows must be dense where force bends. Work of a posture that moves by
    /// itself is not in it.
    pub fn cycles(&self) -> Vec<Cycle> {
        let most = self
            .steps
            .iter()
            .map(|s| s.total_force.norm())
            .fold(0.0, f64::max);
        let is_off = |k: usize| self.steps[k].total_force.norm() <= OFF * most;
        let mut cycles = Vec::new();
        let mut begun = None;
        for k in 0..self.steps.len() {
            if !is_off(k) {
                continue;
            }
            if let Some(start) = begun.filter(|start| k > start + 1) {
                cycles.push(self.cycle(start, k));
            }
            begun = Some(k);
        }
        cycles
    }

    fn cycle(&self, start: usize, end: usize) -> Cycle {
        let steps = &self.steps[start..=end];
        let before = steps[0].work;
        let most = steps.iter().map(|s| s.work - before).fold(0.0, f64::max);
        Cycle {
            start_s: steps[0].time_s,
            end_s: steps[steps.len() - 1].time_s,
            work: most,
            loss: steps[steps.len() - 1].work - before,
        }
    }
}
