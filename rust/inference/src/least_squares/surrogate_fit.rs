//! Levenberg-Marquardt with bounds and Huber loss, for the surrogate model; covariance and linearized misfit.

use nalgebra::{DMatrix, DVector};

use crate::forward::surrogate::candidate_model::Model;
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::noise::whitening::Whitened;

/// Residuals beyond this many standard deviations pull with a constant force.
pub(crate) const HUBER: f64 = 3.0;
/// Most steps.
const MOST_STEPS: usize = 60;
/// Gain of the deviance below which a fit has settled.
const SETTLED: f64 = 0.02;
/// Gain of the deviance that a step must promise to be tried.
const PROMISED: f64 = 1e-3;

/// A candidate model at its optimum.
#[derive(Debug, Clone)]
pub struct Refit {
    /// Coordinates.
    pub at: Vec<f64>,
    /// Sum of Huber's function over residuals and priors.
    pub deviance: f64,
    /// Whitened residuals of all samples, stacked.
    pub residual: Vec<f64>,
    /// Predictions of all samples, stacked.
    pub simulated: Vec<f64>,
    /// Inverse of the normal matrix with priors.
    pub covariance: DMatrix<f64>,
}

struct Here {
    at: Vec<f64>,
    forces: Vec<Vec<f64>>,
    simulated: Vec<f64>,
    whitened: Whitened,
    deviance: f64,
}

fn here(surrogate: &Surrogate<'_>, model: &Model<'_>, at: Vec<f64>) -> Here {
    let forces = surrogate.all_forces(model, &at);
    let simulated = surrogate.stacked(&forces);
    let whitened = surrogate.whitening.residuals(&simulated);
    let misfit: f64 = whitened.residual.iter().map(|r| huber(*r)).sum();
    let prior = model.coordinates.iter().zip(&at);
    let prior: f64 = prior
        .filter_map(|(c, x)| c.prior.map(|sd| (x / sd).powi(2)))
        .sum();
    let deviance = match misfit.is_finite() {
        true => misfit + prior,
        false => f64::INFINITY,
    };
    Here {
        at,
        forces,
        simulated,
        whitened,
        deviance,
    }
}

/// Huber's function: the square, and beyond the threshold a straight line.
pub fn huber(r: f64) -> f64 {
    match r.abs() <= HUBER {
        true => r * r,
        false => HUBER * (2.0 * r.abs() - HUBER),
    }
}

/// Fits a model; `start` gives the first coordinates, the others begin where the model says.
pub fn refit(surrogate: &Surrogate<'_>, model: &Model<'_>, start: &[f64]) -> Refit {
    let mut at: Vec<f64> = model.coordinates.iter().map(|c| c.start).collect();
    let shared = start.len().min(at.len());
    at[..shared].copy_from_slice(&start[..shared]);
    for (x, c) in at.iter_mut().zip(&model.coordinates) {
        *x = x.clamp(c.bounds.0, c.bounds.1);
    }
    let mut now = here(surrogate, model, at);
    let (mut normal, mut downhill) = system(model, &now, &slopes(surrogate, model, &now));
    let (mut damping, mut small) = (1e-3, 0);
    for _ in 0..MOST_STEPS {
        let Some(next) = step(model, (&now.at, &normal, &downhill), damping) else {
            break;
        };
        let is_worth_it = promised((&now.at, &next), &normal, &downhill) > PROMISED;
        let next = is_worth_it.then(|| here(surrogate, model, next));
        let Some(next) = next.filter(|next| next.deviance < now.deviance) else {
            damping *= 10.0;
            if damping > 1e6 {
                break;
            }
            continue;
        };
        let gain = now.deviance - next.deviance;
        small = if gain < SETTLED { small + 1 } else { 0 };
        now = next;
        (normal, downhill) = system(model, &now, &slopes(surrogate, model, &now));
        damping = f64::max(damping * 0.2, 1e-9);
        if small >= 2 {
            break;
        }
    }
    Refit {
        covariance: inverse(&normal),
        at: now.at,
        deviance: now.deviance,
        residual: now.whitened.residual,
        simulated: now.simulated,
    }
}

