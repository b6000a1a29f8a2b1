//! Protocols followed as they were, for models that remember.

use thenar_contact::{Control, Demand, Keep, Material, Protocol, Row, Run};
use thenar_surface::Vec3;

use super::reading::misplaced;
use super::shown::AtSkin;
use super::{Nuisance, Replay};
use crate::DiagnosisError;
use crate::observe::{Moment, across};

/// Shortest time in which a recording that begins in the skin got there, s.
const QUICKEST: f64 = 1e-3;

impl Replay {
    /// What a model that remembers says: the recording's own protocol, moment by moment, from rest.
    pub(super) fn follow(
        &mut self,
        recording: usize,
        (materials, nuisance): (&[Material], &Nuisance),
        control: &Control<'_>,
    ) -> Result<AtSkin, DiagnosisError> {
        let depths = self.depths(recording, nuisance);
        let measured = &self.observed.measured[recording];
        let place = &self.places[self.place_of[recording]];
        let rows = rows(&measured.moments, &depths);
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
        let run = Run {
            product: &place.tool,
            posed: None,
            protocol: &protocol,
            keep: match self.readers[recording] {
                Some(_) => Keep::Loads,
                None => Keep::Totals,
            },
        };
        let quiet = Control {
            cancelled: control.cancelled,
            progress: &|_, _| {},
        };
        let what = format!("recording '{}'", measured.name);
        let course = skin
            .run(&run, &quiet)
            .map_err(DiagnosisError::of_contact(what))?;
        let steps = &course.steps[added..];
        let placement = misplaced(nuisance.placement, &self.instrument);
        let x = across(place.direction);
        let frames = match &self.readers[recording] {
            Some(reader) => {
                let read =
                    |step: &thenar_contact::Step| reader.sensels().read_at(&step.loads, &placement);
                steps.iter().map(read).collect()
            }
            None => Vec::new(),
        };
        Ok(AtSkin {
            force: steps.iter().map(|step| step.force).collect(),
            tangential: steps.iter().map(|step| step.shear.dot(&x)).collect(),
            area: steps.iter().map(|step| step.area).collect(),
            frames,
        })
    }
}

/// One row a moment; a recording that begins within the skin is led there from first touch at its own speed.
fn rows(moments: &[Moment], depths: &[f64]) -> Vec<Row> {
    let row = |(moment, depth): (&Moment, &f64)| Row {
        time_s: moment.time_s,
        demand: match depth.is_nan() {
            false => Demand::Depth(*depth),
            true => Demand::Force(moment.demand_n.max(0.0)),
        },
        slide: moment.slide_mm,
    };
    let mut rows: Vec<Row> = moments.iter().zip(depths).map(row).collect();
    let (Some(first), Some(depth)) = (moments.first(), depths.first()) else {
        return rows;
    };
    if *depth > 0.0 {
        let speed = first.rate_mm_s.max(0.0);
        let seconds = if speed > 0.0 { depth / speed } else { QUICKEST };
        let start = Row {
            time_s: first.time_s - seconds.max(QUICKEST),
            demand: Demand::Depth(0.0),
            slide: Vec3::zeros(),
        };
        rows.insert(0, start);
    }
    rows
}
