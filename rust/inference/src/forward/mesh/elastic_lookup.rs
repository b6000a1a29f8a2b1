//! Predictions without history dependence, from cached press tables.

use std::sync::Arc;

use thenar_contact::effects::Effect;
use thenar_contact::{ActiveEffect, Control, Demand, Keep, Material};

use crate::errors::InferenceError;
use crate::forward::mesh::at_skin::AtSkin;
use crate::forward::mesh::mat_reading::{misplaced, slid};
use crate::forward::mesh::nuisance::Nuisance;
use crate::forward::mesh::press_key::Key;
use crate::forward::mesh::press_table::{Basis, PressTable, RUNGS, press_table};
use crate::forward::mesh::replay::Replay;
use crate::observe::measured::Moment;

/// Ladders kept for each tool and place.
const MOST_KEPT: usize = 12;

impl Replay {
    /// What happens at the skin, from the ladder of the recording's tool and place.
    pub(crate) fn look_up(
        &mut self,
        recording: usize,
        (materials, nuisance): (&[Material], &Nuisance),
        control: &Control<'_>,
    ) -> Result<AtSkin, InferenceError> {
        let (basis, weights) = self.basis(self.place_of[recording], materials, control)?;
        let depth = |demand: &Demand| match demand {
            // A recording asks for no offset: it knows first touch.
            Demand::Depth(depth) | Demand::Offset(depth) => *depth,
            Demand::Force(force) => basis.depth_at(&weights, *force),
        };
        let demands = self.demands(recording, nuisance);
        let depths: Vec<f64> = demands.iter().map(depth).collect();
        let last = depths.last().copied().unwrap_or(0.0);
        let displacement = self.displacement(recording, (materials, last), control)?;
        let placement = misplaced(nuisance.placement, &self.instrument);
        let frames = match &mut self.readers[recording] {
            Some(reader) => {
                let sensels = reader.sensels().len();
                let moments = &self.observed.measured[recording].moments;
                let mut frame = |(depth, moment): (&f64, &Moment)| {
                    let at = slid(placement, reader.sensels(), &moment.slide_mm);
                    let readings = reader.readings(&basis, at);
                    (0..sensels)
                        .map(|s| readings.at(s, &weights, *depth))
                        .collect()
                };
                depths.iter().zip(moments).map(&mut frame).collect()
            }
            None => Vec::new(),
        };
        Ok(AtSkin {
            force: depths
                .iter()
                .map(|d| basis.force_at(&weights, *d))
                .collect(),
            tangential: vec![0.0; depths.len()],
            area: depths.iter().map(|d| basis.area_at(*d)).collect(),
            frames,
            displacement,
        })
    }

    /// The ladder at a place and the weights of its parts at these materials.
    pub(crate) fn basis(
        &mut self,
        at: usize,
        materials: &[Material],
        control: &Control<'_>,
    ) -> Result<(Arc<Basis>, Vec<f64>), InferenceError> {
        let is_linear = self.is_linear(materials);
        let weights = match is_linear {
            true => vec![materials[0].g0_mpa, materials[0].g_lim_mpa],
            false => vec![1.0],
        };
        let key = self.key(materials);
        if let Some((_, basis)) = self.places[at].kept.iter().find(|(kept, _)| *kept == key) {
            return Ok((basis.clone(), weights));
        }
        let basis = match is_linear {
            false => Basis::whole(self.press((at, RUNGS), &key.materials, control)?),
            true => {
                let unit = key.materials[0];
                let twice = Material {
                    g_lim_mpa: 2.0 * unit.g0_mpa,
                    ..unit
                };
                let one = self.press((at, RUNGS), &[unit], control)?;
                let two = self.press((at, RUNGS), &[twice], control)?;
                Basis::linear(one, two, unit.g0_mpa)
            }
        };
        let (basis, kept) = (Arc::new(basis), &mut self.places[at].kept);
        if kept.len() == MOST_KEPT {
            kept.remove(0);
        }
        kept.push((key, basis.clone()));
        Ok((basis, weights))
    }

    /// The tool of a place (by number) pressed to a ladder of that many depths, with the effects switched on that do not remember.
    ///
    /// # Errors
    /// What the contact model says of a press, or `Cancelled`.
    pub fn ladder(
        &mut self,
        place: (usize, usize),
        materials: &[Material],
        control: &Control<'_>,
    ) -> Result<PressTable, InferenceError> {
        self.press(place, materials, control)
    }

    /// Radius, mm, of the tool at a place (by number), if it is a ball.
    pub fn ball(&self, place: usize) -> Option<f64> {
        self.places[place].ball
    }

    /// What a ladder depends on: where all is linear in the moduli, those of the start stand for all.
    pub(crate) fn key(&self, materials: &[Material]) -> Key {
        let start = self.tissue.materials[0].g0_mpa;
        let unit = |material: &Material| Material {
            g0_mpa: start,
            g_lim_mpa: start,
            ..*material
        };
        Key {
            materials: match self.is_linear(materials) {
                true => materials.iter().map(unit).collect(),
                false => materials.to_vec(),
            },
            effects: self.lasting(),
        }
    }

    /// True if force and pressure are linear in G0 and Glim: one region, and no effect with a stiffness of its own.
    fn is_linear(&self, materials: &[Material]) -> bool {
        let is_free = |e: &ActiveEffect| {
            e.amplitude == 0.0
                || matches!(
                    e.effect,
                    Effect::Bone | Effect::Compressibility | Effect::Inclusion
                )
        };
        materials.len() == 1 && self.lasting().iter().all(is_free)
    }

    fn press(
        &mut self,
        (at, rungs): (usize, usize),
        materials: &[Material],
        control: &Control<'_>,
    ) -> Result<PressTable, InferenceError> {
        let title = self.places[at].title.clone();
        let key = Key {
            materials: materials.to_vec(),
            effects: self.lasting(),
        };
        self.turn_skin(&key, (&title, control))?;
        let place = &self.places[at];
        let quiet = Control {
            cancelled: control.cancelled,
            progress: &|_, _| {},
        };
        let has_mat = |r: usize| self.place_of[r] == at && self.readers[r].is_some();
        let keep = match (0..self.place_of.len()).any(has_mat) {
            true => Keep::Loads,
            false => Keep::Totals,
        };
        press_table(
            self.tissue.workspace.on(&self.tissue.skin),
            (&place.tool, place.direction),
            (place.deepest, rungs, keep),
            (&title, &quiet),
        )
    }
}
