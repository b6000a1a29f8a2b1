//! Conducts a whole protocol in one posture.

use thenar_surface::{Product, Vec3};

use super::protocol::Protocol;
use super::protocol_result::{Course, Keep, Step};
use super::row_posture::Stand;
use super::row_stepper::Walk;
use crate::fields::warnings::Warning;
use crate::workspace::Pressing;
use crate::{ContactError, Control};

/// A protocol with what it is done to.
#[derive(Clone, Copy)]
pub struct Run<'a> {
    /// The product, in the frame of the posed positions.
    pub product: &'a Product,
    /// Posed positions, mm, one per prepared vertex; None: the rest pose.
    pub posed: Option<&'a [Vec3]>,
    /// What is done.
    pub protocol: &'a Protocol,
    /// What to keep of every step.
    pub keep: Keep,
}

impl Pressing<'_> {
    /// Follows a protocol from rest, with the effects that are switched on; the tissue remembers from row to row.
    ///
    /// The first row is reached at once; between rows loads grow in straight lines, so rows must be close enough in time for
    /// the fastest thing to be seen. [`Pressing::advance`] does the same one row at a time, with a posture that may move.
    ///
    /// # Errors
    /// [`ContactError::Protocol`] naming the row, those of a press, or `Cancelled`. The workspace stays usable after any of them.
    pub fn run(&mut self, run: &Run<'_>, control: &Control) -> Result<Course, ContactError> {
        run.protocol.validate()?;
        let mut walk = Walk::new(self.skin, run.protocol.direction)?.keeping(run.keep);
        let stand = Stand {
            product: run.product,
            posed: run.posed,
            motion: None,
        };
        let rows = &run.protocol.rows;
        walk.face(self.skin, &stand)?;
        if rows.iter().any(|row| Walk::needs_touch(row.demand)) {
            walk.touch(self.skin, run.product)?;
        }
        let mut steps: Vec<Step> = Vec::with_capacity(rows.len());
        for (row, moment) in rows.iter().enumerate() {
            control.step("protocol", row as f64 / rows.len() as f64)?;
            steps.push(self.take(&mut walk, (run.product, moment), control)?);
        }
        let mut last = walk.contact(self.skin, &stand)?;
        let unsolved = steps.iter().filter(|step| !step.has_converged).count();
        if unsolved > 0 {
            let rows = steps.len();
            last.warnings.push(Warning::UnsolvedRows { unsolved, rows });
        }
        control.step("protocol", 1.0)?;
        Ok(Course {
            steps,
            direction: walk.direction(),
            touch_offset: walk.touch_offset(),
            last,
        })
    }
}
