//! Evidence of a linear model with Gaussian priors: `y = X b + noise`, `b ~ N(0, S)`, in closed form.
//!
//! A cause is one more column with a prior on its size. Its Bayes factor over the model without it follows from the
//! determinant lemma (Rasmussen and Williams 2006, 5.4.1, for the marginal likelihood).

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Added to every variance, so that exact data cannot make a matrix singular.
const LEAST_VARIANCE: f64 = 1e-10;

/// What is known of every row, without any cause.
#[derive(Debug, Clone)]
pub struct Rows {
    /// Data.
    pub y: Vec<f64>,
    /// Variance of the independent noise.
    pub variance: Vec<f64>,
    /// Nuisances: column and standard deviation of its size.
    pub nuisances: Vec<(Vec<f64>, f64)>,
}

/// The model, factored.
pub struct Factored {
    rows: Vec<usize>,
    y: DVector<f64>,
    cholesky: Cholesky<f64, Dyn>,
}

/// A column's size and what it gains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sized {
    /// Logarithm of the Bayes factor over the model without it, nats.
    pub gain: f64,
    /// Posterior mean of its size.
    pub size: f64,
    /// Posterior standard deviation.
    pub deviation: f64,
}

impl Rows {
    /// The model of the rows for which `is_used` holds; None if its covariance cannot be factored.
    pub fn factored(&self, is_used: impl Fn(usize) -> bool) -> Option<Factored> {
        let rows: Vec<usize> = (0..self.y.len()).filter(|k| is_used(*k)).collect();
        let n = rows.len();
        let mut covariance = DMatrix::<f64>::zeros(n, n);
        for (i, &row) in rows.iter().enumerate() {
            covariance[(i, i)] = self.variance[row] + LEAST_VARIANCE;
        }
        for (column, deviation) in &self.nuisances {
            let of: Vec<(usize, f64)> = rows
                .iter()
                .enumerate()
                .filter(|(_, row)| column[**row] != 0.0)
                .map(|(i, &row)| (i, deviation * column[row]))
                .collect();
            for &(i, a) in &of {
                for &(j, b) in &of {
                    covariance[(i, j)] += a * b;
                }
            }
        }
        let y = DVector::from_iterator(n, rows.iter().map(|&row| self.y[row]));
        let cholesky = Cholesky::new(covariance)?;
        Some(Factored { rows, y, cholesky })
    }
}

impl Factored {
    /// What a column gains whose size has the prior `N(0, deviation^2)`.
    pub fn with(&self, column: &[f64], deviation: f64) -> Sized {
        let own = DVector::from_iterator(self.rows.len(), self.rows.iter().map(|&r| column[r]));
        let solved = self.cholesky.solve(&own);
        let (strength, pull) = (own.dot(&solved), self.y.dot(&solved));
        let precision = 1.0 / (deviation * deviation) + strength;
        Sized {
            gain: 0.5 * pull * pull / precision
                - 0.5 * (1.0 + deviation * deviation * strength).ln(),
            size: pull / precision,
            deviation: precision.sqrt().recip(),
        }
    }

    /// Squared residual in standard deviations that the model expects, and the number of rows it is the sum of.
    pub fn chi_squared(&self) -> (f64, usize) {
        (self.y.dot(&self.cholesky.solve(&self.y)), self.rows.len())
    }

    /// The residual whitened row by row: each row given those before it.
    pub fn whitened(&self) -> Vec<(usize, f64)> {
        let lower = self.cholesky.l();
        let solved = lower.solve_lower_triangular(&self.y);
        let values = solved.map_or_else(Vec::new, |v| v.iter().copied().collect());
        self.rows.iter().copied().zip(values).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two readings of one size: posterior and Bayes factor by the formulas for a normal mean.
    #[test]
    fn a_mean_of_known_noise_has_its_closed_form() {
        let rows = Rows {
            y: vec![1.2, 0.8, 5.0],
            variance: vec![0.25, 0.25, 0.25],
            nuisances: vec![(vec![0.0, 0.0, 1.0], 10.0)],
        };
        let found = rows.factored(|_| true).unwrap().with(&[1.0, 1.0, 0.0], 2.0);
        let precision = 1.0 / 4.0 + 2.0 / 0.25;
        assert!((found.size - 2.0 / 0.25 / precision).abs() < 1e-6);
        assert!((found.deviation - precision.powf(-0.5)).abs() < 1e-6);
        let gain = 0.5 * 8.0f64.powi(2) / precision - 0.5 * (4.0 * precision).ln();
        assert!((found.gain - gain).abs() < 1e-6);
    }

    #[test]
    fn what_a_nuisance_explains_gains_nothing() {
        let free = Rows {
            y: vec![1.0, 1.1, 0.9],
            variance: vec![0.01; 3],
            nuisances: vec![(vec![1.0; 3], 100.0)],
        };
        let column = [1.0, 1.0, 1.0];
        assert!(
            free.factored(|_| true)
                .unwrap()
                .with(&column, 1.0)
                .gain
                .abs()
                < 0.1
        );
        let bound = Rows {
            nuisances: Vec::new(),
            ..free
        };
        assert!(bound.factored(|_| true).unwrap().with(&column, 1.0).gain > 50.0);
    }
}
