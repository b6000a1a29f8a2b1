//! Symmetric matrices as linear maps, and preconditioners; Jacobi by default.

use super::row_runs::{Entry, RowRuns};

/// A symmetric matrix as a linear map.
pub trait Symmetric {
    /// Diagonal entries, positive.
    fn diagonal(&self) -> &[f64];

    /// The matrix times `x`; the same bits for any number of threads.
    fn times(&self, x: &[f64], out: &mut [f64]);

    /// The preconditioner on the unknowns of `set` (ascending); Jacobi's by default.
    fn preconditioner(&self, set: &[u32]) -> Box<dyn Preconditioner + '_> {
        let per = set.iter().map(|&i| 1.0 / self.diagonal()[i as usize]);
        Box::new(PerDiagonal(per.collect()))
    }
}

/// A symmetric positive definite map near the inverse of a matrix on some unknowns.
pub trait Preconditioner {
    /// The map times `residual`.
    fn apply(&self, residual: &[f64], out: &mut [f64]);
}

/// Jacobi's.
struct PerDiagonal(Vec<f64>);

impl Preconditioner for PerDiagonal {
    fn apply(&self, residual: &[f64], out: &mut [f64]) {
        for ((out, r), d) in out.iter_mut().zip(residual).zip(&self.0) {
            *out = r * d;
        }
    }
}

impl<T: Entry> Symmetric for RowRuns<T> {
    fn diagonal(&self) -> &[f64] {
        RowRuns::diagonal(self)
    }

    fn times(&self, x: &[f64], out: &mut [f64]) {
        RowRuns::times(self, x, out);
    }
}

impl<M: Symmetric> Symmetric for &M {
    fn diagonal(&self) -> &[f64] {
        M::diagonal(self)
    }

    fn times(&self, x: &[f64], out: &mut [f64]) {
        M::times(self, x, out);
    }
}
