//! Recordings as the contact model follows them with a fit's numbers, and factors on these numbers.

use thenar_contact::{ActiveEffect, Control, Material};

use crate::errors::InferenceError;
use crate::forward::mesh::corrected_base::Case;
use crate::forward::mesh::nuisance::Nuisance;
use crate::forward::mesh::replay::Replay;
use crate::forward::surrogate::candidate_model::{Model, Setting};
use crate::forward::surrogate::mechanism::{Law, Mechanism, Stage};
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::selection::cross_validation::Judged;

/// Numbers of an effect that have one factor: 0 is the amplitude, k + 1 the shape number k.
pub(crate) type Slot = (usize, Vec<usize>);

/// Factors from the surrogate's numbers to those of the contact model, as logarithms.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Factors {
    /// Of the modulus at first touch, and of that where it stops growing.
    pub moduli: [f64; 2],
    pub(crate) numbers: Vec<(Slot, f64)>,
}

impl Factors {
    /// Materials with their moduli changed.
    pub(crate) fn materials(&self, of: &[Material]) -> Vec<Material> {
        let one = |m: &Material| Material {
            g0_mpa: m.g0_mpa * libm::exp(self.moduli[0]),
            g_lim_mpa: m.g_lim_mpa * libm::exp(self.moduli[1]),
            ..*m
        };
        of.iter().map(one).collect()
    }

    /// Effects with their numbers changed, within what is admissible.
    pub fn effects(&self, of: &[ActiveEffect]) -> Vec<ActiveEffect> {
        let mut all = of.to_vec();
        for ((effect, places), log) in &self.numbers {
            let (one, factor) = (&mut all[*effect], libm::exp(*log));
            let entry = one.entry();
            for place in places {
                match place.checked_sub(1) {
                    None => one.amplitude = (one.amplitude * factor).clamp(0.0, entry.most),
                    Some(k) => {
                        let [low, high] = entry.shape[k].admissible;
                        one.shape[k] = (one.shape[k] * factor).clamp(low, high);
                    }
                }
            }
        }
        all
    }

    pub(crate) fn at(slots: &[Slot], at: &[f64]) -> Factors {
        Factors {
            moduli: [at[0], at[1]],
            numbers: slots.iter().cloned().zip(at[2..].iter().copied()).collect(),
        }
    }
}

/// A recording as the contact model is to follow it.
pub(crate) struct Task {
    pub(crate) course: usize,
    pub(crate) recording: usize,
    /// Numbers of the samples, within the recording, that are forces.
    pub(crate) forces: Vec<usize>,
    materials: Vec<Material>,
    nuisance: Nuisance,
    used_mm: f64,
    /// On the force at the skin, by moment: what the form is off by.
    corrections: Vec<f64>,
}

impl Judged<'_> {
    /// Recordings with the numbers of a fit.
    pub(crate) fn tasks(
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
                force_zero_n: set.force_zero[course],
                ..Nuisance::none()
            };
            let case = Case {
                recording: one.recording,
                materials: &materials,
                nuisance: &nuisance,
            };
            let mut corrections = replay.base_factors(case, &by_moment, control)?;
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

/// Whether a ceiling or a floor is one of forces, as in a sensor whose amplifier is set for each recording.
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
        let case = Case {
            recording: task.recording,
            materials: &materials,
            nuisance: &task.nuisance,
        };
        all.push(replay.predict_corrected(case, &task.corrections, control)?);
    }
    Ok(all)
}

/// Forces of one recording's rows without mechanisms and before its gain and zero, N.
fn base_forces(surrogate: &Surrogate<'_>, set: &Setting, course: usize) -> Vec<f64> {
    let model = Model::new(surrogate, &[]);
    let bare = Setting {
        gain: vec![0.0; set.gain.len()],
        force_zero: vec![0.0; set.force_zero.len()],
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
