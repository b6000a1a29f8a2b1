//! Protocols followed as they were, for models that remember.

use thenar_contact::effects::Effect;
use thenar_contact::instrument::Placement;
use thenar_contact::{ActiveEffect, Control, Demand, Keep, Material, Protocol, Row, Run, Step};
use thenar_surface::Vec3;

use super::reading::misplaced;
use super::shown::AtSkin;
use super::{Followed, Key, Nuisance, Replay};
use crate::DiagnosisError;
use crate::observe::{Moment, across};

/// Shortest time in which a recording that begins in the skin got there, s.
const QUICKEST: f64 = 1e-3;
/// Runs kept for each recording.
const MOST_KEPT: usize = 6;

impl Replay {
    /// What a model that remembers says: the recording's own protocol, moment by moment, from rest.
    ///
    /// Where no effect has a force of its own, all forces grow with the moduli: one run serves all moduli of one proportion.
    pub(super) fn follow(
        &mut self,
        recording: usize,
        (materials, nuisance): (&[Material], &Nuisance),
        control: &Control<'_>,
    ) -> Result<AtSkin, DiagnosisError> {
        let scale = match self.effects.iter().all(grows_with_modulus) {
            true => materials[0].g0_mpa / self.tissue.materials[0].g0_mpa,
            false => 1.0,
        };
        let materials = materials.iter().map(|material| Material {
            g0_mpa: material.g0_mpa / scale,
            g_lim_mpa: material.g_lim_mpa / scale,
            ..*material
        });
        let key = Key {
            materials: materials.collect(),
            effects: self.effects.clone(),
        };
        let depths = self.depths(recording, nuisance);
        let placement = misplaced(nuisance.placement, &self.instrument);
        let is_alike =
            |f: &&Followed| f.key == key && f.placement == placement && same(&f.depths, &depths);
        if let Some(found) = self.followed[recording].iter().find(is_alike) {
            return Ok(found.at_skin.clone().scaled(scale));
        }
        let title = self.places[self.place_of[recording]].title.clone();
        self.turn_skin(&key, (&title, control))?;
        let at_skin = self.run(recording, (&depths, placement), control)?;
        let kept = &mut self.followed[recording];
        if kept.len() == MOST_KEPT {
            kept.remove(0);
        }
        kept.push(Followed {
            key,
            depths,
            placement,
            at_skin: at_skin.clone(),
        });
        Ok(at_skin.scaled(scale))
    }

    /// Follows the protocol with the skin as it is.
    fn run(
        &mut self,
        recording: usize,
        (depths, placement): (&[f64], Placement),
        control: &Control<'_>,
    ) -> Result<AtSkin, DiagnosisError> {
        let measured = &self.observed.measured[recording];
        let place = &self.places[self.place_of[recording]];
        let rows = rows(&measured.moments, depths);
        let added = rows.len() - measured.moments.len();
        let protocol = Protocol {
            rows,
            direction: Some(place.direction),
        };
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
        let course = self.tissue.skin.run(&run, &quiet);
        let course = course.map_err(DiagnosisError::of_contact(what))?;
        let steps = &course.steps[added..];
        let x = across(place.direction);
        let frames = match &self.readers[recording] {
            Some(reader) => {
                let read = |step: &Step| reader.sensels().read_at(&step.loads, &placement);
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

/// True for an effect under which all forces grow with the moduli: it has no stiffness and no force of its own.
fn grows_with_modulus(effect: &ActiveEffect) -> bool {
    effect.amplitude == 0.0
        || !matches!(
            effect.effect,
            Effect::StiffSkin | Effect::StiffeningLaw | Effect::Adhesion | Effect::RegionCoupling
        )
}

/// Equal, NaN among them.
fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
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
