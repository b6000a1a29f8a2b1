//! Held-out recordings predicted by the contact model itself, with what a finding switches on.
//!
//! Candidates are fitted with a surrogate of the contact model. What a user switches on acts in the contact model on the study's mesh, so that
//! it has the last word: each protocol is followed there with the effect's numbers as the fit without that protocol found them. The base
//! of the model, which a finding does not change, is as that fit has it: moduli, first touch, gain, and what the form is off by. Of repeats,
//! which differ by noise alone, the first is followed.

use thenar_contact::{ActiveEffect, Control, Material};

use crate::errors::InferenceError;
use crate::forward::mesh::nuisance::Nuisance;
use crate::forward::mesh::replay::Replay;
use crate::forward::surrogate::candidate_model::{Model, Setting};
use crate::forward::surrogate::mechanism::{Law, Mechanism, Stage};
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::selection::contact_model_refit::{Ended, Factors};
use crate::selection::cross_validation::{
    Errors, Fold, HeldOutBy, Judged, Spread, errors, summary,
};
use crate::selection::scored::Scored;

/// Share of the reducible error by which the contact model may stay behind the surrogate before its numbers are sought anew.
const BEHIND: f64 = 0.03;

/// How the contact model with a finding's effects predicts recordings that were held out.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactModelCheck {
    /// Error without the finding, in standard deviations of the noise.
    pub before: Spread,
    /// Error of the contact model with it.
    pub after: Spread,
    /// Share of the reducible error that is removed; negative: the contact model predicts worse with what the finding switches on.
    pub removed: f64,
    /// Ends of its 90 % interval.
    pub interval: (f64, f64),
    /// Factors on the fit's moduli with which this was found: at first touch, and where they stop growing.
    pub moduli: [f64; 2],
    /// The effects that are to be switched on, with the numbers with which this was found.
    pub effects: Vec<ActiveEffect>,
}

/// A finding's effects as the contact model takes them; None where it has no such effect.
pub type Switching<'a> = &'a dyn Fn(&Scored) -> Option<Vec<ActiveEffect>>;

/// A recording as the contact model is to follow it.
pub(crate) struct Task {
    course: usize,
    pub(crate) recording: usize,
    /// Numbers of the samples, within the recording, that are forces.
    pub(crate) forces: Vec<usize>,
    materials: Vec<Material>,
    nuisance: Nuisance,
    used_mm: f64,
    /// On the force at the skin, by moment: what the form is off by.
    corrections: Vec<f64>,
}

/// Recordings that are held out at once, with what is known without them.
struct Prepared {
    fold: Fold,
    effects: Vec<ActiveEffect>,
    tasks: Vec<Task>,
    factors: Factors,
}

