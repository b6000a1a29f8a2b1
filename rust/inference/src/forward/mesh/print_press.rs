//! The press of a handprint: positions and forces by vertex.

use thenar_contact::{Control, Demand, Material};
use thenar_surface::Vec3;

use crate::errors::InferenceError;
use crate::forward::mesh::press_key::Key;
use crate::forward::mesh::replay::Replay;

/// How hard it was pressed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Demanded {
    /// mm beyond first touch.
    Depth(f64),
    /// N.
    Force(f64),
}

/// A contact by vertex of the skin.
#[derive(Debug, Clone, PartialEq)]
pub struct PrintPress {
    /// Positions in contact, mm, in the tool's own frame.
    pub positions: Vec<Vec3>,
    /// Normal force, N.
    pub force_n: Vec<f64>,
}

impl Replay {
    /// The skin of a study, at rest at `rest`, with the tool of a recording pressed on it.
    ///
    /// # Errors
    /// What the contact model says of the press, or `Cancelled`.
    pub fn print_press(
        &mut self,
        (recording, rest): (usize, &[Vec3]),
        (materials, demanded): (&[Material], Demanded),
        control: &Control<'_>,
    ) -> Result<PrintPress, InferenceError> {
        let what = format!("recording '{}'", self.observed.measured[recording].name);
        let key = Key {
            materials: materials.to_vec(),
            effects: self.lasting(),
        };
        let demand = match demanded {
            Demanded::Depth(depth) => Demand::Depth(depth),
            Demanded::Force(force) => Demand::Force(force),
        };
        let at = self.place_of[recording];
        let contact = self.pressed_by(at, (&key, &[demand]), (&what, control))?;
        let travel = contact.direction * contact.offset;
        let moved = rest.iter().zip(&contact.displacement);
        Ok(PrintPress {
            positions: moved.map(|(at, by)| at + by - travel).collect(),
            force_n: contact.nodal_force,
        })
    }
}