/// Inverse of the normal matrix with priors where nothing is fitted: at `at`, the coordinates of `known` as they are there.
pub fn covariance(
    surrogate: &Surrogate<'_>,
    model: &Model<'_>,
    (at, known): (Vec<f64>, &[usize]),
) -> DMatrix<f64> {
    let now = here(surrogate, model, at);
    let (mut normal, _) = system(model, &now, &slopes(surrogate, model, &now));
    for k in known {
        normal.row_mut(*k).fill(0.0);
        normal.column_mut(*k).fill(0.0);
        normal[(*k, *k)] = 1.0;
    }
    inverse(&normal)
}

/// What is left of changed predictions (each of all samples, stacked) once a model's coordinates are fitted to them, to first order about
/// `at`: squared, in units of the noise.
pub fn left_by_fit(
    surrogate: &Surrogate<'_>,
    model: &Model<'_>,
    (at, changed): (&[f64], &[Vec<f64>]),
) -> Vec<f64> {
    let now = here(surrogate, model, at.to_vec());
    let jacobian = slopes(surrogate, model, &now);
    // Not as in a fit, where outliers weigh less: the change has none.
    let mut normal = jacobian.tr_mul(&jacobian);
    for (k, c) in model.coordinates.iter().enumerate() {
        normal[(k, k)] += c.prior.map_or(0.0, |sd| 1.0 / (sd * sd));
    }
    let inverse = inverse(&normal);
    let one = |changed: &Vec<f64>| {
        let off = changed.iter().zip(&now.simulated).map(|(a, b)| a - b);
        let off = DMatrix::from_iterator(changed.len(), 1, off);
        let off = surrogate.whitening.derivatives(&off, &now.whitened);
        let pull = jacobian.tr_mul(&off);
        off.norm_squared() - pull.dot(&(&inverse * &pull))
    };
    changed.iter().map(one).collect()
}

/// Whitened derivatives of the predictions.
fn slopes(surrogate: &Surrogate<'_>, model: &Model<'_>, now: &Here) -> DMatrix<f64> {
    let mut raw = DMatrix::zeros(now.simulated.len(), model.coordinates.len());
    for number in 0..model.coordinates.len() {
        for (c, course) in surrogate.courses.iter().enumerate() {
            let found = surrogate.slopes((model, &now.at), (number, c), &now.forces[c]);
            let Some(slopes) = found else {
                continue;
            };
            for (row, slope) in course.rows.iter().zip(slopes) {
                if let Some(sample) = row.sample {
                    raw[(sample, number)] = slope;
                }
            }
        }
    }
    surrogate.whitening.derivatives(&raw, &now.whitened)
}

fn system(model: &Model<'_>, now: &Here, whitened: &DMatrix<f64>) -> (DMatrix<f64>, DVector<f64>) {
    let residual = &now.whitened.residual;
    let mut weighted = whitened.clone();
    for (k, r) in residual.iter().enumerate() {
        if r.abs() > HUBER {
            weighted.row_mut(k).scale_mut(HUBER / r.abs());
        }
    }
    let mut normal = whitened.tr_mul(&weighted);
    let mut downhill = weighted.tr_mul(&DVector::from_column_slice(residual));
    for (k, c) in model.coordinates.iter().enumerate() {
        if let Some(sd) = c.prior {
            normal[(k, k)] += 1.0 / (sd * sd);
            downhill[k] -= now.at[k] / (sd * sd);
        }
    }
    (normal, downhill)
}

/// By how much the deviance falls over a step if it is as its slopes and the normal matrix say.
fn promised((from, to): (&[f64], &[f64]), normal: &DMatrix<f64>, downhill: &DVector<f64>) -> f64 {
    let step = DVector::from_iterator(from.len(), to.iter().zip(from).map(|(b, a)| b - a));
    2.0 * downhill.dot(&step) - step.dot(&(normal * &step))
}

