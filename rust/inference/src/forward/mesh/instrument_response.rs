//! Instrument readings from the load at the skin: gain, counts, and effects of the instrument.

use thenar_contact::effects::Effect;
use thenar_contact::instrument::{Signals, observe};
use thenar_contact::{ActiveEffect, Demand};

use crate::errors::InferenceError;
use crate::forward::mesh::at_skin::AtSkin;
use crate::forward::mesh::nuisance::{KNOTS, Nuisance};
use crate::forward::mesh::replay::Replay;
use crate::interpolation::linear;
use crate::observe::measured::{Measured, Moment, Quantity};

impl Replay {
    /// Values for every sample of a recording, as its instrument shows them.
    ///
    /// # Errors
    /// What the contact model says of an effect of the instrument.
    pub(crate) fn shown(
        &self,
        recording: usize,
        nuisance: &Nuisance,
        at_skin: AtSkin,
    ) -> Result<Vec<f64>, InferenceError> {
        let measured = &self.observed.measured[recording];
        let heights = self.seen(recording, nuisance, &at_skin.displacement);
        let mut at_skin = self.of_form(recording, nuisance, at_skin);
        let gain = libm::exp(nuisance.log_gain);
        // Before what the instrument does to readings: a cell that was not tared clips at one reading all the same.
        let zero = nuisance.force_zero_n / gain;
        if zero != 0.0 {
            at_skin.force.iter_mut().for_each(|f| *f += zero);
        }
        let shown = self.through_instrument(recording, at_skin)?;
        let counts = libm::exp(nuisance.log_gain + nuisance.log_counts);
        let one = |moment: usize, quantity: Quantity| match quantity {
            Quantity::Force => gain * shown.force[moment],
            Quantity::TangentialForce => gain * shown.tangential[moment],
            Quantity::Area => shown.area[moment],
            Quantity::Pressure(sensel) => match shown.frames.get(moment) {
                Some(frame) => counts * frame[sensel as usize],
                None => 0.0,
            },
            Quantity::Scan(place) => heights[place as usize],
        };
        let samples = measured.samples.iter();
        Ok(samples
            .map(|s| one(s.moment as usize, s.quantity))
            .collect())
    }

    /// Loads with what the model's form is off by.
    fn of_form(&self, recording: usize, nuisance: &Nuisance, mut at_skin: AtSkin) -> AtSkin {
        if nuisance.form == [0.0; KNOTS] {
            return at_skin;
        }
        let deepest = self.deepest(recording);
        for (k, depth) in self.depths(recording, nuisance).iter().enumerate() {
            let place = (depth / deepest).clamp(0.0, 1.0) * KNOTS as f64;
            if place.is_nan() {
                continue;
            }
            let knot = (place as usize).min(KNOTS - 1);
            let before = if knot == 0 {
                0.0
            } else {
                nuisance.form[knot - 1]
            };
            let share = place - knot as f64;
            let factor = libm::exp(before + share * (nuisance.form[knot] - before));
            at_skin.force[k] *= factor;
            at_skin.tangential[k] *= factor;
            let frame = at_skin.frames.get_mut(k).into_iter().flatten();
            frame.for_each(|value| *value *= factor);
        }
        at_skin
    }

    /// The effects that act on readings, in order; those on motion and on where the mat lies have acted already.
    fn through_instrument(
        &self,
        recording: usize,
        at_skin: AtSkin,
    ) -> Result<AtSkin, InferenceError> {
        let acts = |e: &&ActiveEffect| {
            !matches!(
                e.effect,
                Effect::FixtureCompliance | Effect::Misregistration
            ) && !is_late_depth(e)
        };
        let effects: Vec<ActiveEffect> = self.instrument.iter().filter(acts).cloned().collect();
        if effects.is_empty() {
            return Ok(at_skin);
        }
        let measured = &self.observed.measured[recording];
        let signals = Signals {
            time_s: measured.moments.iter().map(|m| m.time_s).collect(),
            depth_mm: Vec::new(),
            force_n: at_skin.force,
            area_mm2: at_skin.area,
            tangential_force_n: at_skin.tangential,
            loads: Vec::new(),
            frames: at_skin.frames,
        };
        let displacement = at_skin.displacement;
        let mat = self.readers[recording]
            .as_ref()
            .map(|reader| reader.sensels());
        let what = format!("the instrument in recording '{}'", measured.name);
        let shown = observe(&signals, mat, &effects).map_err(InferenceError::of_contact(what))?;
        Ok(AtSkin {
            force: shown.force_n,
            tangential: shown.tangential_force_n,
            area: shown.area_mm2,
            frames: shown.frames,
            displacement,
        })
    }

    /// Depth in the skin at every moment, mm: the recording's own less its contact zero, less what a fixture yields to the force
    /// that was measured, at the time that a late channel means. NaN where none is known.
    pub(crate) fn depths(&self, recording: usize, nuisance: &Nuisance) -> Vec<f64> {
        let measured = &self.observed.measured[recording];
        let mut depths: Vec<f64> = measured
            .moments
            .iter()
            .map(|m| m.depth_mm - nuisance.zero_mm)
            .collect();
        for effect in self.instrument.iter().filter(|e| e.amplitude > 0.0) {
            if is_late_depth(effect) {
                let times: Vec<f64> = measured.moments.iter().map(|m| m.time_s).collect();
                let delay = effect.amplitude * effect.number("delay_s");
                let meant: Vec<f64> = times.iter().map(|t| t + delay).collect();
                depths = linear(&times, &depths, &meant);
            }
            if effect.effect == Effect::FixtureCompliance {
                let compliance = effect.amplitude * effect.number("compliance_mm_per_n");
                let forces = forces(measured);
                depths
                    .iter_mut()
                    .zip(&forces)
                    .for_each(|(d, f)| *d -= compliance * f);
            }
        }
        depths
    }

    /// What every moment asks for: its depth in the skin, or where none is known a force, that of a mat in counts at its counts per kPa.
    pub(crate) fn demands(&self, recording: usize, nuisance: &Nuisance) -> Vec<Demand> {
        let per_count = libm::exp(-nuisance.log_counts);
        let moments = &self.observed.measured[recording].moments;
        let demand = |(depth, moment): (f64, &Moment)| match depth.is_nan() {
            false => Demand::Depth(depth),
            true => Demand::Force((per_count * moment.demand_n).max(0.0)),
        };
        let depths = self.depths(recording, nuisance);
        depths.into_iter().zip(moments).map(demand).collect()
    }
}

fn is_late_depth(effect: &ActiveEffect) -> bool {
    effect.effect == Effect::Timing && effect.chosen.first() == Some(&2)
}

/// Measured force by moment; 0 where there is none.
fn forces(measured: &Measured) -> Vec<f64> {
    let mut forces = vec![0.0; measured.moments.len()];
    for sample in measured
        .samples
        .iter()
        .filter(|s| s.quantity == Quantity::Force)
    {
        forces[sample.moment as usize] = sample.value;
    }
    forces
}
