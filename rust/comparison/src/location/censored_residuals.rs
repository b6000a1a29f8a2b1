//! Generalized residuals of censored samples: the conditional mean of what an instrument's limits hide.
//!
//! Values over a threshold are shown because noise lifted them; without those under it, their sum has a mean of its own. With the mean
//! of each hidden residual, `E(r | hidden)`, in its place (the generalized residual of Gourieroux et al. 1987, J. Econometrics 34:5),
//! all means are 0 where nothing is amiss, and no variance is larger than 1.

use nalgebra::DVector;

use thenar_inference::distributions::{log_normal_cdf, log_normal_density};
use thenar_inference::fit::result::Fit;
use thenar_inference::observe::measured::{Censoring, Sample};

/// The projected residual by recording and sample, with the means of hidden residuals in place of what the fit makes of them.
pub(crate) fn projected(fit: &Fit) -> Vec<Vec<f64>> {
    let mut changes = Vec::new();
    for (recording, one) in fit.measured.iter().enumerate() {
        let (simulated, sigma) = (&fit.simulated[recording], &fit.sigma[recording]);
        let samples = one.samples.iter().zip(simulated.iter().zip(sigma));
        changes.extend(samples.map(|(sample, (value, sigma))| change(sample, *value, *sigma)));
    }
    let changes = DVector::from_vec(changes);
    let moved = match fit.absorbed.ncols() {
        0 => changes,
        _ => &changes - &fit.absorbed * (fit.absorbed.transpose() * &changes),
    };
    let mut rest = moved.iter();
    let moved_one = |one: &Vec<f64>| one.iter().zip(rest.by_ref()).map(|(r, c)| r + c).collect();
    fit.projected.iter().map(moved_one).collect()
}

/// From the residual that a fit gives a hidden value (0, or the root of its deviance where the simulation is on the wrong side) to its mean.
fn change(sample: &Sample, simulated: f64, sigma: f64) -> f64 {
    let sign = match sample.censoring {
        Censoring::Seen => return 0.0,
        Censoring::AtMost => 1.0,
        Censoring::AtLeast => -1.0,
    };
    let room = sign * (sample.value - simulated) / sigma;
    if !room.is_finite() {
        return 0.0;
    }
    let log = log_normal_cdf(room);
    let mean = -sign * (log_normal_density(room) - log).exp();
    let given = if room >= 0.0 {
        0.0
    } else {
        -sign * (-2.0 * log).sqrt()
    };
    let change = mean - given;
    if change.is_finite() { change } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use thenar_inference::observe::measured::Quantity;
    use thenar_inference::random::Random;

    /// Readings of a mat with a threshold: seen and hidden ones together have mean 0 and variance at most 1, wherever the truth lies.
    #[test]
    fn censored_and_seen_residuals_have_zero_mean() {
        let mut random = Random::new(3);
        for truth in [-1.0, 0.3, 1.0, 1.7, 4.0] {
            let (limit, sigma, count) = (1.0, 0.5, 40_000);
            let (mut sum, mut squares) = (0.0, 0.0);
            for _ in 0..count {
                let reading = truth + sigma * random.normal();
                let residual = if reading > limit {
                    (reading - truth) / sigma
                } else {
                    let sample = Sample {
                        moment: 0,
                        quantity: Quantity::Pressure(0),
                        value: limit,
                        censoring: Censoring::AtMost,
                    };
                    let room: f64 = (limit - truth) / sigma;
                    let deviance = -(-2.0 * log_normal_cdf(room)).sqrt();
                    change(&sample, truth, sigma) + if room >= 0.0 { 0.0 } else { deviance }
                };
                sum += residual;
                squares += residual * residual;
            }
            let n = f64::from(count);
            assert!((sum / n).abs() < 4.0 / n.sqrt(), "{truth}: {}", sum / n);
            assert!(squares / n < 1.03, "{truth}: {}", squares / n);
        }
    }
}