/// The damped step within the bounds: what meets one stays there, and the rest is solved again.
fn step(
    model: &Model<'_>,
    (from, normal, downhill): (&[f64], &DMatrix<f64>, &DVector<f64>),
    damping: f64,
) -> Option<Vec<f64>> {
    let bounds: Vec<(f64, f64)> = model.coordinates.iter().map(|c| c.bounds).collect();
    let mut free: Vec<usize> = (0..from.len())
        .filter(|&k| {
            let leads_out = (from[k] <= bounds[k].0 && downhill[k] < 0.0)
                || (from[k] >= bounds[k].1 && downhill[k] > 0.0);
            !leads_out && normal[(k, k)] > 0.0
        })
        .collect();
    let mut at = from.to_vec();
    while !free.is_empty() {
        let matrix = DMatrix::from_fn(free.len(), free.len(), |a, b| {
            let value = normal[(free[a], free[b])];
            if a == b {
                value * (1.0 + damping)
            } else {
                value
            }
        });
        let mut side = DVector::from_fn(free.len(), |a, _| downhill[free[a]]);
        for k in (0..from.len()).filter(|k| !free.contains(k)) {
            let moved = at[k] - from[k];
            if moved != 0.0 {
                for (a, row) in free.iter().enumerate() {
                    side[a] -= normal[(*row, k)] * moved;
                }
            }
        }
        let step = matrix.cholesky()?.solve(&side);
        let mut met = Vec::new();
        for (a, k) in free.iter().enumerate() {
            let next = from[*k] + step[a];
            if next < bounds[*k].0 || next > bounds[*k].1 {
                met.push(*k);
            }
            at[*k] = next.clamp(bounds[*k].0, bounds[*k].1);
        }
        if met.is_empty() {
            break;
        }
        free.retain(|k| !met.contains(k));
    }
    (at != from).then_some(at)
}

/// Inverse of a normal matrix, scaled; directions without information get a large variance.
fn inverse(normal: &DMatrix<f64>) -> DMatrix<f64> {
    let n = normal.nrows();
    let scale: Vec<f64> = (0..n).map(|k| normal[(k, k)].max(1e-12).sqrt()).collect();
    let scaled = DMatrix::from_fn(n, n, |i, j| {
        let value = normal[(i, j)] / (scale[i] * scale[j]);
        if i == j { value + 1e-9 } else { value }
    });
    match scaled.cholesky() {
        Some(factor) => {
            let inverse = factor.inverse();
            DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] / (scale[i] * scale[j]))
        }
        None => DMatrix::from_diagonal_element(n, n, 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::surrogate::synthetic::{Reading, ready, tool};
    use crate::observe::measured::Phase;

    /// A punch of 1 N/mm pressed to 2 mm after ten readings in the air: a modulus takes up what is in proportion to the force, and nothing of
    /// what the air reads.
    #[test]
    fn change_along_a_free_modulus_leaves_no_residual() {
        let reading = |k: u32| -> Reading {
            let depth = 0.1 * (f64::from(k) - 10.0);
            (f64::from(k), depth, Phase::Load, depth.max(0.0))
        };
        let readings: Vec<Reading> = (0..=30).map(reading).collect();
        let sigma = 0.05;
        let (ready, _) = ready(vec![tool(2.0, |d| d, |_| 1.0)], &[(0, readings)], sigma);
        let surrogate = ready.surrogate();
        let model = Model::new(&surrogate, &[]);
        let fitted = refit(&surrogate, &model, &[]);
        let stiffer = fitted.simulated.iter().map(|f| 1.02 * f).collect();
        let air = |(k, f): (usize, &f64)| if k < 10 { f + 0.2 } else { *f };
        let offset = fitted.simulated.iter().enumerate().map(air).collect();
        let left = left_by_fit(&surrogate, &model, (&fitted.at, &[stiffer, offset]));
        let whole: f64 = fitted
            .simulated
            .iter()
            .map(|f| (0.02 * f / sigma).powi(2))
            .sum();
        assert!(whole > 4.0 && left[0] < 1e-3 * whole, "{left:?}");
        assert!(
            (left[1] / (10.0 * (0.2 / sigma).powi(2)) - 1.0).abs() < 1e-9,
            "{left:?}"
        );
    }
}
