//! Numbers with which the contact model answers as the surrogate did with those that it was fitted with.
//!
//! Surrogate and contact model have laws of the same names which are not the same law: a modulus that grows with the tool's depth or with
//! the depth of the skin's own region, a stiff skin with or without tension, the part of a clock. So the numbers that are switched on in
//! the contact model are sought there: moduli and the effects' own numbers, by least squares against the surrogate's fitted curves of one
//! recording for each protocol and place that the fit knows. No reading enters; for a fit without some protocols the search begins where
//! that for the fit to all ended. Numbers of effects that remember stay: to follow every protocol for every step takes a minute of a study's
//! time, and relaxation, softening and loss are the same law in both.

use nalgebra::DMatrix;
use thenar_contact::effects::Effect;
use thenar_contact::{ActiveEffect, Control};

use crate::errors::InferenceError;
use crate::forward::mesh::replay::Replay;
use crate::forward::surrogate::candidate_model::Model;
use crate::forward::surrogate::mechanism::Mechanism;
use crate::least_squares::huber::HUBER;
use crate::least_squares::levenberg_marquardt::{Limits, Objective, Point, Stopping, descend};
use crate::noise::whitening::Whitening;
use crate::selection::contact_model_tasks::{Factors, Slot, Task, shown};
use crate::selection::cross_validation::Judged;

/// Largest logarithm of the factor on a number, and the standard deviation about 0 that holds what curves do not tell.
const MOST_LOG: f64 = 4.0;
const PRIOR: f64 = 2.0;
/// Step of derivatives: a contact answers in small steps, as vertices come to bear.
const STEP: f64 = 0.05;
/// Gain over the whole below which the search ends.
const SETTLED: f64 = 0.02;
/// Presses of all places after which the best is taken: with derivatives of its own, and with those of another fit.
const MOST_EVALUATIONS: (usize, usize) = (40, 12);
/// Least part of a whole share, such as an amplitude of 1 or a Poisson's ratio of one half.
const LEAST_SHARE: f64 = 1e-3;

/// Where a search ended, and the derivatives there: a search for another fit begins with both.
pub(crate) struct Ended {
    pub(crate) factors: Factors,
    /// Mean square by which curves are not met, over the noise's variance.
    pub(crate) left: f64,
    at: Vec<f64>,
    jacobian: DMatrix<f64>,
}

/// The effects whose numbers are sought, and those numbers: of effects without memory alone.
fn sought(effects: &[ActiveEffect]) -> (Vec<usize>, Vec<Slot>) {
    let each = effects.iter().enumerate();
    let found = each
        .map(|(k, effect)| (k, slots(k, effect)))
        .filter(|(_, slots)| !slots.is_empty());
    let (numbers, slots): (Vec<usize>, Vec<Vec<Slot>>) = found.unzip();
    (numbers, slots.concat())
}

/// What may be changed of an effect, by its number among those switched on; nothing of the instrument's.
fn slots(number: usize, effect: &ActiveEffect) -> Vec<Slot> {
    let groups: &[&[&str]] = match effect.effect {
        Effect::StiffSkin => &[&["modulus_mpa"]],
        Effect::StiffeningLaw => &[&[], &["reference_depth_mm", "reference_strain"]],
        Effect::Bone => &[&["thickness_mm"]],
        Effect::Compressibility => &[&["poisson_ratio"]],
        _ => &[],
    };
    let shape = effect.entry().shape;
    let place = |name: &&str| shape.iter().position(|n| n.name == *name).map(|k| k + 1);
    let slot = |names: &&[&str]| match names.is_empty() {
        true => (number, vec![0]),
        false => (number, names.iter().filter_map(place).collect()),
    };
    groups.iter().map(slot).collect()
}

/// The search for factors.
struct Search<'a, 'b> {
    replay: &'a mut Replay,
    control: &'a Control<'b>,
    whitening: Whitening,
    tasks: &'a [Task],
    effects: &'a [ActiveEffect],
    /// Those of the effects that are switched on in the search.
    on: Vec<usize>,
    slots: Vec<Slot>,
    /// Derivatives found for the fit to all recordings, which those to fewer take.
    kept: Option<DMatrix<f64>>,
    /// What is to be met, and where each recording's samples begin in it.
    target: Vec<f64>,
    starts: Vec<(usize, usize)>,
    evaluations: usize,
}

