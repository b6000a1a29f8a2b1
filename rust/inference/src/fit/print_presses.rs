//! Presses for handprints with the materials of a fit, and the empty fit of a study without fitted recordings.

use nalgebra::DMatrix;
use thenar_contact::{Control, Material};
use thenar_surface::Vec3;

use crate::errors::InferenceError;
use crate::fit::fitting::Fitting;
use crate::fit::result::Fit;
use crate::forward::mesh::print_press::{Demanded, PrintPress};
use crate::observe::measured::Measured;
use crate::parameters::estimate::Estimate;

impl Fit {
    /// Recordings beside which no value is simulated, and of which no number is fitted.
    pub fn of_nothing(measured: Vec<Measured>, notes: Vec<String>) -> Fit {
        let empty = || vec![Vec::new(); measured.len()];
        Fit {
            simulated: empty(),
            before: empty(),
            sigma: empty(),
            projected: empty(),
            absorbed: DMatrix::zeros(0, 0),
            estimates: Vec::new(),
            lack_of_fit_p: None,
            measured,
            notes,
        }
    }
}

impl Fitting {
    /// What stands for a fit of a study of which nothing is fitted.
    pub fn unfitted(&self) -> Fit {
        let mut notes = self.replay.tissue.notes.clone();
        notes.push(
            "Nothing was fitted: handprints say where skin touched, and the simulation is that of the study's own materials."
                .to_owned(),
        );
        Fit::of_nothing(self.replay.observed.measured.clone(), notes)
    }

    /// The press of a print with the study's own materials, and with those of a fit.
    ///
    /// `rest` are the skin's positions before contact.
    ///
    /// # Errors
    /// What the contact model says of a press, or `Cancelled`.
    pub fn presses(
        &mut self,
        recording: usize,
        (rest, demanded, estimates): (&[Vec3], Demanded, &[Estimate]),
        control: &Control<'_>,
    ) -> Result<[PrintPress; 2], InferenceError> {
        let start = self.replay.tissue.materials.clone();
        let fitted = self.replay.tissue.fitted_materials(estimates);
        let mut press = |materials: &[Material]| {
            let how = (materials, demanded);
            self.replay.print_press((recording, rest), how, control)
        };
        let before = press(&start)?;
        match fitted == start {
            true => Ok([before.clone(), before]),
            false => Ok([before, press(&fitted)?]),
        }
    }
}
