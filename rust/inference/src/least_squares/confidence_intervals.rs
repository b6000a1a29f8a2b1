//! Estimates with 90 % confidence intervals.

use nalgebra::DMatrix;

use crate::distributions::t_95;
use crate::least_squares::huber::huber;
use crate::least_squares::levenberg_marquardt::{Point, System};
use crate::least_squares::objective::Problem;
use crate::noise::estimate::Noise;
use crate::parameters::estimate::Estimate;
use crate::parameters::parameter::Kind;

/// An estimate is at a bound if it lies this near, as a part of the bounds' distance.
const AT_BOUND: f64 = 1e-6;
/// Smallest eigenvalue of the scaled normal matrix that rounding leaves meaning.
const LEAST_INFORMATION: f64 = 1e-14;

/// Estimates of all parameters, with what they are.
///
/// Standard errors come from `(J^T W J + priors)^-1`, wider by what the misfit exceeds the noise; half widths are those of Student's t with
/// the degrees of freedom that the noise was told with. Where the data say nothing, the interval is that of the bounds.
pub fn estimates(
    problem: &Problem<'_>,
    (point, system): (&Point, &System),
    noise: &Noise,
) -> Vec<(Kind, Estimate)> {
    let parameters = problem.parameters;
    let each = point
        .whitened
        .residual
        .iter()
        .zip(point.simulated.iter().flatten())
        .enumerate();
    let counting = each.filter(|(k, (_, f))| problem.whitening.counts(*k, **f));
    let (misfit, count) = counting.fold((0.0, 0), |(sum, n), (_, (r, _))| {
        (sum + huber(*r, point.threshold), n + 1)
    });
    let own = usize::saturating_sub(count, parameters.len()).max(1) as f64;
    let excess = (misfit / own).max(1.0).sqrt();
    let t = t_95(noise.degrees.unwrap_or(own));
    let covariance = Covariance::new(&system.normal);
    let mut estimates = Vec::new();
    for (k, parameter) in parameters.iter().enumerate() {
        // First touch of a tool is told with each of its recordings.
        let with = match parameter.kind {
            Kind::Touch(_) => continue,
            Kind::Zero(r) => {
                let touch = Kind::Touch(problem.replay.place_of[r]);
                let is_known = problem.replay.observed.is_touch_known[r];
                parameters
                    .iter()
                    .position(|p| p.kind == touch)
                    .filter(|_| is_known)
            }
            _ => None,
        };
        let (mut low, mut high) = parameter.bounds;
        let (mut at, mut variance) = (point.at[k], covariance.of(k, k));
        if let Some(j) = with {
            (low, high) = (low + parameters[j].bounds.0, high + parameters[j].bounds.1);
            at += point.at[j];
            variance += covariance.of(j, j) + 2.0 * covariance.of(k, j);
        }
        let half = t * excess * variance.max(0.0).sqrt();
        let ends = match half.is_finite() {
            true => ((at - half).max(low), (at + half).min(high)),
            false => (low, high),
        };
        let near = AT_BOUND * (high - low);
        let estimate = Estimate {
            name: parameter.name(problem.effects).to_owned(),
            target: parameter.target(
                &problem.replay.tissue.regions,
                &problem.replay.observed.measured,
            ),
            start: parameter.value(parameter.start),
            value: parameter.value(at),
            low: parameter.value(ends.0),
            high: parameter.value(ends.1),
            bounds: (parameter.value(low), parameter.value(high)),
            is_at_bound: at - low <= near || high - at <= near,
        };
        estimates.push((parameter.kind, estimate));
    }
    estimates
}

/// The inverse of the normal matrix; infinite where nothing is known.
struct Covariance {
    matrix: DMatrix<f64>,
}

impl Covariance {
    fn new(normal: &DMatrix<f64>) -> Covariance {
        let n = normal.nrows();
        let scale: Vec<f64> = (0..n).map(|k| normal[(k, k)].max(0.0).sqrt()).collect();
        let known: Vec<usize> = (0..n).filter(|&k| scale[k] > 0.0).collect();
        let mut matrix = DMatrix::from_diagonal_element(n, n, f64::INFINITY);
        if known.is_empty() || !normal.iter().all(|value| value.is_finite()) {
            return Covariance { matrix };
        }
        let scaled = DMatrix::from_fn(known.len(), known.len(), |a, b| {
            let (i, j) = (known[a], known[b]);
            normal[(i, j)] / (scale[i] * scale[j])
        });
        // Directions without information get a large variance instead of none.
        let eigen = scaled.symmetric_eigen();
        let inverse = eigen
            .eigenvalues
            .map(|value| 1.0 / value.max(LEAST_INFORMATION));
        let inverse =
            &eigen.eigenvectors * DMatrix::from_diagonal(&inverse) * eigen.eigenvectors.transpose();
        for (a, i) in known.iter().enumerate() {
            for (b, j) in known.iter().enumerate() {
                matrix[(*i, *j)] = inverse[(a, b)] / (scale[*i] * scale[*j]);
            }
        }
        Covariance { matrix }
    }

    fn of(&self, i: usize, j: usize) -> f64 {
        self.matrix[(i, j)]
    }
}
