//! Conducts a fit: observe, replay, noise, descent, intervals, and what is left.

use thenar_contact::{ActiveEffect, Control};
use thenar_recordings::Study;

use crate::checks::lack_of_fit::{Left, absorbed, blocks, lack_of_fit, project};
use crate::errors::InferenceError;
use crate::fit::initial_guess::scaled_start;
use crate::fit::result::Fit;
use crate::forward::mesh::nuisance::Nuisance;
use crate::forward::mesh::replay::Replay;
use crate::least_squares::confidence_intervals::estimates;
use crate::least_squares::huber::HUBER;
use crate::least_squares::levenberg_marquardt::{Descent, Objective, Point, descend};
use crate::least_squares::objective::Problem;
use crate::noise::estimate::{Noise, noise};
use crate::noise::whitening::Whitening;
use crate::observe::measured::Measured;
use crate::observe::study::observe;
use crate::parameters::bounds_and_priors::{Case, parameters, touches};
use crate::parameters::effect_parameters::{EffectFit, Found, Free, effects_at, free_parameters};
use crate::parameters::estimate::Estimate;
use crate::parameters::form_error::form_parameters;
use crate::parameters::model_inputs::setting;
use crate::parameters::parameter::{Kind, Parameter};
use crate::parameters::sensor_pose::settle;

/// Samples up to which a test is drawn as often as asked for; beyond, in proportion less.
const MANY_SAMPLES: usize = 4000;
/// Fewest draws of a test.
const LEAST_DRAWS: usize = 99;

/// What a fit is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Seed of all that is drawn.
    pub seed: u64,
    /// Draws of the test for lack of fit.
    pub draws: usize,
    /// Effects that the model has.
    pub effects: Vec<ActiveEffect>,
    /// Standard deviation of the share by which the load may be off at any depth for want of a better model, for each tool at each
    /// site; 0: the model is taken as true.
    pub form_error: f64,
    /// Recordings, by name, that are predicted and not fitted.
    pub held_out: Vec<String>,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            seed: 1,
            draws: 999,
            effects: Vec::new(),
            form_error: 0.0,
            held_out: Vec::new(),
        }
    }
}

/// A study made ready to be fitted again and again; presses are kept from fit to fit.
pub struct Fitting {
    /// The study made ready to be simulated.
    pub replay: Replay,
    instrument: Option<thenar_recordings::study::Instrument>,
}

/// Fits a study's parameters to its recordings.
///
/// # Errors
/// [`InferenceError`]: skin, tools or mats that cannot be used, presses that fail, too few samples, or `Cancelled`.
pub fn fit_study(
    study: &Study,
    options: &Options,
    control: &Control<'_>,
) -> Result<Fit, InferenceError> {
    Fitting::new(study, control)?.fit(options, control)
}

impl Fitting {
    /// Observes the recordings and prepares skin, tools and mats.
    ///
    /// # Errors
    /// As [`fit_study`].
    pub fn new(study: &Study, control: &Control<'_>) -> Result<Fitting, InferenceError> {
        Ok(Fitting {
            replay: Replay::new(study, observe(study), control)?,
            instrument: study.instrument.clone(),
        })
    }

    /// Fits with the model, and without the recordings, that the options name.
    ///
    /// # Errors
    /// As [`fit_study`].
    pub fn fit(&mut self, options: &Options, control: &Control<'_>) -> Result<Fit, InferenceError> {
        Ok(self.fit_effects(options, &[], control)?.fit)
    }

