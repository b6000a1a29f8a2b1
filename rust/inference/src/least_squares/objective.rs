//! Objective of the mesh model's fit: Huber loss of whitened residuals plus priors, and its Jacobian.

use std::ops::AddAssign;

use nalgebra::{DMatrix, DVector};
use thenar_contact::{ActiveEffect, Control};

use crate::errors::InferenceError;
use crate::forward::mesh::replay::Replay;
use crate::noise::whitening::{Whitened, Whitening};
use crate::observe::measured::Quantity;
use crate::parameters::effect_parameters::effects_at;
use crate::parameters::model_inputs::setting;
use crate::parameters::parameter::{Kind, Parameter};

/// Residuals beyond this many standard deviations, or of the bulk's spread if that is wider, pull with a constant force (Huber).
pub(crate) const HUBER: f64 = 3.0;

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

/// The model at one place.
#[derive(Debug, Clone)]
pub struct Point {
    /// Coordinates.
    pub at: Vec<f64>,
    /// Predictions by recording.
    pub simulated: Vec<Vec<f64>>,
    /// Whitened residuals, stacked.
    pub whitened: Whitened,
    /// What the fit makes small: sum of Huber's function over residuals and priors.
    pub objective: f64,
    /// Threshold of that function.
    pub threshold: f64,
}

impl Problem<'_> {
    /// The model at `at`; `threshold` as [`Point::threshold`], None: from its own residuals.
    ///
    /// # Errors
    /// Those of a replay.
    pub fn point(&mut self, at: &[f64], threshold: Option<f64>) -> Result<Point, InferenceError> {
        let simulated = self.predictions(at)?;
        let whitened = self.whitening.residuals(&simulated.concat());
        let threshold = threshold.unwrap_or_else(|| self.threshold(&whitened.residual, &simulated));
        let misfit: f64 = whitened.residual.iter().map(|r| huber(*r, threshold)).sum();
        let prior = self.parameters.iter().zip(at);
        let prior: f64 = prior
            .filter_map(|(p, x)| p.prior.map(|sd| (x / sd).powi(2)))
            .sum();
        Ok(Point {
            at: at.to_vec(),
            simulated,
            whitened,
            objective: misfit + prior,
            threshold,
        })
    }

    /// Predictions of the recordings in use; zeros for the others.
    ///
    /// # Errors
    /// Those of a replay.
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

    /// Gives the model the effects that it has at a place.
    ///
    /// # Errors
    /// What the contact model says of them.
    pub(crate) fn turn_effects(&mut self, at: &[f64]) -> Result<(), InferenceError> {
        let effects = effects_at(self.effects, (self.parameters, at));
        self.replay.set_effects(&effects, self.control)
    }

    /// Where a residual stands out from the bulk of them.
    fn threshold(&self, residual: &[f64], simulated: &[Vec<f64>]) -> f64 {
        let each = residual.iter().zip(simulated.iter().flatten()).enumerate();
        let counting = each.filter(|(k, (_, f))| self.whitening.counts(*k, **f));
        let mut sizes: Vec<f64> = counting.map(|(_, (r, _))| r.abs()).collect();
        let bulk = 1.4826 * crate::observe::robust_scale::median(&mut sizes);
        HUBER * if bulk.is_finite() { bulk.max(1.0) } else { 1.0 }
    }

    /// Derivatives of all predictions by all parameters, not whitened; rows stacked as the samples.
    ///
    /// Those by numbers of effects are taken from `kept`, if it is there: they cost most and change least.
    ///
    /// # Errors
    /// Those of a replay.
    pub(crate) fn jacobian(
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
                let each = samples.iter().zip(simulated);
                return Ok(each
                    .map(|(s, f)| if is_scaled(s.quantity) { *f } else { 0.0 })
                    .collect());
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

/// Huber's function: the square, and beyond the threshold a straight line.
pub fn huber(residual: f64, threshold: f64) -> f64 {
    let size = residual.abs();
    match size <= threshold {
        true => size * size,
        false => threshold * (2.0 * size - threshold),
    }
}

/// True for what grows with the modulus.
pub(crate) fn is_load(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::Force | Quantity::Pressure(_))
}
