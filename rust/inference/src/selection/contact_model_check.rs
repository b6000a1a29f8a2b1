//! Held-out recordings predicted by the contact model itself, with what a finding switches on.
//!
//! Candidates are fitted with a surrogate of the contact model. What a user switches on acts in the contact model on the study's mesh, so that
//! it has the last word: each protocol is followed there with the effect's numbers as the fit without that protocol found them. The base
//! of the model, which a finding does not change, is as that fit has it: moduli, first touch, gain, and what the form is off by. Of repeats,
//! which differ by noise alone, the first is followed.

use thenar_contact::{ActiveEffect, Control};

use crate::errors::InferenceError;
use crate::forward::mesh::replay::Replay;
use crate::selection::contact_model_refit::{Ended, Matching};
use crate::selection::contact_model_tasks::{Factors, Task, shown};
use crate::selection::cross_validation::{
    ContactModelCheck, Errors, Fold, HeldOutBy, Judged, errors, summary,
};
use crate::selection::scored::Scored;

/// Share of the reducible error by which the contact model may stay behind the surrogate before its numbers are sought.
const BEHIND: f64 = 0.03;

/// Mean square misfit of the fit's curves, over the noise's variance, from which the contact model has no numbers for them.
const UNMET: f64 = 1.0;

/// Shares that are done once the folds are fitted, are predicted, once numbers for all recordings are found, and for all folds.
const DONE: [f64; 4] = [0.3, 0.4, 0.7, 0.95];

/// A finding's effects as the contact model takes them; None where it has no such effect.
pub type Switching<'a> = &'a dyn Fn(&Scored) -> Option<Vec<ActiveEffect>>;

/// Recordings that are held out at once, with what is known without them.
struct Prepared {
    fold: Fold,
    effects: Vec<ActiveEffect>,
    tasks: Vec<Task>,
    factors: Factors,
}

/// What the check takes.
pub struct ByContactModel<'a, 'b> {
    /// The finding.
    pub judged: Judged<'a>,
    /// The study, as the contact model follows it.
    pub replay: &'a mut Replay,
    /// What the finding switches on.
    pub switched: Switching<'a>,
    /// Stops it.
    pub control: &'a Control<'b>,
    /// Takes the share that is done.
    pub progress: &'a dyn Fn(f64),
}

impl ByContactModel<'_, '_> {
    /// The check of a finding, held out as its gain was found; None where nothing can be held out or the contact model has no such effect.
    ///
    /// # Errors
    /// What the contact model says of a press or an effect, or `Cancelled`.
    pub fn check(
        &mut self,
        held_out_by: HeldOutBy,
    ) -> Result<Option<ContactModelCheck>, InferenceError> {
        let found = self.tried(held_out_by);
        self.replay.used_before_mm.fill(0.0);
        self.replay.set_effects(&[], self.control)?;
        found
    }