/// A fit that the contact model is to answer as: its recordings, effects and numbers.
pub(crate) struct Matching<'a> {
    pub(crate) judged: &'a Judged<'a>,
    pub(crate) tasks: &'a [Task],
    pub(crate) effects: &'a [ActiveEffect],
    pub(crate) at: &'a [f64],
}

impl Matching<'_> {
    /// The factors, from what the fit gives in these recordings; None where no number is sought.
    ///
    /// # Errors
    /// What the contact model says of a press or an effect, or `Cancelled`.
    pub(crate) fn factors(
        &self,
        replay: &mut Replay,
        from: Option<&Ended>,
        control: &Control<'_>,
    ) -> Result<Option<Ended>, InferenceError> {
        let (tasks, effects) = (self.tasks, self.effects);
        let (on, slots) = sought(effects);
        // The skin of a known ball has tension, which none on a mesh has: no number makes up for that.
        let has_tension = self.judged.ready.elastic.places.iter().any(|p| p.is_exact)
            && effects.iter().any(|e| e.effect == Effect::StiffSkin);
        if slots.is_empty() || has_tension {
            return Ok(None);
        }
        let target = self.curves(&on);
        let mut met = self.judged.measured.to_vec();
        let mut next = 0;
        let mut starts = Vec::new();
        for one in &mut met {
            starts.push((next, one.samples.len()));
            for (sample, value) in one.samples.iter_mut().zip(&target[next..]) {
                sample.value = *value;
            }
            next += one.samples.len();
        }
        let is_used: Vec<bool> = (0..met.len())
            .map(|r| tasks.iter().any(|task| task.recording == r))
            .collect();
        let begin = from.map_or_else(|| vec![0.0; 2 + slots.len()], |ended| ended.at.clone());
        let mut search = Search {
            replay,
            control,
            whitening: Whitening::new(&met, &self.judged.ready.noise, &is_used),
            tasks,
            effects,
            on,
            slots,
            kept: from.map(|ended| ended.jacobian.clone()),
            target,
            starts,
            evaluations: 0,
        };
        let found = descend(&mut search, &begin)?;
        Ok(Some(Ended {
            factors: Factors::at(&search.slots, &found.point.at),
            left: found.point.objective / search.whitening.used().max(1) as f64,
            at: found.point.at,
            jacobian: found.jacobian,
        }))
    }

    /// What the surrogate gives at a fit with some of its mechanisms alone: all samples, stacked.
    fn curves(&self, on: &[usize]) -> Vec<f64> {
        let (ready, mechanisms) = (self.judged.ready, &self.judged.found.mechanisms);
        let surrogate = ready.surrogate();
        let whole = Model::new(&surrogate, mechanisms);
        let mut set = whole.setting(&surrogate, self.at);
        set.of = on.iter().map(|k| set.of[*k].clone()).collect();
        let some = on.iter().map(|k| mechanisms[*k].clone());
        let some: Vec<Mechanism> = some.collect();
        let model = Model::new(&surrogate, &some);
        let forces: Vec<Vec<f64>> = (0..ready.courses.len())
            .map(|course| surrogate.forces(&model, &set, course))
            .collect();
        surrogate.stacked(&forces)
    }
}

impl Objective for Search<'_, '_> {
    type Error = InferenceError;

    fn limits(&self) -> Vec<Limits> {
        let free = Limits {
            bounds: (-MOST_LOG, MOST_LOG),
            prior: Some(PRIOR),
        };
        let of = |(effect, places): &Slot| {
            let effect = &self.effects[*effect];
            let entry = effect.entry();
            let mut bounds = free.bounds;
            for place in places {
                let (value, ends) = match place.checked_sub(1) {
                    None => (effect.amplitude, [LEAST_SHARE, entry.most]),
                    Some(k) => (effect.shape[k], entry.shape[k].admissible),
                };
                bounds.0 = bounds.0.max(libm::log(ends[0] / value)).min(0.0);
                bounds.1 = bounds.1.min(libm::log(ends[1] / value)).max(0.0);
            }
            Limits { bounds, ..free }
        };
        [free; 2]
            .into_iter()
            .chain(self.slots.iter().map(of))
            .collect()
    }

