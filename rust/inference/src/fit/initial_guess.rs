//! Initial guess of a fit: the study's own parameters, scaled to the size of the measurement.

use crate::errors::InferenceError;
use crate::least_squares::objective::{Problem, is_load};
use crate::parameters::model_inputs::setting;
use crate::parameters::parameter::{Kind, Number};

/// Steps in which counts per kPa are sought, as a logarithm.
const STEP: f64 = 0.25;

/// The start, with the moduli moved together to where forces and pressures have the right size.
pub(crate) fn scaled_start(
    problem: &mut Problem<'_>,
    before: &[Vec<f64>],
) -> Result<Vec<f64>, InferenceError> {
    let mut start: Vec<f64> = problem.parameters.iter().map(|p| p.start).collect();
    let (mut over, mut under) = (0.0, 0.0);
    for (measured, simulated) in problem.replay.observed.measured.iter().zip(before) {
        let scale = simulated
            .iter()
            .fold(0.0, |most, f| f64::max(most, *f))
            .powi(2);
        if !measured.is_calibrated || scale == 0.0 {
            continue;
        }
        for (sample, f) in measured.samples.iter().zip(simulated) {
            if is_load(sample.quantity) {
                (over, under) = (over + f * sample.value / scale, under + f * f / scale);
            }
        }
    }
    let factor = if under > 0.0 { over / under } else { 1.0 };
    let shift = if factor > 0.0 { libm::log(factor) } else { 0.0 };
    for (at, parameter) in start.iter_mut().zip(problem.parameters) {
        if matches!(parameter.kind, Kind::Tissue(_, Number::G0 | Number::GLim)) {
            *at = (*at + shift).clamp(parameter.bounds.0, parameter.bounds.1);
        }
    }
    scale_counts(problem, &mut start)?;
    Ok(start)
}

/// Counts per kPa of uncalibrated mats: so that simulated and measured sums agree, or where they tell the force that is asked for, so that the
/// shapes do.
fn scale_counts(problem: &mut Problem<'_>, start: &mut [f64]) -> Result<(), InferenceError> {
    for column in 0..start.len() {
        let Kind::Counts(recording) = problem.parameters[column].kind else {
            continue;
        };
        let (low, high) = problem.parameters[column].bounds;
        if problem.replay.observed.measured[recording].asks_force() {
            start[column] = of_shape(problem, start, (column, recording))?;
            continue;
        }
        let simulated = simulated(problem, start, recording)?;
        let samples = &problem.replay.observed.measured[recording].samples;
        let ratio = samples.iter().map(|s| s.value).sum::<f64>() / simulated.iter().sum::<f64>();
        if ratio.is_finite() && ratio > 0.0 {
            start[column] = libm::log(ratio).clamp(low, high);
        }
    }
    Ok(())
}

/// The counts per kPa, as a logarithm, over all that is admissible: a force too large or too small by far changes no shape, and no slope leads
/// back from there.
fn of_shape(
    problem: &mut Problem<'_>,
    start: &[f64],
    (column, recording): (usize, usize),
) -> Result<f64, InferenceError> {
    let (low, high) = problem.parameters[column].bounds;
    let steps = ((high - low) / STEP).ceil();
    let mut best = (f64::INFINITY, start[column]);
    let mut at = start.to_vec();
    for k in 0..=steps as usize {
        at[column] = low + (high - low) * k as f64 / steps;
        let simulated = simulated(problem, &at, recording)?;
        let samples = &problem.replay.observed.measured[recording].samples;
        let each = samples.iter().zip(&simulated);
        let misfit: f64 = each.map(|(s, f)| (s.value - f).powi(2)).sum();
        if misfit < best.0 {
            best = (misfit, at[column]);
        }
    }
    Ok(best.1)
}

fn simulated(
    problem: &mut Problem<'_>,
    at: &[f64],
    recording: usize,
) -> Result<Vec<f64>, InferenceError> {
    let (materials, nuisances) = setting(problem.replay, (problem.parameters, at));
    problem.replay.predict(
        recording,
        (&materials, &nuisances[recording]),
        problem.control,
    )
}