    fn tried(
        &mut self,
        held_out_by: HeldOutBy,
    ) -> Result<Option<ContactModelCheck>, InferenceError> {
        let Some(whole) = (self.switched)(self.judged.found) else {
            return Ok(None);
        };
        let mut folds = Vec::new();
        let all: Vec<usize> = (0..self.judged.ready.courses.len()).collect();
        let first = self.first_of_each(&all);
        let followed = match first.len() {
            1 => all.clone(),
            _ => first.clone(),
        };
        self.replay.set_effects(&[], self.control)?;
        let judged = self.judged.clone();
        let fits = judged.fits(held_out_by);
        let number = fits.len();
        for (k, fold) in fits.enumerate() {
            self.is_at(DONE[0] * k as f64 / number as f64)?;
            let found = Scored {
                refit: fold.after.clone(),
                ..self.judged.found.clone()
            };
            let Some(effects) = (self.switched)(&found) else {
                return Ok(None);
            };
            let mut out = fold.courses.clone();
            out.retain(|course| followed.contains(course));
            let tasks = self.tasks(&out, &fold.after.at)?;
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
        self.is_at(DONE[0])?;
        let none = Factors::default();
        let found = self.checked(&folds, &whole, &none)?;
        if found.removed >= found.by_fit.0 - BEHIND {
            return Ok(Some(found));
        }
        match self.sought(&mut folds, (&all, &first), &whole) {
            Ok(again) => Ok(Some(again.unwrap_or(found))),
            Err(InferenceError::Cancelled) => Err(InferenceError::Cancelled),
            Err(_) => Ok(Some(found)),
        }
    }

    /// The check with numbers that were sought; None where none are, or where with none the contact model answers as the fit does. They are taken whatever held-out recordings say of them.
    fn sought(
        &mut self,
        folds: &mut [Prepared],
        (all, first): (&[usize], &[usize]),
        whole: &[ActiveEffect],
    ) -> Result<Option<ContactModelCheck>, InferenceError> {
        self.is_at(DONE[1])?;
        let at = self.judged.found.refit.at.clone();
        let ended = self.matched((first, &at), whole, None)?;
        let Some(ended) = ended.filter(|ended| ended.left < UNMET) else {
            return Ok(None);
        };
        let number = folds.len() as f64;
        for (k, one) in folds.iter_mut().enumerate() {
            self.is_at(DONE[2] + (DONE[3] - DONE[2]) * k as f64 / number)?;
            let others = all.iter().filter(|c| !one.fold.courses.contains(c));
            let known = self.first_of_each(&others.copied().collect::<Vec<usize>>());
            let at = (&known[..], &one.fold.after.at[..]);
            let own = self.matched(at, &one.effects, Some(&ended))?;
            one.factors = own.map_or_else(Factors::default, |own| own.factors);
        }
        self.is_at(DONE[3])?;
        Ok(Some(self.checked(folds, whole, &ended.factors)?))
    }

    /// Says how far it is, and ends if the caller asked to.
    fn is_at(&self, share: f64) -> Result<(), InferenceError> {
        (self.progress)(share);
        self.control.check().map_err(|_| InferenceError::Cancelled)
    }

    /// Factors with which the contact model answers as a fit does in the recordings that it knows.
    fn matched(
        &mut self,
        (courses, at): (&[usize], &[f64]),
        effects: &[ActiveEffect],
        from: Option<&Ended>,
    ) -> Result<Option<Ended>, InferenceError> {
        self.replay.set_effects(&[], self.control)?;
        let tasks = self.tasks(courses, at)?;
        let matching = Matching {
            judged: &self.judged,
            tasks: &tasks,
            effects,
            at,
        };
        matching.factors(self.replay, from, self.control)
    }

    /// Recordings with the numbers of a fit.
    fn tasks(&mut self, courses: &[usize], at: &[f64]) -> Result<Vec<Task>, InferenceError> {
        self.judged.tasks(self.replay, (courses, at), self.control)
    }

    /// The check with each fold's numbers times its factors; `factors` are those of the fit to all recordings.
    fn checked(
        &mut self,
        folds: &[Prepared],
        whole: &[ActiveEffect],
        factors: &Factors,
    ) -> Result<ContactModelCheck, InferenceError> {
        let (mut all, mut by_fit) = (Vec::<Errors>::new(), Vec::new());
        for one in folds {
            let effects = one.factors.effects(&one.effects);
            let with = (&one.tasks[..], &effects[..], &one.factors);
            let shown = shown(self.replay, with, self.control)?;
            for (task, values) in one.tasks.iter().zip(shown) {
                let mut simulated = one.fold.after.simulated.clone();
                let (first, count) = self.judged.ready.courses[task.course].samples;
                simulated[first..first + count].copy_from_slice(&values);
                let fit = (
                    &one.fold.before.simulated[..],
                    &one.fold.after.simulated[..],
                );
                by_fit.push(errors(self.judged.ready, task.course, fit));
                let both = (fit.0, &simulated[..]);
                all.push(errors(self.judged.ready, task.course, both));
            }
        }
        let found = summary(self.judged.ready, &all, self.judged.seed);
        let fit = summary(self.judged.ready, &by_fit, self.judged.seed);
        Ok(ContactModelCheck {
            by_fit: (fit.removed, fit.after.rms),
            before: found.before,
            after: found.after,
            removed: found.removed,
            interval: found.interval,
            moduli: factors.moduli.map(libm::exp),
            effects: factors.effects(whole),
        })
    }

    /// Of these recordings the first of every protocol at every place.
    fn first_of_each(&self, among: &[usize]) -> Vec<usize> {
        let all = &self.judged.ready.courses;
        let is_same =
            |a: usize, b: usize| all[a].protocol == all[b].protocol && all[a].place == all[b].place;
        let is_first = |c: &usize| among.iter().find(|o| is_same(**o, *c)) == Some(c);
        among.iter().copied().filter(is_first).collect()
    }
}
