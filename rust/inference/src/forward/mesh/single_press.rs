//! One press of a tool, row by row; returns the last contact in full.

use thenar_contact::{Contact, Control, Demand, Keep, Protocol, Row, Run};
use thenar_surface::Vec3;

use crate::errors::InferenceError;
use crate::forward::mesh::press_key::Key;
use crate::forward::mesh::replay::Replay;

impl Replay {
    /// The tool of a place pressed as each of `demands` asks, a second apart, on the skin with the materials and effects of `key`. `what` is
    /// named if it fails.
    ///
    /// # Errors
    /// What the contact model says of the press, or `Cancelled`.
    pub(crate) fn pressed_by(
        &mut self,
        at: usize,
        (key, demands): (&Key, &[Demand]),
        (what, control): (&str, &Control<'_>),
    ) -> Result<Contact, InferenceError> {
        self.turn_skin(key, (what, control))?;
        let place = &self.places[at];
        let row = |(second, demand): (usize, &Demand)| Row {
            time_s: second as f64,
            demand: *demand,
            slide: Vec3::zeros(),
        };
        let protocol = Protocol {
            rows: demands.iter().enumerate().map(row).collect(),
            direction: Some(place.direction),
        };
        let run = Run {
            product: &place.tool,
            posed: None,
            protocol: &protocol,
            keep: Keep::Totals,
        };
        let quiet = Control {
            cancelled: control.cancelled,
            progress: &|_, _| {},
        };
        let mut skin = self.tissue.workspace.on(&self.tissue.skin);
        let course = skin.run(&run, &quiet);
        Ok(course.map_err(InferenceError::of_contact(what))?.last)
    }
}
