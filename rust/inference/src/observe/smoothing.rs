//! Smoothing of a series by penalized second differences (Whittaker 1922), its strength by generalized cross-validation.

/// Strengths between which the best is sought, as powers of ten, and steps a power.
const POWERS: (i32, i32) = (-1, 9);
const STEPS: i32 = 2;
/// Price of a degree of freedom in generalized cross-validation: 1.4 keeps it from following noise (Kim and Gu 2004, Journal of the
/// Royal Statistical Society B 66:337).
const PRICE: f64 = 1.4;
/// Fewest values that are smoothed.
const LEAST: usize = 6;

/// A smooth course through values at growing times: the one of which generalized cross-validation expects the least error.
///
/// Fewer than 6 values, or times that do not grow, are returned as they are. A straight line is left as it is.
pub(crate) fn smoothed(time: &[f64], values: &[f64]) -> Vec<f64> {
    smoothed_with_freedom(time, values).0
}

/// The same with the degrees of freedom that the course takes.
pub(crate) fn smoothed_with_freedom(time: &[f64], values: &[f64]) -> (Vec<f64>, f64) {
    let n = values.len();
    let grows = time.windows(2).all(|w| w[1] > w[0]);
    if n < LEAST || !grows {
        return (values.to_vec(), n as f64);
    }
    let penalty = Penalty::new(time);
    let mut best = (f64::INFINITY, (values.to_vec(), n as f64));
    for step in POWERS.0 * STEPS..=POWERS.1 * STEPS {
        let strength = libm::pow(10.0, f64::from(step) / f64::from(STEPS));
        let (course, freedom) = penalty.smooth(values, strength);
        let pairs = values.iter().zip(&course);
        let squares: f64 = pairs.map(|(v, c)| (v - c).powi(2)).sum();
        let left = (n as f64 - PRICE * freedom).max(1e-3);
        let score = squares / (left * left);
        if score < best.0 {
            best = (score, (course, freedom));
        }
    }
    best.1
}

/// The square of second differences, in units of the mean step, as a matrix with two bands above its diagonal.
struct Penalty {
    bands: [Vec<f64>; 3],
}

impl Penalty {
    fn new(time: &[f64]) -> Penalty {
        let n = time.len();
        let mean = (time[n - 1] - time[0]) / (n - 1) as f64;
        let mut bands = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
        for k in 1..n - 1 {
            let (before, after) = (
                mean / (time[k] - time[k - 1]),
                mean / (time[k + 1] - time[k]),
            );
            let row = [before, -before - after, after];
            for a in 0..3 {
                for b in a..3 {
                    bands[b - a][k - 1 + a] += row[a] * row[b];
                }
            }
        }
        Penalty { bands }
    }

    /// The smooth course at a strength, and the degrees of freedom that it takes: the trace of the smoother.
    fn smooth(&self, values: &[f64], strength: f64) -> (Vec<f64>, f64) {
        let n = values.len();
        // L D L^T with two bands below the diagonal.
        let (mut d, mut one, mut two) = (vec![0.0f64; n], vec![0.0f64; n], vec![0.0f64; n]);
        for k in 0..n {
            let mut pivot = 1.0 + strength * self.bands[0][k];
            if k > 0 {
                pivot -= one[k - 1].powi(2) * d[k - 1];
            }
            if k > 1 {
                pivot -= two[k - 2].powi(2) * d[k - 2];
            }
            d[k] = pivot;
            let mut off_diagonal = strength * self.bands[1][k];
            if k > 0 {
                off_diagonal -= one[k - 1] * two[k - 1] * d[k - 1];
            }
            (one[k], two[k]) = (off_diagonal / pivot, strength * self.bands[2][k] / pivot);
        }
        let mut x = values.to_vec();
        for k in 0..n {
            if k > 0 {
                x[k] -= one[k - 1] * x[k - 1];
            }
            if k > 1 {
                x[k] -= two[k - 2] * x[k - 2];
            }
        }
        // Diagonal of the inverse from below (Hutchinson and de Hoog 1985, Numerische Mathematik 47:99); `near` is the entry next to it in
        // the row below.
        let (mut trace, mut diagonal, mut near) = (0.0, vec![0.0; n], 0.0);
        for k in (0..n).rev() {
            x[k] /= d[k];
            let (next, second) = (
                diagonal.get(k + 1).copied().unwrap_or(0.0),
                diagonal.get(k + 2).copied().unwrap_or(0.0),
            );
            if k + 1 < n {
                x[k] -= one[k] * x[k + 1];
            }
            if k + 2 < n {
                x[k] -= two[k] * x[k + 2];
            }
            let off_diagonal = -one[k] * next - two[k] * near;
            let far = -one[k] * near - two[k] * second;
            diagonal[k] = 1.0 / d[k] - one[k] * off_diagonal - two[k] * far;
            near = off_diagonal;
            trace += diagonal[k];
        }
        (x, trace)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use nalgebra::{DMatrix, DVector};

    /// Against the same system with full matrices, at uneven times.
    #[test]
    fn banded_smoother_equals_the_full_system() {
        let mut random = Random::new(3);
        let time: Vec<f64> = (0..17)
            .scan(0.0, |t, _| {
                *t += 0.1 + random.uniform();
                Some(*t)
            })
            .collect();
        let values: Vec<f64> = time.iter().map(|t| libm::sin(*t)).collect();
        let n = values.len();
        let mean = (time[n - 1] - time[0]) / (n - 1) as f64;
        let differences = DMatrix::from_fn(n - 2, n, |r, c| {
            let (before, after) = (
                mean / (time[r + 1] - time[r]),
                mean / (time[r + 2] - time[r + 1]),
            );
            match c.checked_sub(r) {
                Some(0) => before,
                Some(1) => -before - after,
                Some(2) => after,
                _ => 0.0,
            }
        });
        for strength in [0.3, 40.0] {
            let whole = DMatrix::identity(n, n) + differences.transpose() * &differences * strength;
            let inverse = whole.try_inverse().unwrap();
            let wanted = &inverse * DVector::from_column_slice(&values);
            let (found, freedom) = Penalty::new(&time).smooth(&values, strength);
            for (a, b) in found.iter().zip(wanted.iter()) {
                assert!((a - b).abs() < 1e-10);
            }
            assert!((freedom - inverse.trace()).abs() < 1e-9, "{freedom}");
        }
    }

    /// A line of 60 noisy values is known to about a fifth of the noise; a bend stays.
    #[test]
    fn noise_goes_and_movement_stays() {
        let mut random = Random::new(5);
        let time: Vec<f64> = (0..60).map(f64::from).collect();
        let rms = |course: &dyn Fn(f64) -> f64, random: &mut Random| {
            let values: Vec<f64> = time.iter().map(|t| course(*t) + random.normal()).collect();
            let found = smoothed(&time, &values);
            let squares = found
                .iter()
                .zip(&time)
                .map(|(f, t)| (f - course(*t)).powi(2));
            (squares.sum::<f64>() / 60.0).sqrt()
        };
        assert!(rms(&|t| 0.7 * t, &mut random) < 0.4);
        assert!(rms(&|t| 30.0 * libm::sin(t / 6.0), &mut random) < 0.8);
        let few = [1.0, 5.0, 2.0];
        assert_eq!(smoothed(&[0.0, 1.0, 2.0], &few), few);
    }
}
