//! The fit of a candidate model of the surrogate, its covariance, and what a fit would leave to first order.

use std::convert::Infallible;

use nalgebra::DMatrix;

use crate::forward::surrogate::candidate_model::Model;
use crate::forward::surrogate::derivatives::Slopes;
use crate::forward::surrogate::surrogate_data::Surrogate;
use crate::least_squares::huber::HUBER;
use crate::least_squares::levenberg_marquardt::{
    Limits, Objective, Point, Stopping, System, descend,
};
use crate::noise::whitening::Whitening;
use crate::parameters::surrogate_parameter::Coordinate;

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

/// A candidate model with the surrogate that predicts for it.
struct Candidate<'a>(&'a Surrogate<'a>, &'a Model<'a>);

impl Objective for Candidate<'_> {
    type Error = Infallible;

    fn limits(&self) -> Vec<Limits> {
        let limits = |c: &Coordinate| Limits {
            bounds: c.bounds,
            prior: c.prior,
        };
        self.1.coordinates.iter().map(limits).collect()
    }

    fn whitening(&self) -> &Whitening {
        self.0.whitening
    }

    fn predictions(&mut self, at: &[f64]) -> Result<Vec<Vec<f64>>, Infallible> {
        Ok(self.0.all_forces(self.1, at))
    }

    fn stacked(&self, predictions: &[Vec<f64>]) -> Vec<f64> {
        self.0.stacked(predictions)
    }

    fn threshold(&self, _: &[f64], _: &[Vec<f64>]) -> f64 {
        HUBER
    }

    fn jacobian(
        &mut self,
        point: &Point,
        _: Option<&DMatrix<f64>>,
    ) -> Result<DMatrix<f64>, Infallible> {
        let Candidate(surrogate, model) = self;
        let rows = point.whitened.residual.len();
        let mut jacobian = DMatrix::zeros(rows, model.coordinates.len());
        for (c, course) in surrogate.courses.iter().enumerate() {
            let forces = &point.simulated[c];
            let of = Slopes::new(surrogate, (model, &point.at), (c, forces));
            for number in 0..model.coordinates.len() {
                let Some(slopes) = of.by(number) else {
                    continue;
                };
                for (row, slope) in course.rows.iter().zip(slopes) {
                    if let Some(sample) = row.sample {
                        jacobian[(sample, number)] = slope;
                    }
                }
            }
        }
        Ok(jacobian)
    }

    fn stopping(&self, _: f64) -> Stopping {
        Stopping {
            small: SETTLED,
            enough: 2,
            promised: PROMISED,
        }
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
    let Ok(found) = descend(&mut Candidate(surrogate, model), &at);
    Refit {
        covariance: inverse(&found.system.normal),
        simulated: surrogate.stacked(&found.point.simulated),
        at: found.point.at,
        deviance: found.point.objective,
        residual: found.point.whitened.residual,
    }
}

/// A model at a place, and the derivatives of its predictions, not whitened.
fn about(candidate: &mut Candidate<'_>, at: &[f64]) -> (Point, DMatrix<f64>) {
    let Ok(point) = candidate.point(at, None);
    let Ok(jacobian) = candidate.jacobian(&point, None);
    (point, jacobian)
}

/// Inverse of the normal matrix with priors where nothing is fitted: at `at`, the coordinates of `known` as they are there.
pub fn covariance(
    surrogate: &Surrogate<'_>,
    model: &Model<'_>,
    (at, known): (Vec<f64>, &[usize]),
) -> DMatrix<f64> {
    let mut candidate = Candidate(surrogate, model);
    let (point, jacobian) = about(&mut candidate, &at);
    let limits = (&candidate.limits()[..], surrogate.whitening);
    let mut normal = System::new(limits, (&point, &jacobian)).normal;
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
    let (point, jacobian) = about(&mut Candidate(surrogate, model), at);
    let jacobian = surrogate.whitening.derivatives(&jacobian, &point.whitened);
    let simulated = surrogate.stacked(&point.simulated);
    // Not as in a fit, where outliers weigh less: the change has none.
    let mut normal = jacobian.tr_mul(&jacobian);
    for (k, c) in model.coordinates.iter().enumerate() {
        normal[(k, k)] += c.prior.map_or(0.0, |sd| 1.0 / (sd * sd));
    }
    let inverse = inverse(&normal);
    let one = |changed: &Vec<f64>| {
        let off = changed.iter().zip(&simulated).map(|(a, b)| a - b);
        let off = DMatrix::from_iterator(changed.len(), 1, off);
        let off = surrogate.whitening.derivatives(&off, &point.whitened);
        let pull = jacobian.tr_mul(&off);
        off.norm_squared() - pull.dot(&(&inverse * &pull))
    };
    changed.iter().map(one).collect()
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