    /// Fits numbers of the effects as well.
    ///
    /// The noise is judged without effects, so that fits with different ones can be compared.
    ///
    /// # Errors
    /// As [`fit_study`].
    pub fn fit_effects(
        &mut self,
        options: &Options,
        free: &[Free],
        control: &Control<'_>,
    ) -> Result<EffectFit, InferenceError> {
        let measured = &self.replay.observed.measured;
        let is_used: Vec<bool> = measured
            .iter()
            .map(|m| !options.held_out.contains(&m.name) && touches(m))
            .collect();
        self.check(&is_used)?;
        let noise = self.noise(&is_used, control)?;
        let mut parameters = self.parameters((&noise, &is_used), control)?;
        let place_of = &self.replay.place_of;
        parameters.extend(form_parameters(options.form_error, place_of, &is_used));
        parameters.extend(free_parameters(free, &options.effects));
        let mut before = self.simulate(&options.effects, control)?;
        let whitening = Whitening::new(&self.replay.observed.measured, &noise, &is_used);
        if whitening.used() <= parameters.len() {
            return Err(InferenceError::TooFewSamples {
                samples: whitening.used(),
                parameters: parameters.len(),
            });
        }
        let mut problem = Problem {
            replay: &mut self.replay,
            parameters: &parameters,
            effects: &options.effects,
            whitening: &whitening,
            is_used: &is_used,
            control,
        };
        let start = scaled_start(&mut problem, &before)?;
        let mut descent = descend(&mut problem, &start)?;
        let deviance = problem.point(&descent.point.at, Some(HUBER))?.objective;
        foretell(&mut problem, &mut descent.point)?;
        let estimates = estimates(&problem, (&descent.point, &descent.system), &noise);
        let left = self.left((&whitening, &descent), &noise, options);
        let notes = self.notes((&noise, &descent), &parameters);
        let is_effect = |(kind, _): &(Kind, Estimate)| matches!(kind, Kind::Effect(..));
        let (of_effects, mut others): (Vec<_>, Vec<_>) = estimates.into_iter().partition(is_effect);
        others.retain(|(kind, _)| !matches!(kind, Kind::Form(..)));
        let mut measured = self.replay.observed.measured.clone();
        let mut simulated = descent.point.simulated;
        let found_at = (&parameters[..], &descent.point.at[..]);
        settle(&mut measured, [&mut simulated, &mut before], found_at);
        let fit = Fit {
            measured,
            simulated,
            before,
            sigma: noise.sigma,
            projected: left.projected,
            absorbed: left.absorbed,
            estimates: others.into_iter().map(|(_, estimate)| estimate).collect(),
            lack_of_fit_p: left.p,
            notes,
        };
        Ok(EffectFit {
            fit,
            effects: effects_at(&options.effects, (&parameters, &descent.point.at)),
            found: of_effects
                .iter()
                .map(|(_, estimate)| found(estimate))
                .collect(),
            deviance,
        })
    }

    /// Predictions for every sample of every recording with the study's own parameters and these effects, in the samples' units.
    ///
    /// # Errors
    /// As [`fit_study`].
    pub fn simulate(
        &mut self,
        effects: &[ActiveEffect],
        control: &Control<'_>,
    ) -> Result<Vec<Vec<f64>>, InferenceError> {
        self.replay.set_effects(effects, control)?;
        self.at_start(control)
    }

    /// The recordings as they are compared.
    pub fn measured(&self) -> &[Measured] {
        &self.replay.observed.measured
    }

    fn check(&self, is_used: &[bool]) -> Result<(), InferenceError> {
        let measured = &self.replay.observed.measured;
        let has_any = measured
            .iter()
            .zip(is_used)
            .any(|(m, used)| *used && !m.samples.is_empty());
        if has_any {
            return Ok(());
        }
        let reasons = measured
            .iter()
            .map(|m| format!("'{}': {}", m.name, m.unknown.join(", ")));
        Err(InferenceError::NothingMeasured {
            recordings: measured.len(),
            reasons: reasons.collect::<Vec<String>>().join("; "),
        })
    }

    /// Predictions with the parameters at which the fit begins.
    fn at_start(&mut self, control: &Control<'_>) -> Result<Vec<Vec<f64>>, InferenceError> {
        let materials = self.replay.tissue.materials.clone();
        let none = Nuisance::none();
        let recordings = self.replay.observed.measured.len();
        let ahead = (&materials[..], &vec![none; recordings][..]);
        self.replay
            .follow_ahead(ahead, &vec![true; recordings], control)?;
        let mut all = Vec::with_capacity(recordings);
        for recording in 0..recordings {
            control
                .step("replaying", recording as f64 / recordings as f64)
                .map_err(|_| InferenceError::Cancelled)?;
            all.push(
                self.replay
                    .predict(recording, (&materials, &none), control)?,
            );
        }
        Ok(all)
    }

    /// The noise, from repeats along what gain and contact zero do to them.
    fn noise(&mut self, is_used: &[bool], control: &Control<'_>) -> Result<Noise, InferenceError> {
        let before = self.simulate(&[], control)?;
        let materials = self.replay.tissue.materials.clone();
        let mut slopes = Vec::with_capacity(before.len());
        for (recording, simulated) in before.iter().enumerate() {
            let deepest = self.replay.deepest(recording);
            let step = 5e-3 * deepest;
            let moved = Nuisance {
                zero_mm: -step,
                ..Nuisance::none()
            };
            let from = (&materials[..], &Nuisance::none());
            let to = (&materials[..], &moved);
            let moved = self.replay.predict_near(recording, (from, to), control)?;
            slopes.push(
                moved
                    .iter()
                    .zip(simulated)
                    .map(|(b, a)| (b - a) / step)
                    .collect(),
            );
        }
        let noise_n = self.instrument.as_ref().and_then(|i| i.noise_n);
        let measured = &self.replay.observed.measured;
        Ok(noise(measured, (&before, &slopes), is_used, noise_n))
    }

