//! Estimates with their 90 % intervals.

use nalgebra::DMatrix;

use super::descent::System;
use super::parameters::Parameter;
use super::problem::Point;
use crate::Estimate;
use crate::noise::Noise;
use crate::statistics::t_95;

/// An estimate is at a bound if it lies this near, as a part of the bounds' distance.
const AT_BOUND: f64 = 1e-6;

/// Estimates of all parameters.
///
/// Standard errors come from `(J^T W J + priors)^-1`, wider by what the misfit exceeds the noise; half widths are those of Student's t with
/// the degrees of freedom that the noise was told with. Where the data say nothing, the interval is that of the bounds.
pub fn estimates(
    parameters: &[Parameter],
    (point, system): (&Point, &System),
    noise: &Noise,
    samples: usize,
) -> Vec<Estimate> {
    let own = (samples.saturating_sub(parameters.len())).max(1) as f64;
    let misfit = point.whitened.residual.iter();
    let misfit: f64 = misfit
        .map(|r| super::problem::huber(*r, point.threshold))
        .sum();
    let excess = (misfit / own).max(1.0).sqrt();
    let t = t_95(noise.degrees.unwrap_or(own));
    let errors = standard_errors(&system.normal);
    let one = |(k, parameter): (usize, &Parameter)| {
        let (low, high) = parameter.bounds;
        let at = point.at[k];
        let half = t * excess * errors[k];
        let ends = match half.is_finite() {
            true => ((at - half).max(low), (at + half).min(high)),
            false => (low, high),
        };
        let near = AT_BOUND * (high - low);
        Estimate {
            name: parameter.name.to_owned(),
            target: parameter.target.clone(),
            start: parameter.value(parameter.start),
            value: parameter.value(at),
            low: parameter.value(ends.0),
            high: parameter.value(ends.1),
            bounds: (parameter.value(low), parameter.value(high)),
            is_at_bound: at - low <= near || high - at <= near,
        }
    };
    parameters.iter().enumerate().map(one).collect()
}

/// Roots of the inverse's diagonal; infinite for what nothing is known of.
fn standard_errors(normal: &DMatrix<f64>) -> Vec<f64> {
    let n = normal.nrows();
    let scale: Vec<f64> = (0..n).map(|k| normal[(k, k)].max(0.0).sqrt()).collect();
    let known: Vec<usize> = (0..n).filter(|&k| scale[k] > 0.0).collect();
    let scaled = DMatrix::from_fn(known.len(), known.len(), |a, b| {
        let (i, j) = (known[a], known[b]);
        normal[(i, j)] / (scale[i] * scale[j])
    });
    let mut errors = vec![f64::INFINITY; n];
    // Directions without information get a large variance instead of none.
    let eigen = scaled.symmetric_eigen();
    for (a, k) in known.iter().enumerate() {
        let variance: f64 = (0..known.len())
            .map(|e| eigen.eigenvectors[(a, e)].powi(2) / eigen.eigenvalues[e].max(1e-14))
            .sum();
        errors[*k] = variance.sqrt() / scale[*k];
    }
    errors
}
