//! The mesh model as it is fitted: its predictions, their derivatives, and when its fit has settled.

use std::ops::AddAssign;

use nalgebra::{DMatrix, DVector};
use thenar_contact::{ActiveEffect, Control};

use crate::errors::InferenceError;
use crate::forward::mesh::replay::Replay;
use crate::least_squares::huber::HUBER;
use crate::least_squares::levenberg_marquardt::{Limits, Objective, Point, Stopping};
use crate::noise::whitening::Whitening;
use crate::observe::measured::Quantity;
use crate::observe::robust_scale::median_deviation;
use crate::parameters::effect_parameters::effects_at;
use crate::parameters::model_inputs::setting;
use crate::parameters::parameter::{Kind, Parameter};

/// Relative gain of the objective below which the fit has settled, twice in a row.
const SETTLED: f64 = 1e-7;
/// The same, once, where every step follows all protocols again: a hundredth of what a standard error gains.
const SETTLED_SLOWLY: f64 = 1e-5;

/// A fit's data and model.
pub struct Problem<'a> {
    /// The model.
    pub replay: &'a mut Replay,
    /// What is fitted.
    pub parameters: &'a [Parameter],
    /// The model's effects, their free numbers where the fit begins.
    pub effects: &'a [ActiveEffect],
    /// How residuals are whitened.
    pub whitening: &'a Whitening,
    /// By recording: false if it is only predicted once the fit is done.
    pub is_used: &'a [bool],
    /// The caller's.
    pub control: &'a Control<'a>,
}

impl Objective for Problem<'_> {
    type Error = InferenceError;

    fn limits(&self) -> Vec<Limits> {
        let limits = |p: &Parameter| Limits {
            bounds: p.bounds,
            prior: p.prior,
        };
        self.parameters.iter().map(limits).collect()
    }

    fn whitening(&self) -> &Whitening {
        self.whitening
    }

    /// Predictions of the recordings in use; zeros for the others.
    fn predictions(&mut self, at: &[f64]) -> Result<Vec<Vec<f64>>, InferenceError> {
        self.turn_effects(at)?;
        let recordings = self.replay.observed.measured.len();
        let (materials, nuisances) = setting(self.replay, (self.parameters, at));
        let ahead = (&materials[..], &nuisances[..]);
        self.replay
            .follow_ahead(ahead, self.is_used, self.control)?;
        let mut simulated = Vec::with_capacity(recordings);
        for (recording, nuisance) in nuisances.iter().enumerate() {
            simulated.push(match self.is_used[recording] {
                true => self
                    .replay
                    .predict(recording, (&materials, nuisance), self.control)?,
                false => vec![0.0; self.replay.observed.measured[recording].samples.len()],
            });
        }
        Ok(simulated)
    }

    fn stacked(&self, predictions: &[Vec<f64>]) -> Vec<f64> {
        predictions.concat()
    }

    fn threshold(&self, residual: &[f64], predictions: &[Vec<f64>]) -> f64 {
        let each = residual
            .iter()
            .zip(predictions.iter().flatten())
            .enumerate();
        let counting = each.filter(|(k, (_, f))| self.whitening.counts(*k, **f));
        let mut sizes: Vec<f64> = counting.map(|(_, (r, _))| r.abs()).collect();
        let bulk = median_deviation(&mut sizes);
        HUBER * if bulk.is_finite() { bulk.max(1.0) } else { 1.0 }
    }

    fn jacobian(
        &mut self,
        point: &Point,
        kept: Option<&DMatrix<f64>>,
    ) -> Result<DMatrix<f64>, InferenceError> {
        let starts: Vec<usize> = point
            .simulated
            .iter()
            .scan(0, |next, one| {
                *next += one.len();
                Some(*next - one.len())
            })
            .collect();
        // Those by numbers of effects cost most and change least.
        let kept = kept.filter(|_| self.replay.remembers());
        let mut jacobian = DMatrix::zeros(self.whitening.len(), self.parameters.len());
        for column in 0..self.parameters.len() {
            match (self.parameters[column].kind, kept) {
                (Kind::Touch(_), _) => continue,
                (Kind::Effect(..), Some(kept)) => {
                    jacobian.set_column(column, &kept.column(column));
                    continue;
                }
                (Kind::Effect(..), None) => {
                    jacobian.set_column(column, &self.effect_slopes(point, column)?);
                    continue;
                }
                _ => {}
            }
            let only = self.parameters[column].recording();
            for (recording, start) in starts.iter().enumerate() {
                let elsewhere = matches!(self.parameters[column].kind, Kind::Form(place, _)
                    if self.replay.place_of[recording] != place);
                let matters = only.is_none_or(|only| only == recording) && !elsewhere;
                if matters && self.is_used[recording] {
                    let slopes = self.slopes(point, (column, recording))?;
                    for (k, slope) in slopes.iter().enumerate() {
                        jacobian[(start + k, column)] = *slope;
                    }
                }
            }
        }
        self.sum_touches(&mut jacobian);
        Ok(jacobian)
    }

    fn stopping(&self, objective: f64) -> Stopping {
        let (settled, enough) = match self.replay.remembers() {
            true => (SETTLED_SLOWLY, 1),
            false => (SETTLED, 2),
        };
        let small = settled * (1.0 + objective);
        Stopping {
            small,
            enough,
            promised: small,
        }
    }

    fn before_step(&self, share: f64) -> Result<(), InferenceError> {
        let step = self.control.step("fitting", share);
        step.map_err(|_| InferenceError::Cancelled)
    }
}