impl Judged<'_> {
    /// The check; None where nothing can be held out or the contact model has no such effect.
    ///
    /// # Errors
    /// What the contact model says of a press or an effect, or `Cancelled`.
    pub fn by_contact_model(
        &self,
        (held_out_by, removed): (HeldOutBy, f64),
        (replay, switched): (&mut Replay, Switching<'_>),
        control: &Control<'_>,
    ) -> Result<Option<ContactModelCheck>, InferenceError> {
        let Some(whole) = switched(self.found) else {
            return Ok(None);
        };
        let mut folds = Vec::new();
        let first = self.first_of_each();
        let followed = match first.len() {
            1 => (0..self.ready.courses.len()).collect(),
            _ => first.clone(),
        };
        replay.set_effects(&[], control)?;
        for fold in self.fits(held_out_by) {
            let found = Scored {
                refit: fold.after.clone(),
                ..self.found.clone()
            };
            let Some(effects) = switched(&found) else {
                return Ok(None);
            };
            let mut out = fold.courses.clone();
            out.retain(|course| followed.contains(course));
            let tasks = self.tasks(replay, (&out, &fold.after.at), control)?;
            folds.push(Prepared {
                fold,
                effects,
                tasks,
                factors: Factors::default(),
            });
        }
        if folds.is_empty() {
            return Ok(None);
        }
        let none = Factors::default();
        let mut best = self.checked(replay, (&folds, &whole, &none), control)?;
        let at = (&first[..], &self.found.refit.at[..]);
        let ended = match best.removed < removed - BEHIND {
            true => self.matched(replay, (at, &whole), (None, control))?,
            false => None,
        };
        if let Some(ended) = ended {
            for one in &mut folds {
                let is_known = |course: &&usize| !one.fold.courses.contains(course);
                let known: Vec<usize> = first.iter().filter(is_known).copied().collect();
                let at = (&known[..], &one.fold.after.at[..]);
                let own = self.matched(replay, (at, &one.effects), (Some(&ended), control))?;
                one.factors = own.map(|own| own.factors).unwrap_or_default();
            }
            let factors = ended.factors;
            let again = self.checked(replay, (&folds, &whole, &factors), control)?;
            if again.removed > best.removed {
                best = again;
            }
        }
        replay.used_before_mm.fill(0.0);
        replay.set_effects(&[], control)?;
        Ok(Some(best))
    }

    /// Factors with which the contact model answers as a fit does in the recordings that it knows.
    fn matched(
        &self,
        replay: &mut Replay,
        ((courses, at), effects): ((&[usize], &[f64]), &[ActiveEffect]),
        (from, control): (Option<&Ended>, &Control<'_>),
    ) -> Result<Option<Ended>, InferenceError> {
        replay.set_effects(&[], control)?;
        let tasks = self.tasks(replay, (courses, at), control)?;
        self.factors(replay, (&tasks, effects, at), (from, control))
    }

    /// The check with each fold's numbers times its factors; `factors` are those of the fit to all recordings.
    fn checked(
        &self,
        replay: &mut Replay,
        (folds, whole, factors): (&[Prepared], &[ActiveEffect], &Factors),
        control: &Control<'_>,
    ) -> Result<ContactModelCheck, InferenceError> {
        let mut all: Vec<Errors> = Vec::new();
        for one in folds {
            let effects = one.factors.effects(&one.effects);
            let shown = shown(replay, (&one.tasks, &effects, &one.factors), control)?;
            for (task, values) in one.tasks.iter().zip(shown) {
                let mut simulated = one.fold.after.simulated.clone();
                let (first, count) = self.ready.courses[task.course].samples;
                simulated[first..first + count].copy_from_slice(&values);
                let both = (&one.fold.before.simulated[..], &simulated[..]);
                all.push(errors(self.ready, task.course, both));
            }
        }
        let found = summary(self.ready, &all, self.seed);
        Ok(ContactModelCheck {
            before: found.before,
            after: found.after,
            removed: found.removed,
            interval: found.interval,
            moduli: factors.moduli.map(libm::exp),
            effects: factors.effects(whole),
        })
    }

    /// The first recording of every protocol at every place.
    fn first_of_each(&self) -> Vec<usize> {
        let all = &self.ready.courses;
        let is_first = |c: &usize| {
            let same =
                |o: &usize| all[*o].protocol == all[*c].protocol && all[*o].place == all[*c].place;
            !(0..*c).any(|o| same(&o))
        };
        (0..all.len()).filter(is_first).collect()
    }

    /// Recordings with the numbers of a fit.
    fn tasks(
        &self,
        replay: &mut Replay,
        (courses, at): (&[usize], &[f64]),
        control: &Control<'_>,
    ) -> Result<Vec<Task>, InferenceError> {
        let surrogate = self.ready.surrogate();
        let model = Model::new(&surrogate, &self.found.mechanisms);
        let set = model.setting(&surrogate, at);
        let materials = materials(replay, self.ready.base_material.g0_mpa, &set);
        let mut tasks = Vec::new();
        for &course in courses {
            let one = &self.ready.courses[course];
            let known = base_forces(&surrogate, &set, course);
            let moment_of = replay.moments_of_samples(one.recording);
            let mut by_moment = vec![f64::NAN; replay.moments(one.recording)];
            let mut forces = Vec::new();
            for (row, force) in one.rows.iter().zip(known) {
                if let Some(sample) = row.sample {
                    forces.push(sample - one.samples.0);
                    by_moment[moment_of[sample - one.samples.0]] = force;
                }
            }
            let nuisance = Nuisance {
                zero_mm: set.zero[course] + set.touch[one.place],
                log_gain: set.gain[course],
                ..Nuisance::none()
            };
            let at = (&materials[..], &nuisance);
            let known = (one.recording, &by_moment[..]);
            let mut corrections = replay.base_factors(known, at, control)?;
            // What an instrument does to readings it does after the gain, but for a limit of forces.
            let nuisance = match self.found.mechanisms.iter().any(limits_force) {
                true => nuisance,
                false => {
                    let gain = libm::exp(nuisance.log_gain);
                    corrections.iter_mut().for_each(|factor| *factor *= gain);
                    Nuisance {
                        log_gain: 0.0,
                        ..nuisance
                    }
                }
            };
            let used = self.found.mechanisms.iter().map(|m| match m.law {
                Law::Softening { start, .. } => one.travel_before(start),
                _ => 0.0,
            });
            tasks.push(Task {
                course,
                recording: one.recording,
                forces,
                materials: materials.clone(),
                nuisance,
                used_mm: used.fold(0.0, f64::max),
                corrections,
            });
        }
        Ok(tasks)
    }
}

/// Whether a ceiling or a floor is one of forces, as in a sensor whose amplifier is set anew for each recording.
fn limits_force(mechanism: &Mechanism) -> bool {
    matches!(
        mechanism.law,
        Law::Saturation(Stage::First) | Law::Floor(Stage::First)
    )
}

/// Predictions of the contact model for every sample of these recordings, with these effects and with factors on the moduli.
///
/// # Errors
/// What the contact model says of a press or an effect, or `Cancelled`.
pub(crate) fn shown(
    replay: &mut Replay,
    (tasks, effects, factors): (&[Task], &[ActiveEffect], &Factors),
    control: &Control<'_>,
) -> Result<Vec<Vec<f64>>, InferenceError> {
    let Some(first) = tasks.first() else {
        return Ok(Vec::new());
    };
    let materials = factors.materials(&first.materials);
    let recordings = replay.used_before_mm.len();
    let (mut nuisances, mut is_used) =
        (vec![Nuisance::none(); recordings], vec![false; recordings]);
    for task in tasks {
        nuisances[task.recording] = task.nuisance;
        is_used[task.recording] = true;
        replay.used_before_mm[task.recording] = task.used_mm;
    }
    replay.set_effects(effects, control)?;
    replay.follow_ahead((&materials, &nuisances), &is_used, control)?;
    let mut all = Vec::new();
    for task in tasks {
        let at = (&materials[..], &task.nuisance);
        let with = (&task.corrections[..], control);
        all.push(replay.predict_corrected(task.recording, at, with)?);
    }
    Ok(all)
}

/// Forces of one recording's rows without mechanisms and before its gain, N.
fn base_forces(surrogate: &Surrogate<'_>, set: &Setting, course: usize) -> Vec<f64> {
    let model = Model::new(surrogate, &[]);
    let bare = Setting {
        gain: vec![0.0; set.gain.len()],
        of: Vec::new(),
        ..set.clone()
    };
    surrogate.forces(&model, &bare, course)
}

/// The study's materials with fitted moduli, all in the proportion of its own.
fn materials(replay: &Replay, base_g0_mpa: f64, set: &Setting) -> Vec<Material> {
    let each = replay.tissue.materials.iter();
    each.map(|m| {
        let scale = m.g0_mpa / base_g0_mpa;
        Material {
            g0_mpa: set.first * scale,
            g_lim_mpa: set.limit * scale,
            ..*m
        }
    })
    .collect()
}
