//! Fixed point `x = f(x)` by Anderson's acceleration (Walker and Ni, SIAM Journal on Numerical Analysis 49 (2011) 1715).

use nalgebra::{DMatrix, DVector};

/// Steps that are remembered.
const MOST_STEPS: usize = 8;
/// Least share of the largest singular value that still counts.
const LEAST_SHARE: f64 = 1e-8;

/// The last steps of an iteration.
#[derive(Debug, Default)]
pub struct Anderson {
    last: Option<(DVector<f64>, DVector<f64>)>,
    /// Changes of x, and of the residual f(x) - x, from step to step.
    moves: Vec<DVector<f64>>,
    changes: Vec<DVector<f64>>,
}

impl Anderson {
    /// The next x, from x and its residual; `mixing` (0 to 1] is the share of the residual that is taken.
    pub fn next(&mut self, x: &[f64], residual: &[f64], mixing: f64) -> Vec<f64> {
        let (x, residual) = (
            DVector::from_column_slice(x),
            DVector::from_column_slice(residual),
        );
        if let Some((before, left)) = self.last.take() {
            if self.moves.len() == MOST_STEPS {
                self.moves.remove(0);
                self.changes.remove(0);
            }
            self.moves.push(&x - before);
            self.changes.push(&residual - left);
        }
        let mut next = &x + &residual * mixing;
        if !self.changes.is_empty() {
            let changes = DMatrix::from_columns(&self.changes);
            let svd = changes.svd(true, true);
            let least = LEAST_SHARE * svd.singular_values.max();
            if let Ok(shares) = svd.solve(&residual, least) {
                for (k, share) in shares.iter().enumerate() {
                    next -= (&self.moves[k] + &self.changes[k] * mixing) * *share;
                }
            }
        }
        self.last = Some((x, residual));
        next.as_slice().to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_map_that_diverges_by_itself_is_solved() {
        // x = b - A x with eigenvalues of A up to 30: plain iteration grows without bound.
        let scale = [0.5, 3.0, 12.0, 30.0];
        let mut x = vec![0.0; 4];
        let mut anderson = Anderson::default();
        for _ in 0..12 {
            let residual: Vec<f64> = x.iter().zip(scale).map(|(x, s)| 1.0 - s * x - x).collect();
            x = anderson.next(&x, &residual, 0.3);
        }
        for (x, s) in x.iter().zip(scale) {
            assert!((x * (1.0 + s) - 1.0).abs() < 1e-6, "{x} {s}");
        }
    }
}