    fn whitening(&self) -> &Whitening {
        &self.whitening
    }

    fn predictions(&mut self, at: &[f64]) -> Result<Vec<Vec<f64>>, InferenceError> {
        self.evaluations += 1;
        let factors = Factors::at(&self.slots, at);
        let all = factors.effects(self.effects);
        let effects: Vec<ActiveEffect> = self.on.iter().map(|k| all[*k].clone()).collect();
        let with = (self.tasks, &effects[..], &factors);
        let found = match shown(self.replay, with, self.control) {
            Err(InferenceError::Cancelled) => return Err(InferenceError::Cancelled),
            // Numbers with which a press fails are no way to go.
            Err(_) => {
                return Ok(self
                    .starts
                    .iter()
                    .map(|(_, n)| vec![f64::NAN; *n])
                    .collect());
            }
            Ok(found) => found,
        };
        let mut all: Vec<Vec<f64>> = self
            .starts
            .iter()
            .map(|(first, count)| self.target[*first..first + count].to_vec())
            .collect();
        for (task, values) in self.tasks.iter().zip(found) {
            for k in &task.forces {
                all[task.recording][*k] = values[*k];
            }
        }
        Ok(all)
    }

    fn stacked(&self, predictions: &[Vec<f64>]) -> Vec<f64> {
        predictions.concat()
    }

    fn threshold(&self, _: &[f64], _: &[Vec<f64>]) -> f64 {
        HUBER
    }

    fn jacobian(
        &mut self,
        point: &Point,
        _: Option<&DMatrix<f64>>,
    ) -> Result<DMatrix<f64>, InferenceError> {
        if let Some(kept) = &self.kept {
            return Ok(kept.clone());
        }
        let limits = self.limits();
        let here = point.simulated.concat();
        let mut jacobian = DMatrix::zeros(here.len(), point.at.len());
        for (column, limit) in limits.iter().enumerate() {
            let step = match point.at[column] + STEP <= limit.bounds.1 {
                true => STEP,
                false => -STEP,
            };
            let mut at = point.at.clone();
            at[column] += step;
            let moved = self.predictions(&at)?.concat();
            for (row, (b, a)) in moved.iter().zip(&here).enumerate() {
                jacobian[(row, column)] = (b - a) / step;
            }
        }
        Ok(jacobian)
    }

    fn stopping(&self, objective: f64) -> Stopping {
        let most = match self.kept {
            None => MOST_EVALUATIONS.0,
            Some(_) => MOST_EVALUATIONS.1,
        };
        let small = match self.evaluations < most {
            true => SETTLED * (1.0 + objective),
            false => f64::INFINITY,
        };
        Stopping {
            small,
            enough: 1,
            promised: small,
        }
    }

    fn before_step(&self, _: f64) -> Result<(), InferenceError> {
        self.control.check().map_err(|_| InferenceError::Cancelled)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use thenar_contact::Material;

    #[test]
    fn factors_act_on_their_numbers_alone_and_stay_admissible() {
        let law = ActiveEffect::new(Effect::StiffeningLaw, 1.0);
        let relaxation = ActiveEffect::new(Effect::Relaxation, 0.4);
        let before = [relaxation, law];
        let (on, slots) = sought(&before);
        assert_eq!((&on[..], slots.len()), (&[1][..], 2));
        let factors = Factors::at(&slots, &[0.1, -0.2, 0.5, libm::log(2.0)]);
        let after = factors.effects(&before);
        // An amplitude of 1 is all of it.
        assert_eq!(after[1].amplitude, 1.0);
        let twice = 2.0 * before[1].number("reference_depth_mm");
        assert!((after[1].number("reference_depth_mm") - twice).abs() < 1e-9);
        assert_eq!(after[1].number("exponent"), before[1].number("exponent"));
        assert!(after[0] == before[0]);
        let tissue = factors.materials(&[Material::default()]);
        let ratio = tissue[0].g0_mpa / Material::default().g0_mpa;
        assert!((libm::log(ratio) - 0.1).abs() < 1e-12);
    }
}