    /// What is fitted: regions that no tool touches are left as they are.
    fn parameters(
        &mut self,
        (noise, is_used): (&Noise, &[bool]),
        control: &Control<'_>,
    ) -> Result<Vec<Parameter>, InferenceError> {
        let touched = self.replay.touched(is_used, control)?;
        let mut all = parameters(Case {
            tissue: &self.replay.tissue,
            measured: &self.replay.observed.measured,
            is_touch_known: &self.replay.observed.is_touch_known,
            place_of: &self.replay.place_of,
            is_used,
            noise,
            instrument: self.instrument.as_ref(),
        });
        all.retain(|p| !matches!(p.kind, Kind::Tissue(region, _) if !touched[region]));
        Ok(all)
    }

    fn notes(&self, (noise, descent): (&Noise, &Descent), parameters: &[Parameter]) -> Vec<String> {
        let mut notes = self.replay.tissue.notes.clone();
        notes.extend(noise.notes.iter().cloned());
        notes.extend(noise.zero_note());
        notes.extend(noise.hum_note());
        if !descent.has_converged {
            notes
                .push("the fit did not settle: what it gives is the best that it found".to_owned());
        }
        let has = |is: &dyn Fn(Kind) -> bool| parameters.iter().any(|p| is(p.kind));
        if !has(&|kind| matches!(kind, Kind::Tissue(..)))
            && has(&|kind| matches!(kind, Kind::Counts(_)))
        {
            notes.push(
                "the moduli stay where the study has them: counts do not tell them, and with others the counts per kPa would be others"
                    .to_owned(),
            );
        } else if !has(&|kind| kind == Kind::InstrumentGain) {
            notes.push(
                "the instrument's gain is taken as true, since the data sheet gives no uncertainty: a gain that is off shows as a modulus that is off"
                    .to_owned(),
            );
        }
        notes
    }

    fn left(
        &self,
        (whitening, descent): (&Whitening, &Descent),
        noise: &Noise,
        options: &Options,
    ) -> Remainder {
        let point: &Point = &descent.point;
        let simulated = point.simulated.concat();
        let mut whitened = whitening.derivatives(&descent.jacobian, &point.whitened);
        let mut residual = point.whitened.residual.clone();
        let counts: Vec<bool> = (0..whitening.len())
            .map(|k| whitening.counts(k, simulated[k]))
            .collect();
        for (k, counts) in counts.iter().enumerate() {
            if !counts {
                residual[k] = 0.0;
                whitened.row_mut(k).fill(0.0);
            }
        }
        let absorbed = absorbed(&whitened);
        let projected = project(&absorbed, &residual);
        let many = whitening.used().max(1);
        let draws = (options.draws * MANY_SAMPLES / many)
            .clamp(LEAST_DRAWS.min(options.draws), options.draws);
        let left = Left {
            projected: &projected,
            counts: &counts,
            absorbed: &absorbed,
            blocks: &blocks(&self.replay.observed.measured),
            noise,
            whitening,
        };
        let p = lack_of_fit(&left, (draws, options.seed));
        let mut rest = projected.into_iter();
        let by_recording = point.simulated.iter();
        Remainder {
            projected: by_recording
                .map(|one| rest.by_ref().take(one.len()).collect())
                .collect(),
            absorbed,
            p,
        }
    }
}

/// Predicts the recordings that were held out: with the estimates, and what their tool shares with those that were not.
fn foretell(problem: &mut Problem<'_>, point: &mut Point) -> Result<(), InferenceError> {
    problem.turn_effects(&point.at)?;
    let (materials, nuisances) = setting(problem.replay, (problem.parameters, &point.at));
    for recording in (0..nuisances.len()).filter(|&r| !problem.is_used[r]) {
        let setting = (&materials[..], &nuisances[recording]);
        point.simulated[recording] = problem
            .replay
            .predict(recording, setting, problem.control)?;
    }
    Ok(())
}

fn found(estimate: &Estimate) -> Found {
    Found {
        value: estimate.value,
        low: estimate.low,
        high: estimate.high,
        is_at_bound: estimate.is_at_bound,
    }
}

/// What a fit leaves.
struct Remainder {
    projected: Vec<Vec<f64>>,
    absorbed: nalgebra::DMatrix<f64>,
    p: Option<f64>,
}