impl Problem<'_> {
    /// Gives the model the effects that it has at a place.
    ///
    /// # Errors
    /// What the contact model says of them.
    pub(crate) fn turn_effects(&mut self, at: &[f64]) -> Result<(), InferenceError> {
        let effects = effects_at(self.effects, (self.parameters, at));
        self.replay.set_effects(&effects, self.control)
    }

    /// Derivatives of all predictions by a number of an effect.
    fn effect_slopes(
        &mut self,
        point: &Point,
        column: usize,
    ) -> Result<DVector<f64>, InferenceError> {
        let step = inward(&self.parameters[column], point.at[column]);
        let mut at = point.at.clone();
        at[column] += step;
        let moved = self.predictions(&at)?.concat();
        self.turn_effects(&point.at)?;
        let each = moved.iter().zip(point.simulated.iter().flatten());
        let slopes: Vec<f64> = each.map(|(b, a)| (b - a) / step).collect();
        Ok(DVector::from_vec(slopes))
    }

    /// First touch of a tool moves that of all its recordings.
    fn sum_touches(&self, jacobian: &mut DMatrix<f64>) {
        for (column, parameter) in self.parameters.iter().enumerate() {
            let Kind::Touch(place) = parameter.kind else {
                continue;
            };
            for (other, of) in self.parameters.iter().enumerate() {
                if matches!(of.kind, Kind::Zero(r) if self.replay.place_of[r] == place) {
                    let slopes = jacobian.column(other).clone_owned();
                    jacobian.column_mut(column).add_assign(slopes);
                }
            }
        }
    }

    /// Derivatives of one recording's predictions by one parameter.
    fn slopes(
        &mut self,
        point: &Point,
        (column, recording): (usize, usize),
    ) -> Result<Vec<f64>, InferenceError> {
        let parameter = &self.parameters[column];
        let simulated = &point.simulated[recording];
        let measured = &self.replay.observed.measured[recording];
        let samples = &measured.samples;
        match parameter.kind {
            // Where counts tell the force that is asked for, they change the contact too.
            Kind::Counts(_) if measured.asks_force() => {}
            Kind::Gain(_) | Kind::InstrumentGain | Kind::Counts(_) => {
                let is_scaled = |q: Quantity| match parameter.kind {
                    Kind::Counts(_) => matches!(q, Quantity::Pressure(_)),
                    _ => !matches!(q, Quantity::Area | Quantity::Scan(_)),
                };
                let own_zero = |p: &Parameter| p.kind == Kind::ForceZero(recording);
                let zero = self.parameters.iter().position(own_zero);
                let zero = zero.map_or(0.0, |k| point.at[k]);
                let each = samples
                    .iter()
                    .zip(simulated)
                    .map(|(s, f)| match s.quantity {
                        quantity if !is_scaled(quantity) => 0.0,
                        Quantity::Force => f - zero,
                        _ => *f,
                    });
                return Ok(each.collect());
            }
            Kind::ForceZero(_) => {
                let is_force = |q: Quantity| f64::from(q == Quantity::Force);
                return Ok(samples.iter().map(|s| is_force(s.quantity)).collect());
            }
            Kind::Tissue(..)
            | Kind::Zero(_)
            | Kind::Touch(_)
            | Kind::Pose(..)
            | Kind::Form(..)
            | Kind::Scan(..)
            | Kind::Effect(..) => {}
        }
        let step = inward(parameter, point.at[column]);
        let mut at = point.at.clone();
        at[column] += step;
        let (from, to) = (
            setting(self.replay, (self.parameters, &point.at)),
            setting(self.replay, (self.parameters, &at)),
        );
        let moved = self.replay.predict_near(
            recording,
            ((&from.0, &from.1[recording]), (&to.0, &to.1[recording])),
            self.control,
        )?;
        Ok(moved
            .iter()
            .zip(simulated)
            .map(|(b, a)| (b - a) / step)
            .collect())
    }
}

/// Step of a finite difference, away from the nearer bound.
fn inward(parameter: &Parameter, here: f64) -> f64 {
    let (low, high) = parameter.bounds;
    match high - here > here - low {
        true => parameter.step,
        false => -parameter.step,
    }
}

/// True for what grows with the modulus.
pub(crate) fn is_load(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::Force | Quantity::Pressure(_))
}
