//! Searches the travel at which a dragged product reaches a shear force.

use thenar_surface::Vec3;

use super::stick_slip::{StickSlipProblem, StickSlipStep};
use crate::Control;

/// Share of a force target within which the search ends.
const FORCE_TOLERANCE: f64 = 1e-9;
/// Most solves of one search.
const MOST_SOLVES: usize = 60;

/// The search for the travel at which a force is reached.
pub struct DragSearch<'a, 'c> {
    /// The contact.
    pub grip: &'a StickSlipProblem<'a>,
    /// Travel of the product before, by site, mm.
    pub from: &'a [Vec3],
    /// Where it goes, by site, per unit of travel.
    pub direction: &'a [Vec3],
    /// The force is measured along this unit vector.
    pub along: Vec3,
    /// Asked whether to go on.
    pub control: &'a Control<'c>,
    /// Shear forces to start from, in the planes.
    pub start: Vec<f64>,
    /// Slip before, in the planes, mm.
    pub before: Vec<f64>,
}

impl DragSearch<'_, '_> {
    fn at(&mut self, travel: f64) -> (f64, StickSlipStep) {
        let to: Vec<Vec3> = self
            .from
            .iter()
            .zip(self.direction)
            .map(|(from, d)| from + d * travel)
            .collect();
        let end = self
            .grip
            .drag_on((&self.before, &self.start), &to, self.control);
        let forces: Vec<Vec3> = end.traces.iter().map(|t| t.force).collect();
        self.start = self.grip.flat(&forces);
        (end.force().dot(&self.along), end)
    }

    /// Secant within a bracket (Illinois); the force grows with the travel, ever more slowly.
    pub fn find(&mut self, newton: f64) -> (f64, StickSlipStep) {
        let (force, mut end) = self.at(0.0);
        let mut low = (0.0, force - newton);
        if low.1 == 0.0 {
            return (0.0, end);
        }
        let mut step = self.first_step(newton).copysign(-low.1);
        let mut high = low;
        for _ in 0..MOST_SOLVES {
            let (force, reached) = self.at(high.0 + step);
            (high, end) = ((high.0 + step, force - newton), reached);
            if (high.1 < 0.0) != (low.1 < 0.0) {
                break;
            }
            low = high;
            step *= 2.0;
        }
        for _ in 0..MOST_SOLVES {
            if high.1.abs() <= FORCE_TOLERANCE * newton.abs() || (self.control.cancelled)() {
                break;
            }
            let middle = low.0 - low.1 * (high.0 - low.0) / (high.1 - low.1);
            let (force, reached) = self.at(middle);
            let value = force - newton;
            if (value < 0.0) == (high.1 < 0.0) {
                low.1 *= 0.5;
            } else {
                low = high;
            }
            (high, end) = ((middle, value), reached);
        }
        (high.0, end)
    }

    /// Travel of a contact that sticks all over, from the stiffness of a disc of its size, mm.
    fn first_step(&self, newton: f64) -> f64 {
        let n = self.grip.limit.len();
        let mean: f64 = (0..n).map(|i| self.grip.matrix.own(i)).sum::<f64>() / n as f64;
        (newton.abs() * mean / (n as f64).sqrt()).max(1e-9)
    }
}

impl StickSlipProblem<'_> {
    /// Drags along `direction` (by site, per unit of travel) until the shear force along it is `newton`.
    ///
    /// Returns the travel and the step, or None if friction cannot hold that much.
    pub fn drag_to_force(
        &self,
        from: &[Vec3],
        (direction, along, newton): (&[Vec3], Vec3, f64),
        control: &Control,
    ) -> Option<(f64, StickSlipStep)> {
        let start = self.start();
        let before = self.slip_before(&start, from);
        let most: f64 = self
            .tangents
            .iter()
            .zip(self.limit)
            .map(|([a, b], limit)| limit * along.dot(a).hypot(along.dot(b)))
            .sum();
        if newton >= most {
            return None;
        }
        let mut search = DragSearch {
            grip: self,
            from,
            direction,
            along,
            control,
            start,
            before,
        };
        Some(search.find(newton))
    }
}
