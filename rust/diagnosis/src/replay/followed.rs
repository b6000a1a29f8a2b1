//! Protocols followed as they were, for models that remember.

use nalgebra::Vector3;
use thenar_contact::{Control, Course, Demand, Keep, Material, Protocol, Row, Run, Step};
use thenar_surface::Vec3;

use super::{Nuisance, Replay};
use crate::DiagnosisError;
use crate::observe::{Moment, Quantity, across};

/// Shortest time in which a recording that begins in the skin got there, s.
const QUICKEST: f64 = 1e-3;

impl Replay {
    /// Predictions of a model that remembers: the recording's own protocol, moment by moment, from rest.
    pub(super) fn follow(
        &mut self,
        recording: usize,
        (materials, nuisance): (&[Material], &Nuisance),
        control: &Control<'_>,
    ) -> Result<Vec<f64>, DiagnosisError> {
        let measured = &self.observed.measured[recording];
        let place = &self.places[self.place_of[recording]];
        let rows = rows(&measured.moments, nuisance.zero_mm);
        let added = rows.len() - measured.moments.len();
        let protocol = Protocol {
            rows,
            direction: Some(place.direction),
        };
        let skin = &mut self.tissue.skin;
        if skin.materials() != materials {
            let changed = skin.set_materials(materials, control);
            changed.map_err(DiagnosisError::of_contact(place.title.clone()))?;
        }
        let keep = match self.readers[recording].is_some() {
            true => Keep::Pressure,
            false => Keep::Totals,
        };
        let run = Run {
            product: &place.tool,
            posed: None,
            protocol: &protocol,
            keep,
        };
        let quiet = Control {
            cancelled: control.cancelled,
            progress: &|_, _| {},
        };
        let course = skin.run(&run, &quiet);
        let what = format!("recording '{}'", measured.name);
        let mut course = course.map_err(DiagnosisError::of_contact(what))?;
        course.steps.drain(..added);
        let frames = self.frames(recording, (&course, &protocol.rows[added..]), nuisance)?;
        let x = across(self.places[self.place_of[recording]].direction);
        let samples = self.observed.measured[recording].samples.iter();
        Ok(samples
            .map(|sample| {
                let moment = sample.moment as usize;
                value(&course.steps[moment], sample.quantity, (&frames, moment), x)
            })
            .collect())
    }

    /// What the recording's mat reads at every step, kPa; empty without a mat.
    fn frames(
        &mut self,
        recording: usize,
        (course, rows): (&Course, &[Row]),
        nuisance: &Nuisance,
    ) -> Result<Vec<Vec<f64>>, DiagnosisError> {
        let direction = self.places[self.place_of[recording]].direction;
        let Some(reader) = &mut self.readers[recording] else {
            return Ok(Vec::new());
        };
        let [x, y] = super::reading::axes(direction);
        let moved = x * nuisance.shift_mm[0] + y * nuisance.shift_mm[1];
        let mut frames = Vec::new();
        for (step, row) in course.steps.iter().zip(rows) {
            let travel = direction * step.offset + row.slide + moved;
            frames.push(reader.read((&step.pressure, &self.tissue), travel)?);
        }
        Ok(frames)
    }
}

fn value(
    step: &Step,
    quantity: Quantity,
    (frames, moment): (&[Vec<f64>], usize),
    across: Vector3<f64>,
) -> f64 {
    match quantity {
        Quantity::Force => step.force,
        Quantity::TangentialForce => step.shear.dot(&across),
        Quantity::Area => step.area,
        Quantity::Pressure(sensel) => frames
            .get(moment)
            .map_or(0.0, |frame| frame[sensel as usize]),
        Quantity::Scan(_) => 0.0,
    }
}

/// One row a moment; a recording that begins within the skin is led there from first touch at its own speed.
fn rows(moments: &[Moment], zero_mm: f64) -> Vec<Row> {
    let row = |moment: &Moment| Row {
        time_s: moment.time_s,
        demand: match moment.depth_mm.is_nan() {
            false => Demand::Depth(moment.depth_mm - zero_mm),
            true => Demand::Force(moment.demand_n.max(0.0)),
        },
        slide: moment.slide_mm,
    };
    let mut rows: Vec<Row> = moments.iter().map(row).collect();
    if let Some(Row {
        time_s,
        demand: Demand::Depth(depth),
        ..
    }) = rows.first().copied()
        && depth > 0.0
    {
        let speed = moments[0].rate_mm_s.max(0.0);
        let seconds = if speed > 0.0 { depth / speed } else { QUICKEST };
        rows.insert(
            0,
            Row {
                time_s: time_s - seconds.max(QUICKEST),
                demand: Demand::Depth(0.0),
                slide: Vec3::zeros(),
            },
        );
    }
    rows
}
